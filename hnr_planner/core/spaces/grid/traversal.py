"""
The chord on a grid: exact cell traversal, with a distance field to skip empty space.

Kernel frame: one unit is one cell, cell [row, column] is the square of points (x, y) in [column,
column + 1] x [row, row + 1]. ``free_distance[row, column]`` is the Chebyshev distance [cells] to
the nearest blocked cell: it is 0 for blocked cells, and around a cell with distance ``d`` all
cells up to ``d - 1`` away are free. The rim of the array is blocked, so a ray always ends.

The line ``x + s u`` meets the grid line ``X`` at ``s = (X - x) / u``, whichever cells were visited
before. A skip over free cells ends at a point that traversal cell by cell passes too, so traversal
with skips and without them stops at the same number to the last bit. Blocked cells are closed: a
ray through a corner needs all four cells to be free, and one along a grid line the cells on both
sides.
"""

import math
from typing import NamedTuple

from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.spaces.primitives import (
    component,
    contains,
    first_entry,
    first_exit,
    segment_is_free,
    touches,
)
import numpy as np
from numpy.typing import NDArray

#: Least distance to a blocked cell [cells] for which a skip is faster (measured on building maps).
LEAST_REACH = 2
#: Distance from the last free cell's side at which a skip ends, more than rounding [cells].
SKIN = 1e-6


class GridData(NamedTuple):
    """
    A compiled grid.

    Attributes
    ----------
    free_distance : (rows, columns) uint8
        Chebyshev distance [cells] to the nearest blocked cell; 0 on the rim.
    labels : (rows, columns) int32
        Component that each free cell belongs to, from 1; 0 for blocked cells.

    """

    free_distance: NDArray[np.uint8]
    labels: NDArray[np.int32]


@contains.register(GridData)
@kernel
def _contains(grid, x):
    """Return whether ``x`` (2,) is free."""
    return is_free(grid.free_distance, x[0], x[1])


@inlined
def is_free(free_distance, x, y):
    """Return whether every cell that touches the point (x, y) is free, kernel frame [cells]."""
    rows, columns = free_distance.shape
    if not (0.0 < x < columns and 0.0 < y < rows):
        return False
    column, row = math.floor(x), math.floor(y)
    if free_distance[row, column] == 0:
        return False
    on_column_line, on_row_line = x == column, y == row
    if on_column_line and free_distance[row, column - 1] == 0:
        return False
    if on_row_line and free_distance[row - 1, column] == 0:
        return False
    return not (on_column_line and on_row_line and free_distance[row - 1, column - 1] == 0)


@component.register(GridData)
@kernel
def _component(grid, x):
    """Return the label of the cell that holds ``x`` (2,); 0 where ``x`` is not free."""
    if not is_free(grid.free_distance, x[0], x[1]):
        return 0
    return int(grid.labels[math.floor(x[1]), math.floor(x[0])])


@first_exit.register(GridData)
@kernel
def _first_exit(grid, x, u, t, horizon):
    """Return the first parameter from ``t`` on at which the ray touches a blocked cell."""
    return traverse(grid.free_distance, x[0], x[1], u[0], u[1], t, horizon)


@touches.register(GridData)
@kernel
def _touches(grid, x):
    """Return whether at least one of the cells that touch ``x`` (2,) is free."""
    free_distance = grid.free_distance
    rows, columns = free_distance.shape
    if not (0.0 < x[0] < columns and 0.0 < x[1] < rows):
        return False
    column, row = math.floor(x[0]), math.floor(x[1])
    left, below = math.ceil(x[0]) - 1, math.ceil(x[1]) - 1
    return _any_free(free_distance, left, column, below, row)


@first_entry.register(GridData)
@kernel
def _first_entry(grid, x, u, t):
    """
    Return the first parameter from ``t`` on at which the ray touches a free cell, or inf.

    The ray is followed from cell to cell.
    """
    if _touches(grid, x + t * u):
        return t
    free_distance = grid.free_distance
    rows, columns = free_distance.shape
    first_column, last_column = _slab(x[0], u[0], columns)
    first_row, last_row = _slab(x[1], u[1], rows)
    s, last = max(t, first_column, first_row), min(last_column, last_row)
    if s >= last:
        return math.inf
    column, column_step, beside_column = first_cell(x[0] + s * u[0], u[0])
    row, row_step, beside_row = first_cell(x[1] + s * u[1], u[1])
    column, row = min(max(column, 0), columns - 1), min(max(row, 0), rows - 1)
    while True:
        s_column = _crossing(x[0], u[0], column, column_step)
        s_row = _crossing(x[1], u[1], row, row_step)
        s = min(s_column, s_row)
        if s >= last:
            return math.inf
        next_column = column + column_step if s_column == s else column
        next_row = row + row_step if s_row == s else row
        left, right = min(column, next_column) + beside_column, max(column, next_column)
        below, above = min(row, next_row) + beside_row, max(row, next_row)
        if _any_free(free_distance, left, right, below, above):
            return max(s, t)
        column, row = next_column, next_row


