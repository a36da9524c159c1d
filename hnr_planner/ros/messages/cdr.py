"""
Serialised messages (CDR) with long arrays in the place of one element each.

A message with a thousand poses costs a thousand Python objects; its serialised form is a few
constant bytes and an array. Here a message with one or two elements is serialised in the ordinary
way, and the bytes of the array are spliced in. ``test/ros/test_messages.py`` compares both forms.
"""

from collections.abc import Sequence
import math

from geometry_msgs.msg import Point
import numpy as np
from numpy.typing import NDArray

#: A placeholder for an array of points.
ONE_POINT = Point(x=math.nan, y=math.nan, z=math.nan)

#: Found nowhere else in a serialised message: numbers are finite, and strings hold no zeros.
_ONE_POINT_BYTES = np.full(3, math.nan).tobytes()


def with_points(serialised: bytes, arrays: Sequence[NDArray[np.float64]]) -> bytes:
    """
    Return a serialised message with arrays of points in the places of its placeholders.

    Parameters
    ----------
    serialised : bytes
        A message in which some sequences of ``geometry_msgs/Point`` are ``[ONE_POINT]``, and in
        which everything before such a sequence's length ends at a multiple of eight bytes, less
        four (as in ``Marker``): so nothing lies between the length and the first point. A point
        has three times eight bytes, so all that follows stays aligned.
    arrays : sequence of (n, 2)
        The points for each placeholder, in their order.

    """
    pieces, done = [], 0
    for points in arrays:
        place = serialised.index(_ONE_POINT_BYTES, done)
        length = place - 4
        rows = np.zeros((len(points), 3))
        rows[:, :2] = points
        pieces += [serialised[done:length], np.uint32(len(rows)).tobytes(), rows.tobytes()]
        done = place + len(_ONE_POINT_BYTES)
    return b''.join([*pieces, serialised[done:]])


def with_poses(short: Sequence[bytes], rows: NDArray[np.float64]) -> bytes:
    """
    Return a serialised message that ends with stamped poses, given three short forms of it.

    Parameters
    ----------
    short : three of bytes
        The message (such as ``nav_msgs/Path``) with the first 0, 1 and 2 of the poses; its last
        field is the sequence of ``PoseStamped``, all with the same header.
    rows : (n, 7)
        All poses: x, y, z and the quaternion x, y, z, w.

    """
    if len(rows) < len(short):
        return short[len(rows)]
    none, one, two = short
    # From the second pose on all take equally many bytes, the last 56 of them seven numbers.
    n_none, n_one = len(none), len(one)
    others = np.tile(np.frombuffer(two[n_one:], dtype=np.uint8), (len(rows) - 1, 1))
    numbers = np.ascontiguousarray(rows[1:]).view(np.uint8)
    place = others.shape[1] - numbers.shape[1]
    others[:, place:] = numbers
    # A message without poses ends with their number, in four bytes.
    length = np.uint32(len(rows)).tobytes()
    return b''.join([none[:-4], length, one[n_none:], others.tobytes()])
