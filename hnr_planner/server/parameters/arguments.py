"""Arguments of the library's functions that the parameters decide, by their names."""

import math
from typing import Any

from hnr_planner.core import BallWalk, KINODYNAMIC_PLANNERS
from hnr_planner.core.systems import DoubleIntegrator
from hnr_planner.server.parameters.robot import RobotSettings
from hnr_planner.server.parameters.settings import Settings


def space_arguments(settings: Settings) -> dict[str, Any]:
    """Return the arguments of ``GridSpace.from_occupancy`` besides the map itself."""
    return {
        'robot_radius': settings.robot_radius,
        'unknown': settings.unknown,
        'occupied_threshold': settings.occupied_threshold,
    }


def pose_space_arguments(settings: RobotSettings) -> dict[str, Any] | None:
    """Return the arguments of ``PoseSpace`` besides the grid; None without a footprint."""
    if not settings.vertices:
        return None
    return {
        'footprint': settings.vertices,
        'drive': settings.drive,
        'min_turning_radius': settings.min_turning_radius,
        'reverse': settings.reverse,
    }


def plan_arguments(settings: Settings) -> dict[str, Any]:
    """Return the arguments of ``plan`` for a robot that is a circle."""
    return {
        **_search_arguments(settings),
        'clearance': settings.clearance,
        'alternatives': settings.alternatives,
        'start_escape': settings.escape_radius,
    }


def pose_plan_arguments(settings: Settings) -> dict[str, Any]:
    """Return the arguments of ``plan`` in a ``PoseSpace``."""
    return {
        **_search_arguments(settings),
        'heading_tolerance': settings.heading_tolerance,
        'reverse_penalty': settings.reverse_penalty,
    }


def system_of(settings: Settings) -> DoubleIntegrator:
    """Return the robot with inertia: a point mass in the plane with limits."""
    return DoubleIntegrator(
        dim=2, max_acceleration=settings.max_acceleration, max_speed=settings.max_speed
    )


def trajectory_arguments(
    settings: Settings, algorithm: str, *, goal_is_moved: bool
) -> dict[str, Any]:
    """
    Return the arguments of ``plan_trajectory`` besides the system.

    Parameters
    ----------
    settings : Settings
        The parameters in force.
    algorithm : str
        Name of a kinodynamic planner.
    goal_is_moved : bool
        Whether the search is for a point near a goal that could not be reached: then the goal
        radius is 0 for a planner that reaches its goal exactly (``samples_goal`` is False).

    """
    # A planner that draws states never draws the goal itself, nor one at rest.
    samples_goal = KINODYNAMIC_PLANNERS[algorithm].samples_goal
    unbounded = settings.goal_speed < 0.0 or (settings.goal_speed == 0.0 and samples_goal)
    arguments = {
        **_search_arguments(settings),
        'goal_speed': math.inf if unbounded else settings.goal_speed,
        # A trajectory that is not to be shortened cannot be optimized either.
        'optimize_for': settings.optimize_for if settings.simplify else 0.0,
    }
    if samples_goal:
        return {**arguments, 'boundary': settings.boundary}
    # A goal that was moved already would be moved once more by a region around it.
    return {**arguments, 'goal_radius': 0.0} if goal_is_moved else arguments


def sample_arguments(settings: Settings) -> dict[str, Any]:
    """Return the arguments of ``sample_free_space`` besides the space."""
    ball = BallWalk(settings.sample_radius or None)
    return {
        'n_draws': settings.sample_count,
        'walk': ball if settings.sample_walk == ball.name else settings.sample_walk,
        'thin': settings.sample_thin,
        'seed': _seed(settings),
    }


def _search_arguments(settings: Settings) -> dict[str, Any]:
    """Return the arguments that ``plan`` and ``plan_trajectory`` share."""
    return {
        'goal_radius': settings.goal_radius,
        'max_iterations': settings.max_iterations or None,
        'seed': _seed(settings),
        'simplify': settings.simplify,
        'optimize_for': settings.optimize_for,
    }


def _seed(settings: Settings) -> int | None:
    """Return the seed of a request; None for a fresh one."""
    return None if settings.seed < 0 else settings.seed