@kernel
def _slab(x, u, size):
    """Return the parameters between which ``x + s u`` is in (0, size); (inf, -inf) for none."""
    if u == 0.0:
        return (-math.inf, math.inf) if 0.0 < x < size else (math.inf, -math.inf)
    a, b = (0.0 - x) / u, (size - x) / u
    return min(a, b), max(a, b)


@kernel
def _any_free(free_distance, left, right, below, above):
    """Return whether any cell in ranges of columns and rows, ends included, is free."""
    for row in range(below, above + 1):
        for column in range(left, right + 1):
            if free_distance[row, column] > 0:
                return True
    return False


@segment_is_free.register(GridData)
@kernel
def _segment_is_free(grid, a, b):
    """Return whether the segment from ``a`` to ``b`` (2,) is free, without following it beyond."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    if dx == 0.0 and dy == 0.0:
        return is_free(grid.free_distance, a[0], a[1])
    return traverse(grid.free_distance, a[0], a[1], dx, dy, 0.0, 1.0) > 1.0


@kernel
def traverse(free_distance, x, y, dx, dy, t, horizon):
    """
    Return the first parameter from ``t`` on at which the ray touches a blocked cell.

    The ray is followed cell by cell, and by skips across free squares where walls are far. Where
    it is free up to ``horizon``, some parameter above ``horizon`` is returned.
    """
    x_at_t, y_at_t = x + t * dx, y + t * dy
    if not is_free(free_distance, x_at_t, y_at_t):
        return t
    column, column_step, beside_column = first_cell(x_at_t, dx)
    row, row_step, beside_row = first_cell(y_at_t, dy)
    s_column = _crossing(x, dx, column, column_step)
    s_row = _crossing(y, dy, row, row_step)
    per_column, per_row = 1.0 / dx, 1.0 / dy
    reach = int(free_distance[row, column]) - 1
    while True:
        if reach >= LEAST_REACH:
            while reach >= LEAST_REACH:
                s_column = _exit(x, per_column, column, column_step, reach)
                s_row = _exit(y, per_row, row, row_step, reach)
                s = min(s_column, s_row)
                if s > horizon:
                    return max(s, t)
                column, row = math.floor(x + s * dx), math.floor(y + s * dy)
                reach = int(free_distance[row, column]) - 1
            column, s_column = _settled(x, dx, column, column_step, s)
            row, s_row = _settled(y, dy, row, row_step, s)
        s = min(s_column, s_row)
        if s > horizon:
            return max(s, t)
        if s_column == s_row and is_corner_blocked(
            free_distance, row, column, row_step, column_step
        ):
            return max(s, t)
        across_column, across_row = s_column == s, s_row == s
        if across_column:
            column += column_step
            s_column = _crossing(x, dx, column, column_step)
        if across_row:
            row += row_step
            s_row = _crossing(y, dy, row, row_step)
        reach = int(free_distance[row, column]) - 1
        if reach < 0 or is_along_wall(free_distance, row, column, beside_row, beside_column):
            return max(s, t)


@inlined
def is_corner_blocked(free_distance, row, column, row_step, column_step):
    """Return whether a cell beside a diagonal step is blocked, and so the corner in between."""
    beside = free_distance[row, column + column_step]
    return beside == 0 or free_distance[row + row_step, column] == 0


@inlined
def is_along_wall(free_distance, row, column, beside_row, beside_column):
    """Return whether the cell on the other side of a grid line that the ray runs on is blocked."""
    return (
        free_distance[row, column + beside_column] == 0
        or free_distance[row + beside_row, column] == 0
    )


@inlined
def first_cell(at, u):
    """
    Return the index of the cell ahead along one axis, the step to the next cell, and an offset.

    The offset is that of the cell on the other side of the grid line: -1 if the ray runs along a
    grid line, otherwise 0.
    """
    cell = math.floor(at)
    if u > 0.0:
        return cell, 1, 0
    if u < 0.0:
        return math.ceil(at) - 1, -1, 0
    return cell, 0, -1 if at == cell else 0


@inlined
def _crossing(x, u, cell, step):
    """Return the parameter at which the ray leaves ``cell`` along one axis; inf for never."""
    if step == 0:
        return math.inf
    return (cell + (step > 0) - x) / u


@inlined
def _exit(x, per_u, cell, step, reach):
    """
    Return a parameter just before the ray leaves the cells up to ``reach`` away, or inf.

    It is inf where the ray does not move along this axis.
    """
    if step == 0:
        return math.inf
    side = cell + reach + 1 - SKIN if step > 0 else cell - reach + SKIN
    return (side - x) * per_u


@inlined
def _settled(x, u, cell, step, s):
    """
    Return the cell that traversal is in at ``s``, and the parameter at which it leaves that cell.

    ``cell`` is that cell or a neighbour of it.
    """
    if step == 0:
        return cell, math.inf
    while _crossing(x, u, cell - step, step) >= s:
        cell -= step
    crossing = _crossing(x, u, cell, step)
    while crossing < s:
        cell += step
        crossing = _crossing(x, u, cell, step)
    return cell, crossing
