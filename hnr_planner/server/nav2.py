"""
Goals of Nav2's planner server as requests, and outcomes as its error codes; Nav2 is not needed.

The names of error codes are those that ``nav2_msgs`` has in Jazzy.
"""

from collections.abc import Sequence

from hnr_planner.server.outcomes import Outcome
from hnr_planner.server.requests import NOWHERE, PlanRequest, Pose
from hnr_planner.server.responses import PlanResponse
from hnr_planner.server.settings import Settings

#: Names of Nav2's error codes; any other outcome is UNKNOWN, and the words name the outcome.
ERRORS = {
    Outcome.SOLVED: 'NONE',
    Outcome.BAD_FRAME: 'TF_ERROR',
    Outcome.INVALID_START: 'START_OCCUPIED',
    Outcome.INVALID_GOAL: 'GOAL_OCCUPIED',
    Outcome.TIMEOUT: 'TIMEOUT',
    Outcome.UNREACHABLE: 'NO_VALID_PATH',
    Outcome.ITERATION_LIMIT: 'NO_VALID_PATH',
    Outcome.MAP_CHANGED: 'NO_VALID_PATH',
}


def goal_request(
    start: Pose | None, poses: Sequence[Pose], planner_id: str, settings: Settings
) -> PlanRequest:
    """
    Return the request that the goal of an action stands for.

    Parameters
    ----------
    start : Pose, optional
        None for where the robot is.
    poses : sequence of Pose
        Poses on the way, and the last one to end at.
    planner_id : str
        The algorithm, or a name that ``planner_aliases`` gives it; empty for the parameter
        ``algorithm``.
    settings : Settings
        The parameters in force.

    """
    *via, last = poses or (NOWHERE,)
    return PlanRequest(
        start=robot_pose(settings) if start is None else start,
        goal=last,
        tolerance=settings.default_tolerance,
        algorithm=settings.aliases.get(planner_id, planner_id) or settings.algorithm,
        via=tuple(via),
    )


def robot_pose(settings: Settings) -> Pose:
    """Return the pose of the robot, in its own frame."""
    return Pose((0.0, 0.0, 0.0), frame=settings.robot_base_frame)


def error_name(response: PlanResponse) -> str:
    """Return the name of Nav2's error code for how a request ended."""
    if response.solved:
        return 'NONE'
    request = response.request
    if request.goal is NOWHERE:
        return 'NO_VIAPOINTS_GIVEN'
    if not request.names_a_planner:
        return 'INVALID_PLANNER'
    name = ERRORS.get(response.outcome, 'UNKNOWN')
    # A pose on the way has the code of the end that it is of its leg.
    ends = {'START_OCCUPIED': request.start, 'GOAL_OCCUPIED': request.goal}
    if name in ends and _is_outside(ends[name], response):
        return name.replace('OCCUPIED', 'OUTSIDE_MAP')
    return name


def _is_outside(pose: Pose, response: PlanResponse) -> bool:
    """Return whether a pose in the map's frame lies outside the map."""
    return response.snapshot is not None and not response.snapshot.space.reaches_to(pose.point)
