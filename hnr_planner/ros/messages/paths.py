"""`nav_msgs/GetPlan` and `nav_msgs/Path` to and from requests and reports."""

from geometry_msgs.msg import PoseStamped
from hnr_planner.ros.messages.maps import as_written
from hnr_planner.ros.messages.orientations import yaw_of
from hnr_planner.server.poses import poses_along
from hnr_planner.server.requests import PlanRequest, Pose
from hnr_planner.server.responses import PlanResponse
from nav_msgs.msg import Path
from nav_msgs.srv import GetPlan
import numpy as np
from numpy.typing import NDArray
from rclpy.serialization import serialize_message
from std_msgs.msg import Header


def request_from_message(message: GetPlan.Request, algorithm: str) -> PlanRequest:
    """Return what `message` asks for, as it stands; it is checked when it is answered."""
    return PlanRequest(
        start=pose_from_message(message.start),
        goal=pose_from_message(message.goal),
        tolerance=as_written(message.tolerance),
        algorithm=algorithm,
    )


def pose_from_message(message: PoseStamped) -> Pose:
    """Return the pose in `message`, as it stands."""
    position, rotation = message.pose.position, message.pose.orientation
    stamp = message.header.stamp
    return Pose(
        position=(position.x, position.y, position.z),
        orientation=(rotation.x, rotation.y, rotation.z, rotation.w),
        frame=message.header.frame_id,
        # By hand: rclpy's Time refuses a negative one with an exception.
        stamp=stamp.sec * 10**9 + stamp.nanosec,
    )


def pose_rows(report: PlanResponse, spacing: float) -> NDArray[np.float64]:
    """
    Return the poses of a report's path as rows (n, 7): x, y, z and the quaternion x, y, z, w.

    They are spaced as asked for; there are none after a failure.
    """
    if not report.solved:
        return np.empty((0, 7))
    final_yaw = yaw_of(report.goal_orientation)
    points, yaws = poses_along(report.path, _spacing(report, spacing), final_yaw)
    rows = np.zeros((len(points), 7))
    rows[:, :2] = points
    rows[:, 5], rows[:, 6] = np.sin(yaws / 2.0), np.cos(yaws / 2.0)
    # The goal's own orientation, with the roll and pitch that a yaw cannot hold.
    rows[-1, 3:] = report.goal_orientation
    return rows


def path_message(rows: NDArray[np.float64], header: Header) -> Path:
    """Return poses as a message; all share the header, and so get a stamp together."""
    path = Path(header=header)
    path.poses = [_stamped(row, header) for row in rows.tolist()]
    return path


def serialised_path(rows: NDArray[np.float64], header: Header) -> bytes:
    """
    Return the same message in its serialised form, without an object for each pose.

    From the second pose on all take equally many bytes, the last 56 of them their seven numbers:
    so the second one is repeated, and the numbers are put in.
    """
    short = [serialize_message(path_message(rows[:n_poses], header)) for n_poses in range(3)]
    if len(rows) < len(short):
        return short[len(rows)]
    none, one, two = short
    n_none, n_one = len(none), len(one)
    others = np.tile(np.frombuffer(two[n_one:], dtype=np.uint8), (len(rows) - 1, 1))
    numbers = rows[1:].view(np.uint8)
    place = others.shape[1] - numbers.shape[1]
    others[:, place:] = numbers
    # A path without poses ends with their number, in four bytes.
    count = np.uint32(len(rows)).tobytes()
    return b''.join([none[:-4], count, one[n_none:], others.tobytes()])


def _spacing(report: PlanResponse, spacing: float) -> float:
    """Return the distance meant by the parameter: a negative one is the map's resolution."""
    if spacing < 0.0 and report.snapshot is not None:
        return report.snapshot.grid.resolution
    return spacing


def _stamped(row: list[float], header: Header) -> PoseStamped:
    """Return the message of one pose; setting its fields is faster than to hand them over."""
    stamped = PoseStamped(header=header)
    position, orientation = stamped.pose.position, stamped.pose.orientation
    position.x, position.y, position.z = row[:3]
    orientation.x, orientation.y, orientation.z, orientation.w = row[3:]
    return stamped
