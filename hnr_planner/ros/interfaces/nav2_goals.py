"""
Goals of Nav2's planner server as requests, and outcomes as its error codes; Nav2 is not needed.

What is here has the names that `nav2_msgs` has in Jazzy, and takes them from its messages by name.
"""

from collections.abc import Sequence
from typing import Any

from geometry_msgs.msg import PoseStamped
from hnr_planner.core import ALGORITHMS
from hnr_planner.ros.messages.paths import pose_from_message
from hnr_planner.server.outcomes import Outcome
from hnr_planner.server.requests import NOWHERE, PlanRequest, Pose
from hnr_planner.server.responses import PlanResponse
from hnr_planner.server.settings import Settings
import numpy as np
from numpy.typing import NDArray

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
"""Names of Nav2's error codes; any other outcome is UNKNOWN, and the words say what it was."""


def request_of(goal: Any, poses: Sequence[PoseStamped], settings: Settings) -> PlanRequest:
    """
    Return what the goal of an action asks for.

    Parameters
    ----------
    goal : ComputePathToPose.Goal or ComputePathThroughPoses.Goal
        `planner_id` names the algorithm; when it is empty, the parameter does. Without
        `use_start` the path begins where the robot is.
    poses : sequence of PoseStamped
        Those on the way, and the last one to end at.
    settings : Settings
        The parameters in force.

    """
    *via, last = map(pose_from_message, poses) if poses else (NOWHERE,)
    return PlanRequest(
        start=pose_from_message(goal.start) if goal.use_start else robot_pose(settings),
        goal=last,
        tolerance=settings.default_tolerance,
        algorithm=goal.planner_id or settings.algorithm,
        via=tuple(via),
    )


def robot_pose(settings: Settings) -> Pose:
    """Return where the robot is, in its own frame."""
    return Pose((0.0, 0.0, 0.0), frame=settings.robot_base_frame)


def error_of(report: PlanResponse) -> str:
    """Return the name of Nav2's error code for how a request ended."""
    request = report.request
    if request.goal is NOWHERE:
        return 'NO_VIAPOINTS_GIVEN'
    if request.algorithm not in ALGORITHMS:
        return 'INVALID_PLANNER'
    name = ERRORS.get(report.outcome, 'UNKNOWN')
    # Ends on the way have the code of the end that they are of their leg.
    ends = {'START_OCCUPIED': request.start, 'GOAL_OCCUPIED': request.goal}
    if name in ends and _is_outside(ends[name], report):
        return name.replace('OCCUPIED', 'OUTSIDE_MAP')
    return name


def from_robot_on(points: NDArray[np.float64], robot: Pose) -> int:
    """Return the number of the pose next to the robot: those before it have been passed."""
    away = points - robot.point
    return int(np.argmin(np.nan_to_num(np.hypot(away[:, 0], away[:, 1]), nan=np.inf)))


def _is_outside(pose: Pose, report: PlanResponse) -> bool:
    """Return whether a pose in the map's frame lies outside the map."""
    return report.snapshot is not None and not report.snapshot.space.reaches_to(pose.point)
