"""
``plan`` for a system: one request, one answer with a trajectory.

As for a robot without inertia: the planners search and count, and here the request is checked, the
clock owned, a cancellation heard and the end told in words.
"""

from dataclasses import dataclass
import math
from typing import Any

from hnr_planner.core.cancellation import Event
from hnr_planner.core.checks import check_number, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.clock import working_time
from hnr_planner.core.kernels.streams import stream
from hnr_planner.core.planning.attempts import SEARCH, search_until_free, SHORTEN
from hnr_planner.core.planning.limits import Budget
from hnr_planner.core.planning.request import (
    check_effort,
    check_request,
    Effort,
    outcome_without_search,
    Request,
)
from hnr_planner.core.planning.result import FirstSolution, PlannerStatus
from hnr_planner.core.spaces.curves.curve import knows_curves
from hnr_planner.core.spaces.primitives import kind_of
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.systems.double_integrator import DoubleIntegrator
from hnr_planner.core.systems.primitives import first_blocked_step
from hnr_planner.core.systems.system import System, vectors_to_kernel
from hnr_planner.core.systems.trajectory import Trajectory
from hnr_planner.core.trajectories.connect import compile_connect, KinodynamicConnect
from hnr_planner.core.trajectories.inevitable import (
    compile_inevitable,
    is_collision_inevitable,
)
from hnr_planner.core.trajectories.problem import (
    is_at_goal,
    KinodynamicPlanner,
    KinodynamicProblem,
    KinodynamicSearch,
    Motion,
)
from hnr_planner.core.trajectories.registry import make_kinodynamic_planner
from hnr_planner.core.trajectories.result import TrajectoryResult
from hnr_planner.core.trajectories.shorten import shorten_in_time
from hnr_planner.core.trajectories.steps import can_brake
import numpy as np
from numpy.typing import ArrayLike

#: Proposals for a shorter motion: for every request, for each of ``optimize_iterations``, and
#: between two looks at the clock.
PROPOSALS, PROPOSALS_AGAIN, PROPOSALS_IN_A_BATCH = 2000, 10000, 200


@dataclass(frozen=True)
class KinodynamicRequest:
    """
    A request whose numbers are clean.

    Attributes
    ----------
    place : Request
        The same for a robot without inertia.
    system : System
        What moves.
    start : (state_dim,)
        Caller's frame.
    planner : KinodynamicPlanner
        Who searches.
    problem : KinodynamicProblem
        The same in the kernel frame.

    """

    geometric: Request
    system: System
    start: Floats
    planner: KinodynamicPlanner
    problem: KinodynamicProblem


def check_kinodynamic_request(
    space: Space,
    start: ArrayLike,
    goal: ArrayLike,
    system: System,
    *,
    algorithm: Any,
    settings: dict[str, Any],
    goal_radius: float,
    goal_speed: float,
    simplify: bool,
    seed: int | None,
) -> KinodynamicRequest:
    """Return the request that a caller's arguments make, or raise RequestError."""
    if not isinstance(getattr(system, 'state_dim', None), int):
        raise RequestError(f'system must be a system such as DoubleIntegrator(), got {system!r}')
    if system.dim != space.dim:
        raise RequestError(
            f'system must be of the dimension of the space, {space.dim}, got {system.dim}'
        )
    if not knows_curves(space.data):
        raise RequestError(
            f'system must be None in a {type(space).__name__}: it does not know where curves '
            'leave it'
        )
    state = system.check_state('start', start)
    planner = make_kinodynamic_planner(algorithm, settings, system)
    speed = check_number('goal_speed', goal_speed, 0.0)
    geometric = check_request(
        space, state[: system.dim], goal, goal_radius=goal_radius, simplify=simplify, seed=seed
    )
    for name, value in (('goal_radius', geometric.goal_radius), ('goal_speed', speed)):
        if planner.samples_goal and value == 0.0:
            raise RequestError(
                f'{name} must be above 0 for {planner.name}, whose states never lie exactly at '
                'the goal, got 0.0'
            )
    problem = KinodynamicProblem(
        geometric.problem,
        system.compiled(space),
        system.to_kernel(space, state),
        speed / space.scale,
    )
    return KinodynamicRequest(geometric, system, state, planner, problem)


