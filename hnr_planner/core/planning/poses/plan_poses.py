"""
``plan`` in a space of poses: search for a path, shorten it, build the result.

The search begins with a proof or a guide: where no path of the largest disc in the footprint joins
start and goal, there is none for the footprint; else the shortest path of the disc guides it.
"""

import math
from typing import Any

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.clock import working_time
from hnr_planner.core.kernels.kernel import interpreted_calls
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.planning.limits import Budget, run
from hnr_planner.core.planning.poses.connections import cost_of, empty_connections
from hnr_planner.core.planning.poses.ends import NOT_FREE, place_ends
from hnr_planner.core.planning.poses.found_path import path_for_caller, PosePath
from hnr_planner.core.planning.poses.guide import detour_guide, shortest_guide
from hnr_planner.core.planning.poses.request import check_pose_request, PoseRequest
from hnr_planner.core.planning.poses.search import PoseSearch
from hnr_planner.core.planning.poses.shorten import shorten_path, SPARE_ROWS
from hnr_planner.core.planning.request import Effort
from hnr_planner.core.planning.result import FirstSolution, PlannerStatus, PlanResult
from hnr_planner.core.planning.tiers import with_remark
from hnr_planner.core.spaces.poses.disc import Disc
from hnr_planner.core.spaces.poses.pose_space import PoseSpace
import numpy as np
from numpy.typing import ArrayLike

#: Purposes of random streams.
SEARCH, SHORTEN = 0, 1
#: Sections that are tried at once, for each motion of a path and at least.
TRIES_PER_MOTION, TRIES_MIN = 4, 40
#: Rounds of tries for one path, and consecutive rounds that lower the cost by less than the
#: fraction ``LEAST_GAIN`` after which it counts as short.
ROUNDS_MAX, PATIENCE, LEAST_GAIN = 60, 3, 2e-3
#: Largest number of searches, where the caller's coordinates round a path into an obstacle.
RESTARTS_MAX = 20


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
    space, guide = request.space, np.empty((0, 3))
    if request.proposals.guided > 0.0:
        guide = shortest_guide(disc, roots[0], roots[1], budget)
    problem = request.problem(guide, disc)

    def other_guide(turn: int, stuck: Floats) -> Floats:
        if turn % 3 == 0:
            return guide
        return detour_guide(
            disc, roots[0], roots[1], stuck, space.data.stride, budget, request.seed + turn
        )

    first, best, iterations, number = None, None, 0, 0
    optimizing = effort.optimizing(budget, began) if effort.optimizes else budget
    status = PlannerStatus.TIMEOUT
    while True:
        limits = budget if best is None else optimizing
        search = PoseSearch(
            problem, request.proposals, roots, request.stream(SEARCH, number), other_guide
        )
        ended = run(search, limits)
        iterations += search.iterations
        path = _checked(request, *search.path) if ended is PlannerStatus.SOLVED else None
        if best is None:
            status, kept = ended, search
        if path is not None:
            if first is None:
                first = FirstSolution(working_time() - began, path.length, path.poses)
            if request.simplify and path.cost > 0.0:
                path = _shortened(request, path, request.stream(SHORTEN, number), limits)
            if best is None or path.cost < best.cost:
                best = path
        number += 1
        if best is None:
            if ended is not PlannerStatus.SOLVED or number == RESTARTS_MAX:
                break
        elif not effort.optimizes or number > effort.optimize_rounds or optimizing.stop():
            break
    budget.cut = budget.cut or optimizing.cut
    samples = space.from_kernel(kept.samples)
    samples[0] = request.start
    solved = best is not None
    return PlanResult(
        status=PlannerStatus.SOLVED if best is not None else status,
        message=_message(best, status, iterations, working_time() - began),
        planner=request.name,
        path=best.poses if best is not None else np.empty((0, 3)),
        twists=best.twists if best is not None else np.empty((0, 3)),
        length=best.length if best is not None else math.inf,
        samples=samples,
        parents=kept.parents.copy(),
        iterations=iterations,
        counts={},
        elapsed=working_time() - began,
        seed=request.seed,
        cut_by_time=budget.cut,
        first_solution=first if solved else None,
        lower_bound=_straight(request),
    )


def _checked(request: PoseRequest, poses: Floats, twists: Floats) -> PosePath | None:
    """Return a path of the kernel frame in the caller's, or None where it is not free there."""
    space = request.space
    *path, is_free = path_for_caller(
        space.data, space.frame, request.prices, poses, twists, request.start, request.goal
    )
    return PosePath(*path) if is_free else None


def _shortened(request: PoseRequest, path: PosePath, rng: Stream, budget: Budget) -> PosePath:
    """Return the path with sections replaced by cheaper ones, within the budget."""
    space, n = request.space, len(path.twists)
    rows = 2 * n + 4 * SPARE_ROWS
    poses, twists = np.zeros((rows + 1, 3)), np.zeros((rows, 3))
    poses[: n + 1] = space.to_kernel(path.poses)
    twists[:n] = space.twists_to_kernel(path.twists)
    spare = np.zeros((rows + 1, 3)), np.zeros((rows, 3))
    found, prices = empty_connections(), request.prices
    cost, idle = path.cost, 0
    for _ in range(ROUNDS_MAX):
        if idle >= PATIENCE or budget.stop() is not None:
            break
        tries = max(TRIES_MIN, TRIES_PER_MOTION * n)
        n = int(shorten_path(space.data, prices, poses, twists, n, *spare, found, rng, tries))
        lower = float(cost_of(prices, twists, n, 1.0))
        idle = 0 if lower < (1.0 - LEAST_GAIN) * cost else idle + 1
        cost = lower
    shorter = _checked(request, poses[: n + 1].copy(), twists[:n].copy())
    return path if shorter is None or shorter.cost >= path.cost else shorter


def _failure(
    request: PoseRequest, status: PlannerStatus, message: str, budget: Budget, began: float
) -> PlanResult:
    """Return the result of a request that needs no search."""
    return PlanResult(
        status=status,
        message=message,
        planner=request.name,
        path=np.empty((0, 3)),
        twists=np.empty((0, 3)),
        length=math.inf,
        samples=np.empty((0, 3)),
        parents=np.empty(0, dtype=np.int64),
        iterations=0,
        counts={},
        elapsed=working_time() - began,
        seed=request.seed,
        cut_by_time=budget.cut,
        first_solution=None,
        lower_bound=math.inf if status is PlannerStatus.UNREACHABLE else _straight(request),
    )


def _straight(request: PoseRequest) -> float:
    """Return the straight distance [m] from the start to the goal region: no path is shorter."""
    return max(math.dist(request.start[:2], request.goal[:2]) - request.goal_radius, 0.0)


def _message(best: PosePath | None, status: PlannerStatus, iterations: int, seconds: float) -> str:
    """Return a description of how the search ended, with lengths [m] and counts."""
    if best is None:
        return f'{status.value} ({iterations} transitions, {seconds:.3g} s)'
    return (
        f'path of {best.length:.6g} m with {len(best.twists)} motions after {iterations} '
        f'transitions'
    )


def _words(pose: Floats) -> str:
    return '(' + ', '.join(f'{x:g}' for x in pose) + ')'
