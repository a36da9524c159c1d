"""Exact searches for a request on a grid: the shortest path, and that which keeps a clearance."""

import math
from typing import Any, NamedTuple

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


def lower_bound(request: Request, search: PathSearch) -> float:
    """
    Return a lower bound [m] on the length of free paths from start to goal.

    It is the bound of the search where that has one, and at least the straight distance.
    """
    bound = getattr(search, 'lower_bound', 0.0) * request.space.scale
    return max(bound, request.straight_length)


class KeptClear(NamedTuple):
    """
    Outcome of a search over the cells that keep a clearance.

    Attributes
    ----------
    work : Work
        Work of the search.
    path : (m, 2) or None
        The shortest path, caller's frame; None where a limit was met first or there is none.
    lower_bound : float
        Lower bound on the length of paths over these cells [m]; inf where they connect no path.

    """

    work: Work
    path: Floats | None
    lower_bound: float


#: The outcome where no search was made.
NOT_SEARCHED = KeptClear(NOTHING, None, 0.0)


def shortest_kept_clear(request: Request, budget: Budget) -> KeptClear:
    """Search a grid for the shortest path over cells that keep the clearance of a request."""
    if budget.stop() is not None:
        return NOT_SEARCHED
    space: Any = request.space
    clear = kept_clear(space, request.clearance)
    problem = make_problem(clear, request.start, request.goal, request.goal_radius)
    kept = request._replace(space=clear, problem=problem)
    status, _ = outcome_without_search(kept) or (None, '')
    if status is PlannerStatus.SOLVED:  # by the segment: no start in the goal region is searched
        return KeptClear(NOTHING, np.array((request.start, request.goal)), request.straight_length)
    if status is not None:
        return KeptClear(NOTHING, None, math.inf)
    search, path = shortest_path(kept, budget)
    return KeptClear(Work.of(search), path, lower_bound(kept, search))
