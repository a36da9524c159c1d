"""
``plan_trajectory`` for a car on a grid: a path of poses, and a speed profile along it.

The path is one of arcs and straight lines, free all along, that ends at a pose or, with a free
heading, at a position. It is driven as fast as the car can, from rest to rest between changes of
direction and at the end.
"""

import math
from typing import Any
from weakref import WeakKeyDictionary

from hnr_planner.core.checks import check_point, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.clock import working_time
from hnr_planner.core.planning.poses.plan_poses import plan_poses
from hnr_planner.core.planning.request import check_request, Effort, outcome_without_search
from hnr_planner.core.planning.result import FirstSolution, PlannerStatus, PlanResult
from hnr_planner.core.spaces.grid.grid_space import GridSpace
from hnr_planner.core.spaces.poses.pose_space import PoseSpace
from hnr_planner.core.systems.car import Car, SPEED
from hnr_planner.core.systems.system import vectors_to_kernel
from hnr_planner.core.systems.trajectory import join_trajectories, Trajectory
from hnr_planner.core.trajectories.inevitable import is_collision_inevitable
from hnr_planner.core.trajectories.result import TrajectoryResult
from hnr_planner.core.trajectories.speed_profile import drive_along
import numpy as np
from numpy.typing import ArrayLike

#: Half the width of the footprint of a car that is a point [cells]: far above rounding.
POINT = 1e-3
#: Curvatures of the arcs on which a moving car is braked, where it cannot go on as it is: the
#: first that is free, in units of the largest.
BRAKING_ARCS = (0.0, 0.5, -0.5, 1.0, -1.0)

_PRECISE: WeakKeyDictionary[GridSpace, dict[float, PoseSpace]] = WeakKeyDictionary()


def plan_car(
    space: GridSpace,
    system: Car,
    start: ArrayLike,
    goal: ArrayLike,
    effort: Effort,
    *,
    goal_radius: float,
    simplify: bool | None,
    seed: int | None,
    heading_tolerance: float = 0.0,
    **settings: Any,
) -> TrajectoryResult:
    """
    Find a trajectory of a car that is free in a grid and ends at rest at a goal.

    Parameters
    ----------
    space : GridSpace
        The free set that the car's position has to stay in.
    system : Car
        Its limits.
    start : (4,)
        State (x, y, heading, speed).
    goal : (2,) or (3,)
        A position, with any heading there, or a pose (x, y, heading).
    effort : Effort
        Limits on the work.
    goal_radius, simplify, seed
        Those of ``plan_trajectory``.
    heading_tolerance : float
        How far the heading at the end may be from that of the goal [rad].
    **settings
        Further settings of ``plan`` in a ``PoseSpace``.

    Raises
    ------
    RequestError
        When an argument is malformed; the message names the value and the rule.

    """
    began = working_time()
    state = system.check_state('start', start)
    pose, tolerance = _check_goal(goal, state), heading_tolerance
    if np.size(goal) == 2:
        tolerance = math.pi
    shortens = simplify is None or bool(simplify)
    request = check_request(
        space, state[:2], pose[:2], goal_radius=goal_radius, simplify=shortens, seed=seed
    )
    known = outcome_without_search(request)
    if known is not None and known[0] is not PlannerStatus.SOLVED:
        return _failure(*known, request.seed, began)
    poses = _poses_of(space, system)
    options = {
        **settings,
        'algorithm': 'auto',
        'goal_radius': goal_radius,
        'simplify': shortens,
        'seed': request.seed,
        'heading_tolerance': tolerance,
    }

    def path_from(begin: Floats) -> PlanResult:
        spent = working_time() - began
        left = effort._replace(time_limit=max(effort.time_limit - spent, 0.0))
        return plan_poses(poses, begin, pose, left, **options)

    result = path_from(state[:3])
    trajectory = _along(system, state, result)
    if trajectory is None and state[SPEED] != 0.0:
        # Too fast for this path, or in the opposite direction: the car is braked first.
        braked = _braked(poses, system, state)
        if braked is None:
            return _failure(*_why_not_braked(space, system, state), request.seed, began)
        result = path_from(braked.states[-1][:3])
        onwards = _along(system, braked.states[-1], result)
        trajectory = join_trajectories([braked, onwards]) if onwards else None
    return _driven(result, trajectory, began)


