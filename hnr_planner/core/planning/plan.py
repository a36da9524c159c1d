"""
``plan``: find a path for one request.

The planners search and count their work. ``plan`` validates the request, enforces its limits, and
has the result built (``build_result``).
"""

from dataclasses import replace
from typing import Any

from hnr_planner.core.cancellation import Event
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.clock import working_time
from hnr_planner.core.kernels.kernel import interpreted_calls
from hnr_planner.core.planning.alternatives.alternatives import (
    check_alternatives,
    with_alternatives,
)
from hnr_planner.core.planning.attempts import attempt, optimize
from hnr_planner.core.planning.build_result import result_of_search, result_without_search
from hnr_planner.core.planning.ends import Allowance, check_allowance, move_ends, MovedRequest
from hnr_planner.core.planning.limits import Budget
from hnr_planner.core.planning.planner import Planner
from hnr_planner.core.planning.poses.plan_poses import plan_poses
from hnr_planner.core.planning.poses.request import refuse_options
from hnr_planner.core.planning.request import (
    check_effort,
    check_request,
    Effort,
    Request,
)
from hnr_planner.core.planning.result import PlannerStatus, PlanResult
from hnr_planner.core.planning.tiers import with_remark
from hnr_planner.core.spaces.poses.pose_space import PoseSpace
from hnr_planner.core.spaces.space import Space
from numpy.typing import ArrayLike

#: Arguments of ``plan_trajectory`` that ``plan`` does not have.
OF_TRAJECTORIES = ('system', 'goal_speed')


def plan(
    space: Space,
    start: ArrayLike,
    goal: ArrayLike,
    *,
    algorithm: str | Planner = 'auto',
    goal_radius: float = 0.0,
    time_limit: float = 1.0,
    max_iterations: int | None = None,
    seed: int | None = None,
    simplify: bool = True,
    clearance: float = 0.0,
    optimize_for: float = 0.0,
    optimize_iterations: int = 0,
    alternatives: int = 1,
    goal_tolerance: float = 0.0,
    start_escape: float = 0.0,
    cancel: Event | None = None,
    **settings: Any,
) -> PlanResult:
    """
    Find a free path from start to goal, and return it in a result with its status.

    Parameters
    ----------
    space : Space
        Where the path has to be free.
    start, goal : (dim,)
        Points in the caller's frame [m].
    algorithm : str or planner
        A name of ``ALGORITHMS`` or a planner value such as ``RRT(max_step=0.5)``.
    goal_radius : float
        Above 0 the path ends within this distance [m] of the goal (the paper's goal region): at
        the first sample there, or where a tree that grew from the goal began. At 0 it ends exactly
        at the goal, as soon as the segment to it is free.
    time_limit : float
        Seconds for the whole call, inf for no limit. Compilation does not count.
    max_iterations : int, optional
        Number of transitions allowed for one search; no limit when left out.
    seed : int, optional
        Seed of all random streams; a fresh one when left out. The result names the seed used.
    simplify : bool
        Whether sections of the path are replaced by free straight segments to shorten it.
    clearance : float
        Distance to obstacles [m] that the path keeps where it can; narrower passages are passed
        in their middle. 0 for the shortest path. It needs ``simplify`` and a space that
        measures the distance to its walls. On a grid, ``auto`` with further searches and
        ``polyanya`` also search for the shortest path over the cells that keep it everywhere, and
        ``PlanResult.clear_lower_bound`` is a bound on the length of all paths over these cells.
    optimize_for : float
        Seconds of the call, within the time limit, for further searches for a shorter path; they
        end once the path is straight. The clock only cuts: searches are bounded by their number,
        in proportion to the seconds, and end sooner when several in a row gain nothing. So the
        same seed gives the same path on a machine that is fast enough.
    optimize_iterations : int
        Number of further searches for a shorter path, instead of the number that follows from
        ``optimize_for``; where both are given, the first to end counts.
    alternatives : int
        Number of paths to find, none of which can be deformed into another past an obstacle:
        ``PlanResult.paths``, the shortest first. There may be fewer. All have the same ends, also
        in a goal region. On a grid and without a clearance each is the shortest path that it can
        be deformed into, and no others are shorter (``PlanResult.next_lower_bound``).
    goal_tolerance : float
        Where the goal is blocked or cannot be reached, the path ends at the nearest point within
        this distance [m] that can: ``PlanResult.goal_offset`` and the message state it. A goal
        that is free and reachable is never moved. It needs a space with ``nearest_reachable``.
    start_escape : float
        Where the start is blocked by inflation, or in an unknown cell, the path begins with a
        straight segment to free space of at most this length [m]: ``PlanResult.escape`` and the
        message state it. It crosses no occupied cell; from inside an obstacle there is none. It
        needs a ``GridSpace``.
    cancel : threading.Event, optional
        Event that ends the call once the event is set.
    **settings
        Settings of the planner that ``algorithm`` names. In a ``PoseSpace``: ``heading_tolerance``
        [rad], 0 by default, by which the path's end may be turned from the goal, and
        ``reverse_penalty``, at least 1, a factor on the length driven backwards, 2 by default.

    Returns
    -------
    PlanResult
        Not finding a path is a status, never an exception.

    Raises
    ------
    RequestError
        When an argument is malformed; the message names the value and the rule.

    """
    _refuse_trajectories(settings)
    effort = check_effort(
        time_limit=time_limit,
        max_iterations=max_iterations,
        optimize_for=optimize_for,
        optimize_iterations=optimize_iterations,
        cancel=cancel,
    )
    if isinstance(space, PoseSpace):
        refuse_options(
            clearance=(clearance, 0.0),
            alternatives=(alternatives, 1),
            goal_tolerance=(goal_tolerance, 0.0),
            start_escape=(start_escape, 0.0),
        )
        return plan_poses(
            space,
            start,
            goal,
            effort,
            algorithm=algorithm,
            goal_radius=goal_radius,
            simplify=simplify,
            seed=seed,
            **settings,
        )
    request = check_request(
        space,
        start,
        goal,
        goal_radius=goal_radius,
        simplify=simplify,
        seed=seed,
        clearance=clearance,
        algorithm=algorithm,
        settings=settings,
    )
    n_paths = check_alternatives(space, alternatives, request.simplify)
    allowance = check_allowance(space, goal_tolerance, start_escape)

    began, before = working_time(), interpreted_calls()
    budget = effort.budget(began)
    moved = _move_ends_within(budget, request, allowance)
    request = moved.request
    if moved.outcome is not None:
        result = result_without_search(request, *moved.outcome, budget, began)
    else:
        result = _search(request, effort, budget, began)
    if n_paths > 1 and result.status is PlannerStatus.SOLVED:
        found = result
        result = budget.within(
            lambda: with_alternatives(request, found, n_paths, budget, began),
            replace(found, cut_by_time=True),
        )
    return with_remark(moved.restore_ends(result), before)


