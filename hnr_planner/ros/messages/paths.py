"""Conversion of ``nav_msgs/GetPlan`` to requests, and of ``nav_msgs/Path`` to and from poses."""

from functools import lru_cache
import struct

from geometry_msgs.msg import PoseStamped
from hnr_planner.ros.messages.cdr import with_elements
from hnr_planner.server.geometry.pose_motions import poses_of
from hnr_planner.server.map.received_maps import as_written
from hnr_planner.server.requests.plan_request import PlanRequest, Pose
from nav_msgs.msg import Path
from nav_msgs.srv import GetPlan
import numpy as np
from numpy.typing import NDArray
from rclpy.serialization import serialize_message
from std_msgs.msg import Header

#: Number of bytes at the end of a serialised pose that are its seven numbers.
POSE_BYTES = 56

#: The bytes of a stamp that stands for any other; they occur nowhere else in a path of zeros,
#: since no text has such bytes.
_ANY_STAMP = b'\xff' * 8


def request_from_message(message: GetPlan.Request, algorithm: str) -> PlanRequest:
    """Return the request in ``message``, to be planned with ``algorithm``, without checking it."""
    return PlanRequest(
        start=pose_from_message(message.start),
        goal=pose_from_message(message.goal),
        tolerance=as_written(message.tolerance),
        algorithm=algorithm,
    )


def pose_from_message(message: PoseStamped) -> Pose:
    """Return the pose in ``message`` with its frame and its stamp [ns], without checking it."""
    position, rotation = message.pose.position, message.pose.orientation
    stamp = message.header.stamp
    return Pose(
        position=(position.x, position.y, position.z),
        orientation=(rotation.x, rotation.y, rotation.z, rotation.w),
        frame=message.header.frame_id,
        # Computed here, since rclpy's Time raises an exception for a negative stamp.
        stamp=stamp.sec * 10**9 + stamp.nanosec,
    )


def poses_from_path(message: Path) -> NDArray[np.float64]:
    """Return the poses x, y, yaw (n, 3) [m, m, rad] in ``message``, in the frame they have."""
    rows = [
        (position.x, position.y, position.z, turn.x, turn.y, turn.z, turn.w)
        for position, turn in ((p.pose.position, p.pose.orientation) for p in message.poses)
    ]
    return poses_of(np.array(rows).reshape(-1, 7))


def path_message(rows: NDArray[np.float64], header: Header) -> Path:
    """
    Return poses (n, 7) as a path message.

    A row is x, y, z [m] and the quaternion x, y, z, w. The path and all its poses share the object
    ``header``: a stamp that is set in it later holds for all of them.
    """
    path = Path(header=header)
    path.poses = [_stamped(row, header) for row in rows.tolist()]
    return path


def serialised_path(rows: NDArray[np.float64], header: Header) -> bytes:
    """Return the serialised form of ``path_message(rows, header)``, without objects for poses."""
    stamp = struct.pack('=iI', header.stamp.sec, header.stamp.nanosec)
    short = [form.replace(_ANY_STAMP, stamp) for form in _forms(header.frame_id)]
    return with_elements(short, [(POSE_BYTES, rows)])


@lru_cache(maxsize=16)
def _forms(frame: str) -> list[bytes]:
    """Return serialised paths of 0, 1 and 2 poses in a frame, stamped ``_ANY_STAMP``."""
    header, rows = Header(frame_id=frame), np.zeros((2, 7))
    header.stamp.sec, header.stamp.nanosec = struct.unpack('=iI', _ANY_STAMP)
    return [serialize_message(path_message(rows[:n_poses], header)) for n_poses in range(3)]


def _stamped(row: list[float], header: Header) -> PoseStamped:
    """Return the message of one pose (7,); setting fields is faster than passing them."""
    stamped = PoseStamped(header=header)
    position, orientation = stamped.pose.position, stamped.pose.orientation
    position.x, position.y, position.z = row[:3]
    orientation.x, orientation.y, orientation.z, orientation.w = row[3:]
    return stamped
