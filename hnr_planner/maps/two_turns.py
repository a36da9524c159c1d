"""
Corridors with two turns, for robots with inertia: a serpentine and a Z.

The paper's kinematic experiment drives through a corridor with two turns and does not give its
geometry. These two are as different as such corridors can be: in the serpentine the robot
turns back twice, in the Z it never drives away from the goal.
"""

from __future__ import annotations

from hnr_planner.maps.corridor import Corridor
import numpy as np
from numpy.typing import NDArray

#: Length of an arm of the serpentine, side of the Z's square, thickness of walls [m].
ARM, SQUARE, WALL = 10.0, 10.0, 0.1
#: Side of a cell [m].
RESOLUTION = 0.05


def serpentine(width: float) -> Corridor:
    """
    Build a serpentine: three horizontal arms of a width [m], one above the other.

    The lower and the middle arm are joined at the right, the middle and the upper at the left; the
    request leads from the lower left to the upper right. ValueError is raised for a width below
    ``RESOLUTION`` or above half of ``ARM``.
    """
    _check_width(width, most=ARM / 2)
    pitch = width + WALL
    free = _solid(ARM, 3 * pitch - WALL)
    for k in range(3):
        _open(free, 0.0, k * pitch, ARM, width)
    _open(free, ARM - width, width, width, WALL)
    _open(free, 0.0, pitch + width, width, WALL)
    return _corridor(free, width, goal=(ARM - width / 2, 2 * pitch + width / 2))


def zigzag(width: float) -> Corridor:
    """
    Build a Z in a square: from the lower left to the middle, up, and on to the upper right.

    ``width`` [m] is that of all three arms. ValueError is raised for a width below ``RESOLUTION``
    or above a third of ``SQUARE``.
    """
    _check_width(width, most=SQUARE / 3)
    free = _solid(SQUARE, SQUARE)
    near, far = (SQUARE - width) / 2, (SQUARE + width) / 2
    _open(free, 0.0, 0.0, far, width)
    _open(free, near, 0.0, width, SQUARE)
    _open(free, near, SQUARE - width, far, width)
    return _corridor(free, width, goal=(SQUARE - width / 2, SQUARE - width / 2))


def _check_width(width: float, most: float) -> None:
    if not RESOLUTION <= width <= most:
        raise ValueError(f'width must be from {RESOLUTION} to {most:.2f}, not {width}')


def _solid(width: float, height: float) -> NDArray[np.bool_]:
    return np.zeros((round(height / RESOLUTION), round(width / RESOLUTION)), dtype=bool)


def _open(free: NDArray[np.bool_], x: float, y: float, width: float, height: float) -> None:
    """
    Make a rectangle of the grid free, in place.

    (x, y) is its lower left corner; all lengths are in metres, and its sides are rounded to cells.
    """
    left, low = round(x / RESOLUTION), round(y / RESOLUTION)
    right, high = round((x + width) / RESOLUTION), round((y + height) / RESOLUTION)
    free[low:high, left:right] = True


def _corridor(free: NDArray[np.bool_], width: float, goal: tuple[float, float]) -> Corridor:
    return Corridor(~free, RESOLUTION, (width / 2, width / 2), goal, width / 2)
