"""
Translation of Nav2's action goals into requests, and of outcomes into Nav2's error codes.

This module does not import Nav2. The names of error codes are those of the ROS 2 release Jazzy.
"""

from collections.abc import Sequence

from hnr_planner.server.parameters.settings import Settings
from hnr_planner.server.requests.outcomes import Outcome
from hnr_planner.server.requests.plan_request import NOWHERE, PlanRequest, Pose
from hnr_planner.server.responses.plan_response import PlanResponse

#: The name of Nav2's error code for each outcome; an outcome that is not listed is UNKNOWN, and
#: the error message names it.
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
    Return the request for a path that the goal of one of Nav2's actions stands for.

    Its tolerance is the parameter ``default_tolerance``.

    Parameters
    ----------
    start : Pose, optional
        Where the path begins; None for the pose of the robot.
    poses : sequence of Pose
        Poses to pass, in their order; the path ends at the last one. Without any, the goal of the
        request is ``NOWHERE``.
    planner_id : str
        Name of an algorithm, or an alias of one from the parameter ``planner_aliases``; empty
        for the parameter ``algorithm``.
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
    """Return the pose of the robot in ``robot_base_frame``: the origin of that frame."""
    return Pose((0.0, 0.0, 0.0), frame=settings.robot_base_frame)


def error_name(response: PlanResponse) -> str:
    """
    Return the name of Nav2's error code for the outcome of ``response``.

    A request without poses and one with an unknown planner have codes of their own, and a blocked
    start or goal outside the map is OUTSIDE_MAP in the place of OCCUPIED.
    """
    if response.solved:
        return 'NONE'
    request = response.request
    if request.goal is NOWHERE:
        return 'NO_VIAPOINTS_GIVEN'
    if not request.names_a_planner:
        return 'INVALID_PLANNER'
    name = ERRORS.get(response.outcome, 'UNKNOWN')
    # After a failed leg the request is that leg: a pose on the way is its start or its goal.
    ends = {'START_OCCUPIED': request.start, 'GOAL_OCCUPIED': request.goal}
    if name in ends and _is_outside(ends[name], response):
        return name.replace('OCCUPIED', 'OUTSIDE_MAP')
    return name


def _is_outside(pose: Pose, response: PlanResponse) -> bool:
    """Return whether ``pose`` is outside the map of ``response``; False if there is no map."""
    return response.snapshot is not None and not response.snapshot.space.reaches_to(pose.point)
