"""
``plan_trajectory``: find a trajectory for one request.

A planner searches and counts its transitions. ``plan_trajectory`` validates the request, enforces
its limits of time, iterations and cancellation, and builds the result.
"""

import math
from typing import Any

from hnr_planner.core.cancellation import Event
from hnr_planner.core.checks import check_number
from hnr_planner.core.kernels.clock import working_time
from hnr_planner.core.kernels.kernel import interpreted_calls
from hnr_planner.core.planning.limits import Budget
from hnr_planner.core.planning.request import check_effort, Effort
from hnr_planner.core.planning.result import FirstSolution, PlannerStatus
from hnr_planner.core.planning.tiers import with_remark
from hnr_planner.core.spaces.grid.grid_space import GridSpace
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.systems.car import Car
from hnr_planner.core.systems.system import System
from hnr_planner.core.systems.trajectory import Trajectory
from hnr_planner.core.trajectories.attempt import Found, search_trajectory, shortened
from hnr_planner.core.trajectories.car import plan_car
from hnr_planner.core.trajectories.problem import Boundary, KinodynamicPlanner, KinodynamicSearch
from hnr_planner.core.trajectories.reduce import STEPS_MAX
from hnr_planner.core.trajectories.request import (
    check_kinodynamic_request,
    check_optimization,
    KinodynamicRequest,
    outcome_before_search,
)
from hnr_planner.core.trajectories.result import TrajectoryResult
import numpy as np
from numpy.typing import ArrayLike


def plan_trajectory(
    space: Space,
    system: System,
    start: ArrayLike,
    goal: ArrayLike,
    *,
    algorithm: str | KinodynamicPlanner = 'auto',
    goal_radius: float = 0.0,
    goal_speed: float = math.inf,
    boundary: Boundary = 'forbidden',
    time_limit: float = 1.0,
    max_iterations: int | None = None,
    seed: int | None = None,
    simplify: bool | None = None,
    optimize_for: float = 0.0,
    optimize_iterations: int = 0,
    cancel: Event | None = None,
    **settings: Any,
) -> TrajectoryResult:
    """
    Find a trajectory of a system that is free in a space and ends at a goal.

    Parameters
    ----------
    space : Space
        The free set that the trajectory has to stay in.
    system : System
        The robot, such as ``DoubleIntegrator(max_acceleration=1.0, max_speed=1.0)``.
    start : (state_dim,)
        State of the system in the caller's frame: position, then the velocity of a
        ``DoubleIntegrator``, or heading and speed of a ``Car``.
    goal : (dim,)
        Position to reach, in the caller's frame [m]; for a ``Car`` on a grid also a pose
        (x, y, heading).
    algorithm : str or planner
        A name of ``KINODYNAMIC_ALGORITHMS`` or a planner value such as
        ``KinodynamicRRT(time_step=0.2)``. 'auto' is ``kinodynamic_connect`` for a
        ``DoubleIntegrator``. For a ``Car`` on a grid with a forbidden boundary it is
        ``hit_and_run_connect`` in the space of poses and the fastest drive along its path, which
        ends at rest; else ``kinodynamic_rrt``.
    goal_radius : float
        Above 0 the trajectory ends within this distance [m] of the goal; at 0 exactly at the goal,
        which ``kinodynamic_rrt`` and ``kinodynamic_hit_and_run`` cannot do.
    goal_speed : float
        Largest speed at the end [m/s]; inf for any. ``kinodynamic_rrt`` and
        ``kinodynamic_hit_and_run`` cannot end at rest (0).
    boundary : 'forbidden' or 'inelastic'
        Effect of the boundary of the space. Forbidden: it is never met, and the end of the
        trajectory can be braked straight to rest before it; a start whose collision can be proved
        is an INEVITABLE_COLLISION. Inelastic (the paper's): it stops the robot at once, which
        goes on from there, and trajectories may use that. A planner value brings its own.
    time_limit : float
        Seconds for the whole call, inf for no limit. Compilation does not count.
    max_iterations : int, optional
        Transitions allowed for one search; None for no limit.
    seed : int, optional
        Seed of the random streams. Left out: a new random seed; the result has the seed used.
    simplify : bool, optional
        Whether the trajectory is shortened in time. Left out: where that can be done, for a
        ``DoubleIntegrator`` and by 'auto' for a ``Car`` on a grid; and one of more than 10,000
        steps that cannot be shortened is refused. False: the trajectory is returned as it was
        found, however long it is.
    optimize_for : float
        Seconds of the call, within the time limit, in which the trajectory is shortened further.
    optimize_iterations : int
        Number of further rounds of shortening; where ``optimize_for`` is given too, the first to
        end counts.
    cancel : threading.Event, optional
        Ends the call once it is set.
    **settings
        Settings of the planner that ``algorithm`` names; for a ``Car`` by 'auto' on a grid
        ``heading_tolerance`` [rad] and ``reverse_penalty``, as in ``plan`` in a ``PoseSpace``.

    Returns
    -------
    TrajectoryResult
        Not finding a trajectory is a status, never an exception.

    Raises
    ------
    RequestError
        When an argument is malformed or does not go with another; the message names the value and
        the rule.

    """
    effort = check_effort(
        time_limit=time_limit,
        max_iterations=max_iterations,
        optimize_for=optimize_for,
        optimize_iterations=optimize_iterations,
        cancel=cancel,
    )
    if (
        isinstance(system, Car)
        and isinstance(space, GridSpace)
        and (algorithm, boundary) == ('auto', 'forbidden')
    ):
        check_number('goal_speed', goal_speed, 0.0)  # the car ends at rest: within any
        before = interpreted_calls()
        driven = plan_car(
            space,
            system,
            start,
            goal,
            effort,
            goal_radius=goal_radius,
            simplify=simplify,
            seed=seed,
            **settings,
        )
        return with_remark(driven, before)
    request = check_kinodynamic_request(
        space,
        system,
        start,
        goal,
        algorithm=algorithm,
        settings=settings,
        goal_radius=goal_radius,
        goal_speed=goal_speed,
        boundary=boundary,
        simplify=simplify,
        seed=seed,
    )
    check_optimization(request, effort)

    began, before = working_time(), interpreted_calls()
    budget = effort.budget(began)
    interrupted: tuple[PlannerStatus, str] | None = PlannerStatus.TIMEOUT, ''
    known = budget.within(lambda: outcome_before_search(request), interrupted)
    if known is interrupted:
        status = budget.stop() or PlannerStatus.TIMEOUT
        known = status, status.value
    if known is not None:
        result = _result(request, *known, _stay(request, known[0]), budget, began)
    else:
        result = _result_of_search(request, effort, budget, began)
    return with_remark(result, before)


