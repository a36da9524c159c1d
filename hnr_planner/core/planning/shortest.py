"""Exact searches for a request on a grid: the shortest path, and that which keeps a clearance."""

from dataclasses import replace
from typing import Any

from hnr_planner.core.checks import Floats
from hnr_planner.core.planning.limits import Budget, run
from hnr_planner.core.planning.planner import make_problem, PathSearch, Work
from hnr_planner.core.planning.planners.polyanya import Polyanya
from hnr_planner.core.planning.request import outcome_without_search, Request
from hnr_planner.core.planning.result import PlannerStatus
from hnr_planner.core.spaces.grid.kept_clear import kept_clear
import numpy as np

#: No work.
NOTHING = Work(0, {})


def in_caller_s_frame(request: Request, points: Floats) -> Floats:
    """
    Convert a path (m, dim) from the kernel frame to the caller's frame.

    The first point is exactly the request's start, and the last one exactly its goal where the
    path ends there.
    """
    path = request.space.from_kernel(points)
    path[0] = request.start
    if points[-1].tolist() == request.problem.goal.tolist():
        path[-1] = request.goal
    return path


def shortest_path(request: Request, budget: Budget) -> tuple[PathSearch, Floats | None]:
    """
    Search a grid for the shortest path; return the search, and the path (m, 2), caller's frame.

    The path is None where a limit is met first.
    """
    space = request.space
    search = Polyanya().for_space(space).start(request.problem, request.stream(0))
    if run(search, budget) is not PlannerStatus.SOLVED:
        return search, None

    def free_path() -> Floats | None:
        path = in_caller_s_frame(request, search.path)
        return path if space.is_path_free(path) else None

    return search, budget.within(free_path, None)


def shortest_kept_clear(request: Request, budget: Budget) -> tuple[Work, Floats | None]:
    """
    Search a grid for the shortest path over cells that keep the clearance of a request.

    Return the work, and the path (m, 2), caller's frame. The path is None where no such cells
    connect start and goal, or a limit is met first.
    """
    if budget.stop() is not None:
        return NOTHING, None
    space: Any = request.space
    clear = kept_clear(space, request.clearance)
    problem = make_problem(clear, request.start, request.goal, request.goal_radius)
    kept = replace(request, space=clear, problem=problem)
    status, _ = outcome_without_search(kept) or (None, '')
    if status is PlannerStatus.SOLVED and request.goal_radius == 0.0:
        return NOTHING, np.array((request.start, request.goal))
    if status is not None:
        return NOTHING, None
    search, path = shortest_path(kept, budget)
    return Work.of(search), path
