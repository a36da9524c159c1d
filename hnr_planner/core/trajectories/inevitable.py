"""
Proof that a collision is inevitable, from the stopping distance.

For a robot at ``x`` with velocity ``v``, whatever the control, the position at time ``t`` lies in
the disc of radius ``a t^2 / 2`` around ``x + v t``, where ``a`` is the largest acceleration. On a
grid the set of free cells that the robot may be in is computed from one slice of time to the next:
the cells that touch the disc of the slice and are connected, through such cells, to the set of the
slice before. Once the set is empty, a collision has happened. In every space the bounds count as
walls: no robot stops before a wall that is nearer than the stopping distance ``v^2 / (2 a)``.
"""

import math
from typing import Any

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.grid.traversal import GridData
import numpy as np

#: Number of slices of the time until the disc contains the position at the start.
SLICES = 96


def is_collision_inevitable(
    space: Any, bounds: tuple[Floats, Floats], x: Floats, v: Floats, acceleration: float
) -> bool:
    """
    Return whether a collision is proved to be inevitable; False proves nothing.

    Parameters
    ----------
    space : NamedTuple
        The compiled space.
    bounds : (dim,), (dim,)
        Lower and upper corner of a box that contains the space.
    x, v : (dim,)
        Position and velocity at the start.
    acceleration : float
        Largest acceleration in any direction. All in the kernel frame.

    """
    lower, upper = bounds
    stop = x + v * np.abs(v) / (2.0 * acceleration)
    if (stop <= lower).any() or (stop >= upper).any():
        return True
    return isinstance(space, GridData) and _is_trapped(space.free_distance, x, v, acceleration)


@kernel
def _is_trapped(free_distance, x, v, acceleration):
    """
    Return whether the set of cells of a grid that the robot may be in becomes empty.

    The grid is given by ``free_distance`` (rows, columns), above 0 in free cells. Position,
    velocity and acceleration are in the kernel frame, whose unit is a cell.
    """
    rows, columns = free_distance.shape
    speed = math.hypot(v[0], v[1])
    duration = 2.0 * speed / acceleration / SLICES
    reached = np.zeros((rows, columns), dtype=np.bool_)
    stack = np.empty((rows * columns, 2), dtype=np.int64)
    cells = np.empty((rows * columns, 2), dtype=np.int64)
    cells[0, 0], cells[0, 1] = math.floor(x[1]), math.floor(x[0])
    n = 1
    for k in range(SLICES):
        middle, end = (k + 0.5) * duration, (k + 1) * duration
        radius = acceleration * end * end / 2.0 + speed * duration / 2.0
        n = _spread(
            free_distance,
            x[0] + middle * v[0],
            x[1] + middle * v[1],
            radius,
            cells,
            n,
            reached,
            stack,
        )
        if n == 0:
            return True
    return False


@kernel
def _spread(free_distance, x, y, radius, cells, n, reached, stack):
    """
    Replace the first ``n`` of ``cells`` by the free cells that the robot may be in next.

    Those touch the disc around (``x``, ``y``) and are connected, through cells that touch it, to
    one of the ``n`` cells that touches it too. Returns their number. ``reached`` is all false
    before and after; ``stack`` is work space.
    """
    waiting, found = 0, 0
    for k in range(n):
        if _touches(cells[k, 0], cells[k, 1], x, y, radius):
            stack[waiting, 0], stack[waiting, 1] = cells[k, 0], cells[k, 1]
            reached[cells[k, 0], cells[k, 1]] = True
            waiting += 1
    while waiting > 0:
        waiting -= 1
        row, column = stack[waiting, 0], stack[waiting, 1]
        cells[found, 0], cells[found, 1] = row, column
        found += 1
        for i, j in ((row, column - 1), (row, column + 1), (row - 1, column), (row + 1, column)):
            if free_distance[i, j] > 0 and not reached[i, j] and _touches(i, j, x, y, radius):
                reached[i, j] = True
                stack[waiting, 0], stack[waiting, 1] = i, j
                waiting += 1
    for k in range(found):
        reached[cells[k, 0], cells[k, 1]] = False
    return found


@kernel
def _touches(row, column, x, y, radius):
    """Return whether a disc around (``x``, ``y``) touches a cell of the grid; units are cells."""
    dx = max(column - x, max(x - column - 1.0, 0.0))
    dy = max(row - y, max(y - row - 1.0, 0.0))
    return dx * dx + dy * dy <= radius * radius
