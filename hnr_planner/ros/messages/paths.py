"""``nav_msgs/GetPlan`` and ``nav_msgs/Path``: to requests, and from poses."""

from geometry_msgs.msg import PoseStamped
from hnr_planner.ros.messages.cdr import with_elements
from hnr_planner.server.received_maps import as_written
from hnr_planner.server.requests import PlanRequest, Pose
from nav_msgs.msg import Path
from nav_msgs.srv import GetPlan
import numpy as np
from numpy.typing import NDArray
from rclpy.serialization import serialize_message
from std_msgs.msg import Header


def request_from_message(message: GetPlan.Request, algorithm: str) -> PlanRequest:
    """Return the request in ``message`` as it is; it is checked before it is planned."""
    return PlanRequest(
        start=pose_from_message(message.start),
        goal=pose_from_message(message.goal),
        tolerance=as_written(message.tolerance),
        algorithm=algorithm,
    )


def pose_from_message(message: PoseStamped) -> Pose:
    """Return the pose in ``message`` as it is."""
    position, rotation = message.pose.position, message.pose.orientation
    stamp = message.header.stamp
    return Pose(
        position=(position.x, position.y, position.z),
        orientation=(rotation.x, rotation.y, rotation.z, rotation.w),
        frame=message.header.frame_id,
        # By hand: rclpy's Time refuses a negative one with an exception.
        stamp=stamp.sec * 10**9 + stamp.nanosec,
    )


def points_from_path(message: Path) -> NDArray[np.float64]:
    """Return the positions (n, 2) [m] of the poses in ``message``."""
    positions = [stamped.pose.position for stamped in message.poses]
    return np.array([(position.x, position.y) for position in positions]).reshape(-1, 2)


def path_message(rows: NDArray[np.float64], header: Header) -> Path:
    """Return poses (n, 7) as a message; all share the header, and so get a stamp together."""
    path = Path(header=header)
    path.poses = [_stamped(row, header) for row in rows.tolist()]
    return path


def serialised_path(rows: NDArray[np.float64], header: Header) -> bytes:
    """Return poses (n, 7) as a message in its serialised form."""
    short = [serialize_message(path_message(rows[:n_poses], header)) for n_poses in range(3)]
    # A pose ends with its seven numbers.
    return with_elements(short, [(56, rows)])


def _stamped(row: list[float], header: Header) -> PoseStamped:
    """Return the message of one pose; setting its fields is faster than to hand them over."""
    stamped = PoseStamped(header=header)
    position, orientation = stamped.pose.position, stamped.pose.orientation
    position.x, position.y, position.z = row[:3]
    orientation.x, orientation.y, orientation.z, orientation.w = row[3:]
    return stamped
