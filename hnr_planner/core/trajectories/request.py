"""Validation of requests for a trajectory, and the outcome of requests that need no search."""

from dataclasses import dataclass
from typing import Any

from hnr_planner.core.checks import check_choice, check_number, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.planning.registry import make_planner
from hnr_planner.core.planning.request import (
    check_request,
    Effort,
    outcome_without_search,
    Request,
)
from hnr_planner.core.planning.result import PlannerStatus
from hnr_planner.core.spaces.curves.curve import supports_curves
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.systems.double_integrator import DoubleIntegrator
from hnr_planner.core.systems.system import System, vectors_to_kernel
from hnr_planner.core.trajectories.connect import KinodynamicConnect
from hnr_planner.core.trajectories.inevitable import is_collision_inevitable
from hnr_planner.core.trajectories.problem import (
    BOUNDARIES,
    is_at_goal,
    KinodynamicPlanner,
    KinodynamicProblem,
)
from hnr_planner.core.trajectories.registry import KINODYNAMIC_ALGORITHMS, KINODYNAMIC_ENTRIES
from hnr_planner.core.trajectories.rrt import KinodynamicRRT
from hnr_planner.core.trajectories.steps import can_brake
from numpy.typing import ArrayLike

#: Arguments of ``plan`` that ``plan_trajectory`` does not have.
OF_PATHS = ('alternatives', 'clearance', 'goal_tolerance', 'start_escape')


@dataclass(frozen=True)
class KinodynamicRequest:
    """
    A validated request for a trajectory.

    Attributes
    ----------
    geometric : Request
        The same request for a point without inertia: space, start position, goal and seed.
    system : System
        The robot.
    start : (state_dim,)
        The state at the start, in the caller's frame.
    planner : KinodynamicPlanner
        The planner that searches.
    problem : KinodynamicProblem
        The same problem in the kernel frame.
    shortens : bool
        Whether the trajectory is shortened in time.
    any_length : bool
        Whether the trajectory is returned as it was found, however long it is.

    """

    geometric: Request
    system: System
    start: Floats
    planner: KinodynamicPlanner
    problem: KinodynamicProblem
    shortens: bool
    any_length: bool


def check_kinodynamic_request(
    space: Space,
    system: System,
    start: ArrayLike,
    goal: ArrayLike,
    *,
    algorithm: Any,
    settings: dict[str, Any],
    goal_radius: float,
    goal_speed: float,
    boundary: str,
    simplify: bool | None,
    seed: int | None,
) -> KinodynamicRequest:
    """
    Return the validated request of the arguments of ``plan_trajectory``.

    Raises RequestError if an argument is malformed or does not go with another one.
    """
    if not isinstance(getattr(system, 'state_dim', None), int):
        raise RequestError(f'system must be a system such as DoubleIntegrator(), got {system!r}')
    if system.dim != space.dim:
        raise RequestError(
            f'system must be of the dimension of the space, {space.dim}, got {system.dim}'
        )
    if not supports_curves(space.data):
        raise RequestError(
            f'no trajectory can be planned in a {type(space).__name__}, which does not compute '
            f'the first exit of curves, got system {system!r}'
        )
    state = system.check_state('start', start)
    planner = make_kinodynamic_planner(algorithm, settings, system, boundary)
    speed = check_number('goal_speed', goal_speed, 0.0)
    shortens = _check_simplify(simplify, system)
    geometric = check_request(
        space, state[: system.dim], goal, goal_radius=goal_radius, simplify=shortens, seed=seed
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
    any_length = simplify is not None and not simplify
    return KinodynamicRequest(geometric, system, state, planner, problem, shortens, any_length)


def make_kinodynamic_planner(
    algorithm: Any, settings: dict[str, Any], system: System, boundary: str = 'forbidden'
) -> KinodynamicPlanner:
    """
    Return the planner that ``algorithm`` means for a system.

    A name is built with ``settings`` and, except ``kinodynamic_connect``, with ``boundary``. A
    planner value is returned as it is, with its own boundary.

    Raises
    ------
    RequestError
        When name, setting or boundary are unknown or do not go together, settings come beside a
        planner value, or the planner does not support this system.

    """
    check_choice('boundary', boundary, BOUNDARIES)
    for name in OF_PATHS:
        if name in settings:
            raise RequestError(f'plan_trajectory takes no {name}: it is for paths, of plan')
    connects = isinstance(system, DoubleIntegrator)
    if isinstance(algorithm, str):
        check_choice('algorithm', algorithm, KINODYNAMIC_ALGORITHMS)
        if algorithm == 'auto':
            algorithm = (KinodynamicConnect if connects else KinodynamicRRT).name
        if algorithm != KinodynamicConnect.name:
            settings = {**settings, 'boundary': boundary}
    planner: Any = make_planner(algorithm, settings, KINODYNAMIC_ENTRIES)
    if not hasattr(planner, 'boundary'):
        names = ', '.join(KINODYNAMIC_ALGORITHMS)
        raise RequestError(
            f'{planner.name} plans paths of points; for a system take one of {names}'
        )
    if boundary == 'inelastic' and planner.boundary != boundary:
        raise RequestError(
            f"boundary must be 'forbidden' for this {planner.name}, which never meets it, "
            f'got {boundary!r}'
        )
    if isinstance(planner, KinodynamicConnect) and not connects:
        raise RequestError(
            f'{planner.name} connects states of a DoubleIntegrator only, got a '
            f'{type(system).__name__}'
        )
    return planner


def _check_simplify(simplify: bool | None, system: System) -> bool:
    """
    Return whether a trajectory is shortened: ``simplify``, or what the system permits if None.

    Raises RequestError if shortening is requested for a system other than a double integrator.
    """
    can_be = isinstance(system, DoubleIntegrator)
    if simplify and not can_be:
        raise RequestError(
            f'simplify must be false or left out for a {type(system).__name__}: only '
            f'trajectories of a DoubleIntegrator can be shortened, got {simplify!r}'
        )
    return can_be if simplify is None else bool(simplify)


def check_optimization(request: KinodynamicRequest, effort: Effort) -> None:
    """Raise RequestError if optimization is requested but the trajectory is not shortened."""
    if request.shortens or not effort.optimizes:
        return
    why = (
        'when simplify is false'
        if isinstance(request.system, DoubleIntegrator)
        else f'for a {type(request.system).__name__}, whose trajectories cannot be shortened'
    )
    for name in ('optimize_for', 'optimize_iterations'):
        value = getattr(effort, name)
        if value > 0:
            raise RequestError(f'{name} must be 0 {why}, got {value!r}')


def outcome_before_search(request: KinodynamicRequest) -> tuple[PlannerStatus, str] | None:
    """
    Return the status of a request that needs no search, and the reason; None for one that does.

    No search is needed when start or goal is not free, when start and goal lie in different
    components of the free space, when the boundary is forbidden and a collision is proved
    inevitable, or when the start lies in the goal region and is slow enough.
    """
    known = outcome_without_search(request.geometric)
    if known is not None and known[0] is not PlannerStatus.SOLVED:
        return known
    if request.planner.boundary == 'forbidden' and _is_doomed(request):
        return (
            PlannerStatus.INEVITABLE_COLLISION,
            f'start moves at {request.system.speed(request.start):g} m/s and can neither stop '
            'before the boundary nor turn away from it',
        )
    if is_at_goal(request.problem, request.problem.start):
        return PlannerStatus.SOLVED, 'start lies in the goal region'
    return None


def _is_doomed(request: KinodynamicRequest) -> bool:
    """Return whether a collision with the boundary is proved inevitable; False proves nothing."""
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
