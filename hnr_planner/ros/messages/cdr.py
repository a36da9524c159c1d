"""
Serialised messages (CDR, the byte format of ROS) with long sequences made from arrays.

A message object with a thousand poses needs a thousand Python objects; its serialised form is a
few constant bytes and an array. Here a message with at most two elements is serialised by rclpy,
and the bytes of the array are spliced in. ``test/ros/test_messages.py`` compares the result to
the message that rclpy serialises in full.
"""

from collections.abc import Sequence
import math
from typing import Any

from geometry_msgs.msg import Point
import numpy as np
from numpy.typing import NDArray

#: The placeholder in a message for a sequence of points: its only element, all NaN.
ONE_POINT = Point(x=math.nan, y=math.nan, z=math.nan)

#: The bytes of the placeholder, which occur nowhere else in a serialised message: other numbers
#: are finite, and strings hold no zeros.
_ONE_POINT_BYTES = np.full(3, math.nan).tobytes()


def with_points(serialised: bytes, arrays: Sequence[NDArray[np.float64]]) -> bytes:
    """
    Return a serialised message in which arrays of points have replaced the placeholders.

    Parameters
    ----------
    serialised : bytes
        A message in which some sequences of ``geometry_msgs/Point`` are ``[ONE_POINT]``. The
        length of such a sequence, four bytes, has to begin four bytes before a multiple of eight
        (as in ``Marker``): so no padding lies between the length and the first point. A point has
        three times eight bytes, so all that follows stays aligned.
    arrays : sequence of (n, 2)
        Points x, y for each placeholder, in the order of the placeholders; z becomes 0.

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


def with_elements(
    short: Sequence[bytes], fields: Sequence[tuple[int, NDArray[Any]]], n_after: int = 0
) -> bytes:
    """
    Return a serialised message with a sequence of n elements, given shorter forms.

    Parameters
    ----------
    short : three of bytes
        The serialised message with 0, 1 and 2 elements in the sequence. Each element from the
        second one on has the same size, a multiple of eight bytes.
    fields : sequence of (int, (n, k))
        The parts of an element that differ between the n elements: the number of bytes from the
        beginning of the part to the end of the element, and k numbers for each element, in the
        number type of the message. All else is as in the first two elements.
    n_after : int
        Number of bytes after the sequence, the same in each form: no number there has more than
        four bytes.

    """
    count = len(fields[0][1])
    if count == 0:
        return short[0]
    none, one, two = (form[: len(form) - n_after] for form in short)
    n_none, n_one, n_two = len(none), len(one), len(two)
    # Without elements, the sequence is its length, in four bytes.
    pieces = [none[:-4], np.uint32(count).tobytes()]
    for element, which in ((one[n_none:], slice(1)), (two[n_one:], slice(1, count))):
        rows = np.empty((len(range(count)[which]), len(element)), dtype=np.uint8)
        rows[:] = np.frombuffer(element, dtype=np.uint8)
        for before_end, numbers in fields if len(rows) > 0 else ():
            data = np.ascontiguousarray(numbers[which]).view(np.uint8)
            begin = len(element) - before_end
            end = begin + data.shape[1]
            rows[:, begin:end] = data
        pieces.append(rows.tobytes())
    return b''.join([*pieces, short[2][n_two:]])