def plan_trajectory(
    space: Space,
    system: System,
    start: ArrayLike,
    goal: ArrayLike,
    *,
    algorithm: Any = 'auto',
    goal_radius: float = 0.0,
    goal_speed: float = math.inf,
    time_limit: float = 1.0,
    max_iterations: int | None = None,
    seed: int | None = None,
    simplify: bool = True,
    optimize_for: float = 0.0,
    optimize_iterations: int = 0,
    cancel: Event | None = None,
    **settings: Any,
) -> TrajectoryResult:
    """Find a trajectory of a system from a state ``start`` to the point ``goal`` (dim,)."""
    effort = check_effort(
        time_limit=time_limit,
        max_iterations=max_iterations,
        optimize_for=optimize_for,
        optimize_iterations=optimize_iterations,
        cancel=cancel,
    )
    request = check_kinodynamic_request(
        space,
        start,
        goal,
        system,
        algorithm=algorithm,
        settings=settings,
        goal_radius=goal_radius,
        goal_speed=goal_speed,
        simplify=simplify,
        seed=seed,
    )
    return plan_motion(request, effort)


def plan_motion(request: KinodynamicRequest, effort: Effort) -> TrajectoryResult:
    """Plan for a validated request, within the limits of ``effort``."""
    _compile(request)
    began = working_time()
    limits = effort.budget(began)
    known = _without_search(request)
    if known is not None:
        return _answer(request, *known, limits, began)
    status, search, found = _search(request, limits)
    if found is None:
        spent = f'{search.iterations} transitions, {working_time() - began:.3g} s'
        return _answer(request, status, f'{status.value} ({spent})', None, limits, began, search)
    motion, trajectory = found
    first = FirstSolution(working_time() - began, trajectory.length, trajectory.positions)
    if isinstance(request.system, DoubleIntegrator) and request.geometric.simplify:
        improving = effort.optimizing(limits, began)
        proposals = PROPOSALS + PROPOSALS_AGAIN * effort.optimize_rounds
        trajectory = _shortened(request, motion, trajectory, proposals, improving)
        limits.cut = limits.cut or improving.cut
    message = (
        f'trajectory of {trajectory.duration:.6g} s with {len(trajectory.controls)} steps after '
        f'{search.iterations} transitions'
    )
    return _answer(request, status, message, trajectory, limits, began, search, first)


def _without_search(
    request: KinodynamicRequest,
) -> tuple[PlannerStatus, str, Trajectory | None] | None:
    """Say how a request ends that needs no search, and why; None for one that does."""
    known = outcome_without_search(request.geometric)
    if known is not None and known[0] is not PlannerStatus.SOLVED:
        return *known, None
    problem = request.problem
    if is_at_goal(problem, problem.start):
        stay = np.zeros((1, request.system.control_dim))
        there = Trajectory(request.system, np.zeros(2), np.stack([request.start] * 2), stay)
        return PlannerStatus.SOLVED, 'start lies in the goal region', there
    if request.planner.boundary == 'forbidden' and _cannot_stop(request):
        return (
            PlannerStatus.INEVITABLE_COLLISION,
            f'start moves at {request.system.speed(request.start):g} m/s and can neither stop '
            'before the boundary nor turn away from it',
            None,
        )
    return None


def _cannot_stop(request: KinodynamicRequest) -> bool:
    """Say whether it is proved that the start runs into the boundary."""
    problem = request.problem
    if can_brake(problem, problem.start, request.system.control_dim):
        return False
    geometric, velocity = problem.geometric, request.system.velocity(request.start)
    return is_collision_inevitable(
        geometric.space,
        (geometric.lower, geometric.upper),
        geometric.start,
        vectors_to_kernel(request.geometric.space, velocity),
        request.system.largest_acceleration / geometric.scale,
    )


def _search(
    request: KinodynamicRequest, limits: Budget
) -> tuple[PlannerStatus, KinodynamicSearch, tuple[Motion, Trajectory] | None]:
    """Search for a motion that is free in the caller's coordinates too, as ``plan`` does."""

    def start(salt: int) -> KinodynamicSearch:
        return request.planner.start(request.problem, request.geometric.stream(0, SEARCH, salt))

    def free_motion(search: KinodynamicSearch) -> tuple[Motion, Trajectory] | None:
        motion = search.motion
        trajectory = _in_caller_s_frame(request, motion)
        return (motion, trajectory) if is_free(request, trajectory) else None

    return search_until_free(start, free_motion, limits)