def _refuse_trajectories(settings: dict[str, Any]) -> None:
    for name in OF_TRAJECTORIES:
        if name in settings:
            raise RequestError(
                f'plan takes no {name}: a trajectory of a system is planned by '
                f'plan_trajectory(space, system, start, goal, ...)'
            )


def _move_ends_within(budget: Budget, request: Request, allowance: Allowance) -> MovedRequest:
    """
    Return the request with its ends moved where needed and allowed (``move_ends``).

    Where a limit of the budget interrupts the move, return the request with the outcome of that
    limit instead.
    """
    moved = budget.within(lambda: move_ends(request, allowance), None)
    if moved is not None:
        return moved
    status = budget.stop() or PlannerStatus.TIMEOUT
    return MovedRequest(request, (status, status.value), request.start)


def _search(request: Request, effort: Effort, budget: Budget, began: float) -> PlanResult:
    """
    Search for a path and return the result.

    Where the request asks for it and a path was found, further searches try to find a better one.
    ``began`` is the time at which the call began, on the clock of ``working_time`` [s].
    """
    optimizing = effort.optimizing(budget, began) if effort.optimizes else None
    best = attempt(request, 0, budget, began, optimizing)
    first, work = best.first, best.work
    if first is not None and optimizing is not None:
        rounds, patience = effort.optimize_rounds, effort.optimize_patience
        best, work = optimize(request, best, rounds, patience, optimizing, began)
        budget.cut = budget.cut or optimizing.cut
    return result_of_search(request, best, first, work, budget, began)
