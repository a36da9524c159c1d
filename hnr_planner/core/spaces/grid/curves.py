"""
First exit of a curve from a grid: exact cell traversal along parabolas and arcs.

Between two turning points both coordinates are monotone, so that the curve crosses grid lines in
order, as a ray does: the traversal is that of a ray, with roots instead of quotients.
"""

import math

from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.spaces.curves.curve import at, Bend, coordinate, reach, turn
from hnr_planner.core.spaces.grid.traversal import (
    first_cell,
    is_along_wall,
    is_corner_blocked,
    is_free,
    LEAST_REACH,
    SKIN,
)


@kernel
def first_exit_from_grid(grid, curve, end):
    """
    Return the first parameter in [0, ``end``] at which a curve is not free; inf for none.

    The curve is in the kernel frame [cells].
    """
    free_distance = grid.free_distance
    x, y = coordinate(curve, 0), coordinate(curve, 1)
    if not is_free(free_distance, at(x, 0.0), at(y, 0.0)):
        return 0.0
    t = 0.0
    while t < end:
        piece_end = min(end, min(turn(x, t), turn(y, t)))
        first = _first_exit_of_piece(free_distance, x, y, t, piece_end)
        if first <= piece_end:
            return first
        t = piece_end
    return math.inf


@kernel
def first_exit_of_arc(free_distance, x, y, dx, dy, curvature, end):
    """
    Return the first length in [0, ``end``] at which an arc is not free; inf for none.

    The arc begins at (x, y) [cells] in the unit direction (dx, dy); its ``curvature`` [1 / cells]
    is above 0 for a turn to the left, and not 0. From one turning point to the next it is followed
    without an angle.
    """
    if not is_free(free_distance, x, y):
        return 0.0
    bend, length = abs(curvature), 0.0
    while length < end:
        next_dx, next_dy = _next_axis(dx, dy, curvature)
        cross = abs(dx * next_dy - dy * next_dx)
        tangent = cross / (1.0 + dx * next_dx + dy * next_dy)
        piece = 2.0 * math.atan(tangent) / bend
        if piece >= end - length:
            piece = end - length
            tangent = math.tan(bend * piece / 2.0)
        last = 2.0 * tangent / bend
        along_x, along_y = Bend(x, dx, dy, curvature), Bend(y, dy, -dx, curvature)
        first = _first_exit_of_piece(free_distance, along_x, along_y, 0.0, last)
        if first <= last:
            return length + 2.0 * math.atan(bend * first / 2.0) / bend
        if piece == end - length:
            return math.inf
        x, y = at(along_x, last), at(along_y, last)
        dx, dy = next_dx, next_dy
        length += piece
    return math.inf


@inlined
def _next_axis(dx, dy, curvature):
    """Return the direction along an axis that an arc has next after the direction (dx, dy)."""
    side = math.copysign(1.0, curvature)
    if dx > 0.0 and side * dy >= 0.0:
        return 0.0, side
    if dx <= 0.0 and side * dy > 0.0:
        return -1.0, 0.0
    if dx < 0.0:
        return 0.0, -side
    return 1.0, 0.0


@kernel
def _first_exit_of_piece(free_distance, x, y, t, end):
    """
    Return the first parameter in [``t``, ``end``] at which a curve is not free; inf for none.

    ``x`` and ``y`` are the coordinates of the curve [cells]. Neither of them may turn between
    ``t`` and ``end``.
    """
    x_at_t, y_at_t = at(x, t), at(y, t)
    column, column_step, beside_column = first_cell(x_at_t, at(x, end) - x_at_t)
    row, row_step, beside_row = first_cell(y_at_t, at(y, end) - y_at_t)
    s = t
    while True:
        free = int(free_distance[row, column]) - 1
        if free < 0 or is_along_wall(free_distance, row, column, beside_row, beside_column):
            return max(s, t)
        skips = free >= LEAST_REACH
        s_column = _across(x, t, column, column_step, free if skips else 0, skips)
        s_row = _across(y, t, row, row_step, free if skips else 0, skips)
        s = min(s_column, s_row)
        if s > end:
            return math.inf
        if skips:
            column = math.floor(at(x, s)) if column_step != 0 else column
            row = math.floor(at(y, s)) if row_step != 0 else row
            continue
        if s_column == s_row and is_corner_blocked(
            free_distance, row, column, row_step, column_step
        ):
            return max(s, t)
        column += column_step if s_column == s else 0
        row += row_step if s_row == s else 0


@kernel
def _across(f, t, cell, step, free, inside):
    """
    Return the parameter at which a coordinate leaves the cells up to ``free`` away, or inf.

    When ``inside``, it is that of a point just before, ``SKIN`` [cells] away from the grid line.
    """
    if step == 0:
        return math.inf
    skin = SKIN if inside else 0.0
    return reach(f, cell + free + 1 - skin if step > 0 else cell - free + skin, t)