def _shortened(
    request: KinodynamicRequest,
    motion: Motion,
    trajectory: Trajectory,
    proposals: float,
    limits: Budget,
) -> Trajectory:
    """Return the trajectory made shorter by so many proposals within limits, if it is free."""
    rng, left = request.geometric.stream(0, SHORTEN), proposals
    while left > 0 and limits.stop() is None:
        batch = int(min(left, PROPOSALS_IN_A_BATCH))
        motion = shorten_in_time(request.problem, motion, rng, batch)
        left -= batch
    shorter = _in_caller_s_frame(request, motion)
    return shorter if is_free(request, shorter) else trajectory


def _in_caller_s_frame(request: KinodynamicRequest, motion: Motion) -> Trajectory:
    """Trajectory of a motion found in the kernel frame; its ends are the caller's own numbers."""
    system, space = request.system, request.geometric.space
    states = system.from_kernel(space, motion.states)
    states[0] = request.start
    if motion.states[-1, : system.dim].tolist() == request.problem.geometric.goal.tolist():
        states[-1, : system.dim] = request.geometric.goal
    times = np.append(0.0, np.cumsum(motion.durations))
    return Trajectory(system, times, states, system.controls_from_kernel(space, motion.controls))


def is_free(request: KinodynamicRequest, trajectory: Trajectory) -> bool:
    """Say whether no step of a trajectory meets the boundary."""
    system, space = request.system, request.geometric.space
    step = first_blocked_step(
        request.problem.system,
        space.data,
        system.to_kernel(space, trajectory.states),
        system.controls_to_kernel(space, trajectory.controls),
        np.diff(trajectory.times),
    )
    return bool(step < 0)


def _answer(
    request: KinodynamicRequest,
    status: PlannerStatus,
    message: str,
    trajectory: Trajectory | None,
    limits: Budget,
    began: float,
    search: KinodynamicSearch | None = None,
    first: FirstSolution | None = None,
) -> TrajectoryResult:
    """Return the answer; one without a search has the start as its only sample, if it is free."""
    space, dim = request.geometric.space, request.system.dim
    length = math.inf if trajectory is None else trajectory.length
    if search is not None:
        samples, parents = space.from_kernel(search.samples), search.parents.copy()
        samples[0] = request.geometric.start
    else:
        free = 0 if trajectory is None else 1
        samples, parents = np.tile(request.geometric.start, (free, 1)), np.full(free, -1)
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
        cut_by_time=limits.cut,
        first_solution=first,
        trajectory=trajectory,
    )


_compiled: set[tuple[Any, ...]] = set()


def _compile(request: KinodynamicRequest) -> None:
    """Compile, once for each kind of space, planner and system, before any clock runs."""
    system, geometric = request.system, request.problem.geometric
    kinds = kind_of(geometric.space), type(request.planner), type(request.problem.system)
    if kinds in _compiled:
        return
    # Nobody has looked at start and goal yet, which may lie anywhere: the bounds stand for them.
    rest = np.append(geometric.lower, np.zeros(system.state_dim - system.dim))
    bounded = geometric._replace(start=geometric.lower, goal=geometric.upper)
    problem = request.problem._replace(geometric=bounded, start=rest)
    outcome_without_search(request.geometric)
    is_at_goal(problem, rest)
    can_brake(problem, rest, system.control_dim)
    compile_inevitable(geometric.space)
    search = request.planner.start(problem, stream(0))
    for _ in range(2):
        search.advance(0)
    if isinstance(request.planner, KinodynamicConnect):
        compile_connect(problem)
    motion = Motion(np.zeros(1), np.stack([rest, rest]), np.zeros((1, system.control_dim)))
    if isinstance(request.system, DoubleIntegrator):
        shorten_in_time(problem, motion, stream(0), 0)
    is_free(request, _in_caller_s_frame(request, motion))
    _compiled.add(kinds)
