"""
``plan`` in a space of poses: check the ends, search for a path, build the result.

The request begins with a proof or a guide: where no path of the largest disc in the footprint
joins start and goal, there is none for the footprint; else the shortest path of the disc guides
the search.
"""

import math
from typing import Any

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.clock import working_time
from hnr_planner.core.kernels.kernel import interpreted_calls
from hnr_planner.core.planning.limits import Budget
from hnr_planner.core.planning.poses.ends import NOT_FREE, place_ends
from hnr_planner.core.planning.poses.found_path import NO_PATH
from hnr_planner.core.planning.poses.request import check_pose_request, PoseRequest
from hnr_planner.core.planning.poses.searches import PoseAttempt, PoseSearches
from hnr_planner.core.planning.request import Effort
from hnr_planner.core.planning.result import PlannerStatus, PlanResult
from hnr_planner.core.planning.tiers import with_remark
from hnr_planner.core.spaces.poses.disc import Disc
from hnr_planner.core.spaces.poses.pose_space import PoseSpace
import numpy as np
from numpy.typing import ArrayLike


def plan_poses(
    space: PoseSpace, start: ArrayLike, goal: ArrayLike, effort: Effort, **options: Any
) -> PlanResult:
    """
    Find a path of poses for one request: ``plan`` in a ``PoseSpace``.

    ``options`` are those of ``plan`` that have a meaning for poses, and ``heading_tolerance`` and
    ``reverse_penalty``.

    Raises
    ------
    RequestError
        When an argument is malformed; the message names the value and the rule.

    """
    request = check_pose_request(space, start, goal, **options)
    began, before = working_time(), interpreted_calls()
    budget = effort.budget(began)
    return with_remark(_result(request, effort, budget, began), before)


def _result(request: PoseRequest, effort: Effort, budget: Budget, began: float) -> PlanResult:
    """Return the result of a request; ``began`` is the time at which the call began."""
    space, disc = request.space, request.space.disc
    cells, components = place_ends(
        space.data, space.frame, disc.space.data, disc.kernel_centre, request.ends()
    )
    here, *there = components.tolist()
    if here == NOT_FREE:
        message = f'start {_words(request.start)} is {space.why_not_free(request.start)}'
        return _failure(request, PlannerStatus.INVALID_START, message, budget, began)
    if max(there) == NOT_FREE:
        message = f'goal {_words(request.goal)} is {space.why_not_free(request.goal)}'
        return _failure(request, PlannerStatus.INVALID_GOAL, message, budget, began)
    rows = [0, *(row for row, component in enumerate(there, start=1) if component == here)]
    if len(rows) == 1:
        message = (
            f'no path exists from start {_words(request.start)} to goal {_words(request.goal)}: '
            f'none for the largest disc in the footprint'
        )
        return _failure(request, PlannerStatus.UNREACHABLE, message, budget, began)
    roots = cells if len(rows) == len(cells) else cells[rows]
    return _search(request, disc, roots, effort, budget, began)


def _search(
    request: PoseRequest,
    disc: Disc,
    roots: Floats,
    effort: Effort,
    budget: Budget,
    began: float,
) -> PlanResult:
    """
    Search for a path between ``roots`` (k, 3), and return the result.

    They are the start and the goals that may be reached, kernel frame.
    """
    searches = PoseSearches(request, disc, roots, budget, began)
    best, work = searches.first()
    if best.path is not None and effort.optimizes:
        optimizing = effort.optimizing(budget, began)
        best, work = searches.optimize(best, work, effort.optimize_rounds, optimizing)
        budget.cut = budget.cut or optimizing.cut
    samples = request.space.from_kernel(best.search.samples)
    samples[0] = request.start
    path = best.path or NO_PATH
    return PlanResult(
        status=best.status,
        message=_message(best, work.iterations, working_time() - began),
        planner=request.name,
        path=path.poses,
        twists=path.twists,
        length=path.length,
        samples=samples,
        parents=best.search.parents.copy(),
        iterations=work.iterations,
        counts=work.counts,
        elapsed=working_time() - began,
        seed=request.seed,
        cut_by_time=budget.cut,
        first_solution=best.first,
        lower_bound=_straight(request),
    )


def _failure(
    request: PoseRequest, status: PlannerStatus, message: str, budget: Budget, began: float
) -> PlanResult:
    """Return the result of a request that needs no search."""
    return PlanResult.without_search(
        status,
        message,
        planner=request.name,
        dim=3,
        seed=request.seed,
        elapsed=working_time() - began,
        cut_by_time=budget.cut,
        lower_bound=math.inf if status is PlannerStatus.UNREACHABLE else _straight(request),
        twists=np.empty((0, 3)),
    )


def _straight(request: PoseRequest) -> float:
    """Return the straight distance [m] from the start to the goal region: no path is shorter."""
    return max(math.dist(request.start[:2], request.goal[:2]) - request.goal_radius, 0.0)


def _message(best: PoseAttempt, iterations: int, seconds: float) -> str:
    """Return a description of how the search ended, with lengths [m] and counts."""
    if best.path is None:
        return f'{best.status.value} ({iterations} transitions, {seconds:.3g} s)'
    return (
        f'path of {best.path.length:.6g} m with {len(best.path.twists)} motions after '
        f'{iterations} transitions'
    )


def _words(pose: Floats) -> str:
    return '(' + ', '.join(f'{x:g}' for x in pose) + ')'
