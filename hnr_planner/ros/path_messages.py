"""`nav_msgs/GetPlan` and `nav_msgs/Path` to and from requests and reports."""

from geometry_msgs.msg import Point, PoseStamped, Quaternion
from geometry_msgs.msg import Pose as PoseMessage
from hnr_planner.ros.map_messages import as_written
from hnr_planner.ros.orientations import Quaternion as Parts
from hnr_planner.ros.orientations import quaternion_of, yaw_of
from hnr_planner.ros.poses import Poses, poses_along
from hnr_planner.ros.requests import Pose, Report, Request
from nav_msgs.msg import Path
from nav_msgs.srv import GetPlan
from rclpy.time import Time
from std_msgs.msg import Header


def request_from_message(message: GetPlan.Request, algorithm: str) -> Request:
    """Return what `message` asks for, as it stands; it is checked when it is answered."""
    return Request(
        start=pose_from_message(message.start),
        goal=pose_from_message(message.goal),
        tolerance=as_written(message.tolerance),
        algorithm=algorithm,
    )


def pose_from_message(message: PoseStamped) -> Pose:
    """Return the pose in `message`, as it stands."""
    position, rotation = message.pose.position, message.pose.orientation
    return Pose(
        position=(position.x, position.y, position.z),
        orientation=(rotation.x, rotation.y, rotation.z, rotation.w),
        frame=message.header.frame_id,
        stamp=Time.from_msg(message.header.stamp).nanoseconds,
    )


def path_message(report: Report, spacing: float) -> Path:
    """
    Return the path of a report: spaced poses, or none after a failure.

    Its header has no stamp yet; the poses share the header, and so get their stamp with it.
    """
    header = Header(frame_id=report.frame)
    message = Path(header=header)
    if report.solved:
        final_yaw = yaw_of(report.goal_orientation)
        poses = poses_along(report.path, _spacing(report, spacing), final_yaw)
        message.poses = _stamped(poses, header)
        # The goal's own orientation, with the roll and pitch that a yaw cannot hold.
        message.poses[-1].pose.orientation = _orientation(report.goal_orientation)
    return message


def _spacing(report: Report, spacing: float) -> float:
    """Return the distance meant by the parameter: a negative one is the map's resolution."""
    if spacing < 0.0 and report.snapshot is not None:
        return report.snapshot.grid.resolution
    return spacing


def _stamped(poses: Poses, header: Header) -> list[PoseStamped]:
    """Return one message for each pose; all share the header."""
    return [
        PoseStamped(
            header=header,
            pose=PoseMessage(
                position=Point(x=x, y=y, z=0.0),
                orientation=_orientation(quaternion_of(yaw)),
            ),
        )
        for (x, y), yaw in zip(poses.points.tolist(), poses.yaws.tolist(), strict=True)
    ]


def _orientation(parts: Parts) -> Quaternion:
    x, y, z, w = parts
    return Quaternion(x=x, y=y, z=z, w=w)
