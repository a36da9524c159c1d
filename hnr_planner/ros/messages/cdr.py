"""
Serialised messages (CDR) with long arrays in the place of one element each.

A message with a thousand poses costs a thousand Python objects; its serialised form is a few
constant bytes and an array. Here a message with one or two elements is serialised in the ordinary
way, and the bytes of the array are spliced in. ``test/ros/test_messages.py`` compares both forms.
"""

from collections.abc import Sequence
import math
from typing import Any

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


def with_elements(short: Sequence[bytes], fields: Sequence[tuple[int, NDArray[Any]]]) -> bytes:
    """
    Return a serialised message that ends with a long sequence, given three short forms of it.

    Parameters
    ----------
    short : three of bytes
        The message with the first 0, 1 and 2 elements of the sequence, which is its last field. An
        element has a fixed size, a multiple of eight bytes, from the second one on.
    fields : sequence of (int, (n, k))
        What differs from element to element: where it begins, in bytes before the element's end,
        and its numbers for each element, in the type of the message.

    """
    count = len(fields[0][1])
    if count < len(short):
        return short[count]
    none, one, two = short
    n_none, n_one = len(none), len(one)
    others = np.tile(np.frombuffer(two[n_one:], dtype=np.uint8), (count - 1, 1))
    for before_end, numbers in fields:
        data = np.ascontiguousarray(numbers[1:]).view(np.uint8)
        begin = others.shape[1] - before_end
        end = begin + data.shape[1]
        others[:, begin:end] = data
    # A message without elements ends with their number, in four bytes.
    length = np.uint32(count).tobytes()
    return b''.join([none[:-4], length, one[n_none:], others.tobytes()])
