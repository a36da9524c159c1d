"""Legs of a request for a robot with a footprint: from one pose to the next."""

from collections.abc import Callable
from dataclasses import replace
import math

from hnr_planner.core import plan, PlannerStatus, PlanResult, PoseSpace
from hnr_planner.core.checks import Floats
from hnr_planner.server.geometry.orientations import normalised, yaw_of
from hnr_planner.server.map.map_store import MapSnapshot
from hnr_planner.server.parameters.arguments import pose_plan_arguments
from hnr_planner.server.parameters.settings import DEFAULTS, Settings
from hnr_planner.server.requests.limits import RequestLimits
from hnr_planner.server.requests.outcomes import Outcome, Refusal
from hnr_planner.server.requests.plan_request import PlanRequest, Pose
import numpy as np

#: Parameters that have no meaning with a footprint yet, and have to keep their defaults.
WITHOUT_MEANING = (
    'clearance',
    'alternatives',
    'roadmap',
    'keep_route',
    'escape_radius',
    'any_order',
)
#: The value of cells of a Nav2 costmap that are inflated by the inscribed radius.
INSCRIBED = 99
#: Most steps from the goal to the tolerance, and candidates that are looked at together.
STEPS_MAX, AT_ONCE = 50, 256


def plan_pose_leg(
    request: PlanRequest,
    snapshot: MapSnapshot,
    space: PoseSpace,
    settings: Settings,
    limits: RequestLimits,
    add_times: Callable[[PlanResult], None],
) -> PlanResult:
    """
    Return the result of the search from the start of a request to its goal.

    Where the goal is not free or cannot be reached, and the tolerance is above 0, the search is
    repeated for the nearest pose with the same heading that may be reached; the message states it.

    Parameters
    ----------
    request : PlanRequest
        The request, in the map's frame; its ``via`` are not looked at.
    snapshot, space
        The map, and the poses of the robot on it.
    settings, limits
        The parameters in force, and the limits of the request.
    add_times : callable
        Called with the result of each search.

    Raises
    ------
    Refusal
        BAD_REQUEST, where an orientation is no rotation, or what is asked for has no meaning with
        a footprint.
    RequestError
        When the planner does not take an argument.

    """
    refuse_what_has_no_meaning(request, settings)
    start, goal = planar_pose('start', request.start), planar_pose('goal', request.goal)

    def search(goal: Floats, **changes: float) -> PlanResult:
        result = plan(
            space,
            start,
            goal,
            algorithm=request.algorithm,
            time_limit=limits.time_left,
            cancel=limits.cancel,
            **{**pose_plan_arguments(settings), **changes},
        )
        add_times(result)
        return result

    result = search(goal)
    missed = result.status in (PlannerStatus.INVALID_GOAL, PlannerStatus.UNREACHABLE)
    if missed and request.tolerance > 0.0:
        why, tolerance = result.message, request.tolerance
        with limits.enforced():
            nearest = nearest_free_pose(space, start, goal, tolerance)
        if nearest is None:
            why += f'; no pose with this heading within {tolerance:g} m of it can be reached'
            result = replace(result, message=why)
        else:
            offset = math.dist(nearest[:2], goal[:2])
            result = search(nearest, goal_radius=0.0, heading_tolerance=0.0)
            message = f'{result.message}; the goal was moved by {offset:.4g} m because {why}'
            result = replace(result, message=message, goal_offset=offset)
    return replace(result, message=result.message + _about_zones(result, snapshot, start, goal))


def refuse_what_has_no_meaning(request: PlanRequest, settings: Settings) -> None:
    """Raise Refusal (BAD_REQUEST) for what has no meaning for a robot with a footprint."""
    reasons = []
    if request.has_inertia:
        reasons.append(
            f'{request.algorithm} plans for a robot that is a circle: footprint must be [], '
            f'got {settings.footprint!r}'
        )
    if settings.occupied_threshold == INSCRIBED:
        reasons.append(
            f'occupied_threshold must not be {INSCRIBED} with a footprint: in a costmap, cells of '
            'this value are inflated by a radius; 100 takes the obstacles alone'
        )
    for name in WITHOUT_MEANING:
        value, default = getattr(settings, name), getattr(DEFAULTS, name)
        if value != default:
            reasons.append(
                f'{name} has no meaning with a footprint: it must be {default}, got {value}'
            )
    if reasons:
        raise Refusal(Outcome.BAD_REQUEST, '; '.join(reasons))


def planar_pose(name: str, pose: Pose) -> Floats:
    """
    Return a requested pose as (x, y, yaw) [m, m, rad], in the frame that it has.

    Raise Refusal (BAD_REQUEST), with the name of the pose, where its orientation is no rotation.
    """
    rotation = normalised(pose.orientation)
    if rotation is None:
        raise Refusal(
            Outcome.BAD_REQUEST,
            f'the orientation of the {name} must be a quaternion with a norm above 0, got '
            f'{list(pose.orientation)}',
        )
    return np.array([*pose.point, yaw_of(rotation)])


def nearest_free_pose(
    space: PoseSpace, start: Floats, goal: Floats, tolerance: float
) -> Floats | None:
    """
    Return the free pose (3,) nearest to a goal, with its heading, that may be reached.

    Candidates are the positions of a square lattice around the goal, half a cell apart, or further
    where that would give more than ``STEPS_MAX`` steps to the tolerance. Only those count to which
    the largest disc in the footprint can move. None where there is none.

    Parameters
    ----------
    space : PoseSpace
        The poses of the robot.
    start, goal : (3,)
        Poses in the map frame [m, m, rad].
    tolerance : float
        Largest distance from the goal [m].

    """
    step = max(space.grid.resolution / 2.0, tolerance / STEPS_MAX)
    n_steps = int(tolerance / step)
    columns, rows = np.meshgrid(*[step * np.arange(-n_steps, n_steps + 1)] * 2)
    offsets = np.column_stack([columns.ravel(), rows.ravel()])
    distances = np.hypot(*offsets.T)
    order = np.argsort(distances, kind='stable')
    offsets = offsets[order[: np.count_nonzero(distances <= tolerance)]]
    disc = space.disc
    place = disc.place(start)
    for first in range(0, len(offsets), AT_ONCE):
        last = first + AT_ONCE
        poses = np.column_stack([goal[:2] + offsets[first:last], offsets[first:last, 0]])
        poses[:, 2] = goal[2]
        for pose in poses[space.contains(poses)]:
            if disc.space.connected(place, disc.place(pose)):
                found: Floats = pose
                return found
    return None


def _about_zones(result: PlanResult, snapshot: MapSnapshot, start: Floats, goal: Floats) -> str:
    """Return what keepout zones have to do with a result, as the end of its message."""
    ends = {
        PlannerStatus.INVALID_START: ('start', start),
        PlannerStatus.INVALID_GOAL: ('goal', goal),
    }
    space, outside = snapshot.pose_space, snapshot.outside_zones
    if result.status not in ends or outside is None or space is None:
        return ''
    name, pose = ends[result.status]
    in_zone = PoseSpace(outside, space.footprint).contains(pose)
    return f'; the {name} is in a keepout zone' if in_zone else ''