def _along(system: Car, state: Floats, result: PlanResult) -> Trajectory | None:
    """Return the drive along a path from a state; None without a path, or where it is too fast."""
    if result.twists is None or len(result.twists) == 0:
        return None
    return drive_along(system, state, result.twists)


def _check_goal(goal: ArrayLike, state: Floats) -> Floats:
    """Return the goal as a pose (3,); the heading at a position is that of the way there."""
    size = np.size(goal)
    if size not in (2, 3):
        raise RequestError(
            f'goal must be a position (x, y) or a pose (x, y, heading) for a Car, got {goal!r}'
        )
    point = check_point('goal', goal, size)
    if size == 3:
        return point
    dx, dy = point - state[:2]
    return np.append(point, math.atan2(dy, dx) if dx or dy else state[2])


def _poses_of(space: GridSpace, system: Car) -> PoseSpace:
    """Return the poses of a car that is a point, on the free cells of a grid."""
    known = _PRECISE.setdefault(space, {})
    poses = known.get(system.max_curvature)
    if poses is None:
        half = POINT * space.resolution
        poses = PoseSpace(
            GridSpace.from_blocked(space.blocked, space.resolution, space.origin),
            [(half, 0.0), (0.0, half), (-half, 0.0), (0.0, -half)],
            drive='car',
            min_turning_radius=1.0 / system.max_curvature,
        )
        known[system.max_curvature] = poses
    return poses


def _braked(poses: PoseSpace, system: Car, state: Floats) -> Trajectory | None:
    """Return a trajectory that brakes a car to rest on an arc; None where no arc is free."""
    speed = state[SPEED]
    way = speed * abs(speed) / (2.0 * system.max_acceleration)
    for share in BRAKING_ARCS:
        curvature = share * system.max_curvature
        twist = np.array([way, 0.0, curvature * way])
        if poses.is_motion_valid(state[:3], twist):
            end = poses.poses_along(state[:3], twist, [1.0])[0]
            end[2] = state[2] + twist[2]
            return Trajectory(
                system,
                np.array([0.0, abs(speed) / system.max_acceleration]),
                np.array([state, [*end, 0.0]]),
                np.array([[-math.copysign(system.max_acceleration, speed), curvature]]),
            )
    return None


def _why_not_braked(space: GridSpace, system: Car, state: Floats) -> tuple[PlannerStatus, str]:
    """Return the status of a request whose car cannot be braked, and the reason."""
    moving = f'start moves at {abs(state[SPEED]):g} m/s'
    if is_collision_inevitable(
        space.data,
        space.kernel_bounds,
        space.to_kernel(state[:2]),
        vectors_to_kernel(space, system.velocity(state)),
        system.largest_acceleration / space.scale,
    ):
        return (
            PlannerStatus.INEVITABLE_COLLISION,
            f'{moving} and can neither stop before the boundary nor turn away from it',
        )
    tried = f'on none of {len(BRAKING_ARCS)} arcs can it be braked to rest'
    return PlannerStatus.ITERATION_LIMIT, f'{moving}, and {tried}'


def _driven(result: PlanResult, trajectory: Trajectory | None, began: float) -> TrajectoryResult:
    """Return the result of a path of poses and the trajectory along it, None for none."""
    message, first = result.message, None
    if trajectory is not None:
        message = (
            f'trajectory of {trajectory.duration:.6g} s with {len(trajectory.controls)} steps '
            f'after {result.iterations} transitions'
        )
        assert result.first_solution is not None
        found = result.first_solution
        first = FirstSolution(found.elapsed, found.length, found.path[:, :2].copy())
    return TrajectoryResult(
        status=result.status,
        message=message,
        planner=result.planner,
        path=np.empty((0, 2)) if trajectory is None else trajectory.positions,
        length=math.inf if trajectory is None else trajectory.length,
        samples=result.samples[:, :2].copy(),
        parents=result.parents,
        iterations=result.iterations,
        counts=result.counts,
        elapsed=working_time() - began,
        seed=result.seed,
        cut_by_time=result.cut_by_time,
        first_solution=first,
        trajectory=trajectory,
    )


def _failure(status: PlannerStatus, message: str, seed: int, began: float) -> TrajectoryResult:
    """Return the result of a request that needs no search."""
    return TrajectoryResult.without_search(
        status,
        message,
        planner='hit_and_run_connect',
        dim=2,
        seed=seed,
        elapsed=working_time() - began,
    )