def _stay(request: KinodynamicRequest, status: PlannerStatus) -> Trajectory | None:
    """Return a trajectory of one step of 0 s at the start if ``status`` is SOLVED, else None."""
    if status is not PlannerStatus.SOLVED:
        return None
    control = np.zeros((1, request.system.control_dim))
    return Trajectory(request.system, np.zeros(2), np.stack([request.start] * 2), control)


def _result_of_search(
    request: KinodynamicRequest, effort: Effort, budget: Budget, began: float
) -> TrajectoryResult:
    """Search, shorten the trajectory found if the request says so, and return the result."""
    status, search, found = search_trajectory(request, budget, began)
    if found is None or found.trajectory is None:
        if found is not None:
            status = budget.stop() or PlannerStatus.ITERATION_LIMIT
        message = _failure(status, search, found, working_time() - began)
        return _result(request, status, message, None, budget, began, search)
    trajectory = found.trajectory
    if request.shortens:
        trajectory = shortened(request, found.motion, trajectory, effort, budget, began)
    message = (
        f'trajectory of {trajectory.duration:.6g} s with {len(trajectory.controls)} steps after '
        f'{search.iterations} transitions'
    )
    return _result(request, status, message, trajectory, budget, began, search, found.first)


def _failure(
    status: PlannerStatus, search: KinodynamicSearch, found: Found | None, seconds: float
) -> str:
    """Return a message: how a search failed, or that the motion found has too many steps."""
    spent = f'{search.iterations} transitions, {seconds:.3g} s'
    if found is None:
        return f'{status.value} ({spent})'
    steps, duration = len(found.motion.durations), float(found.motion.durations.sum())
    return (
        f'the motion that was found takes {duration:.6g} s in {steps} steps, more than the '
        f'{STEPS_MAX} that a robot would drive, and was not shortened to fewer ({spent})'
    )


def _result(
    request: KinodynamicRequest,
    status: PlannerStatus,
    message: str,
    trajectory: Trajectory | None,
    budget: Budget,
    began: float,
    search: KinodynamicSearch | None = None,
    first: FirstSolution | None = None,
) -> TrajectoryResult:
    """
    Return the result of a request.

    Without a search the samples are empty, or the start alone if staying there is the solution.
    """
    space, dim = request.geometric.space, request.system.dim
    length = math.inf if trajectory is None else trajectory.length
    if search is not None:
        samples, parents = space.from_kernel(search.samples), search.parents.copy()
        samples[0] = request.geometric.start
    else:
        n_samples = 0 if trajectory is None else 1
        samples = np.tile(request.geometric.start, (n_samples, 1))
        parents = np.full(n_samples, -1)
    if trajectory is not None and first is None:
        first = FirstSolution(working_time() - began, length, trajectory.positions)
    return TrajectoryResult(
        status=status,
        message=message,
        planner=request.planner.name,
        path=np.empty((0, dim)) if trajectory is None else trajectory.positions,
        length=length,
        samples=samples,
        parents=parents,
        iterations=0 if search is None else search.iterations,
        counts={} if search is None else search.counts,
        elapsed=working_time() - began,
        seed=request.geometric.seed,
        cut_by_time=budget.cut,
        first_solution=first,
        trajectory=trajectory,
    )
