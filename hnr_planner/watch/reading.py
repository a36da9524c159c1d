"""Arrays of the messages that the planning node publishes, without an object for each pose."""

from __future__ import annotations

import struct
from typing import Any

from hnr_planner.watch.searches import Stamp
from nav_msgs.msg import Path
import numpy as np
from numpy.typing import NDArray
from rclpy.serialization import deserialize_message

#: What begins a serialised message: plain CDR with the lowest byte of a number first.
LITTLE_ENDIAN = b'\x00\x01'
#: Bytes of the stamp of a header and of the length of its text; of the seven numbers of a pose.
STAMP_BYTES, POSE_BYTES = 12, 56


def stamp_of(message: Any) -> Stamp:
    """Return the stamp of a message with a header."""
    stamp = message.header.stamp
    return stamp.sec, stamp.nanosec


def read_path(data: bytes) -> tuple[Stamp, NDArray[np.float32]]:
    """
    Return the stamp and the positions (n, 2) [m] of a serialised ``nav_msgs/Path``.

    Where all poses have a frame of the same length, as those of one planner have, they lie at
    equal distances; any other message is read by rclpy, with an object for each pose.
    """
    points = _at_equal_distances(data) if data[:2] == LITTLE_ENDIAN else None
    if points is not None:
        sec, nanosec = struct.unpack_from('<iI', data, 4)
        return (sec, nanosec), points
    path = deserialize_message(data, Path)
    positions = [(p.pose.position.x, p.pose.position.y) for p in path.poses]
    return stamp_of(path), np.array(positions, dtype=np.float32).reshape(-1, 2)


def _at_equal_distances(data: bytes) -> NDArray[np.float32] | None:
    """Return positions (n, 2) [m], or None where poses cannot lie at equal distances."""
    body = memoryview(data)[4:]  # alignment counts from here
    (n_text,) = struct.unpack_from('<I', body, 8)
    at = _aligned(STAMP_BYTES + n_text, 4)
    (n_poses,) = struct.unpack_from('<I', body, at)
    if n_poses == 0:
        return np.empty((0, 2), dtype=np.float32)
    first = at + 4
    (n_text,) = struct.unpack_from('<I', body, first + 8)
    numbers = _aligned(first + STAMP_BYTES + n_text, 8)
    step = _aligned(STAMP_BYTES + n_text, 8) + POSE_BYTES
    end = numbers + POSE_BYTES + (n_poses - 1) * step
    if end != len(body):
        return None
    rows = np.ndarray((n_poses, 2), '<f8', body, numbers, (step, 8))
    return rows.astype(np.float32)


def _aligned(place: int, size: int) -> int:
    return place + -place % size


def read_cloud(message: Any) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """Return positions (n, 2) [m] and parents (n,) of a ``sensor_msgs/PointCloud2``."""
    offsets = {field.name: field.offset for field in message.fields}
    names = ('x', 'y', 'parent')
    layout = np.dtype(
        {
            'names': names,
            'formats': ('<f4', '<f4', '<i4'),
            'offsets': [offsets[name] for name in names],
            'itemsize': message.point_step,
        }
    )
    points = np.frombuffer(message.data, dtype=layout)
    return np.stack((points['x'], points['y']), axis=1), points['parent'].copy()
