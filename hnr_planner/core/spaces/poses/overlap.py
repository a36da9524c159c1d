"""
Whether a footprint at one pose touches a blocked cell, decided exactly, row by row.

The part of a convex piece in a row of cells is convex, so it meets every cell between its leftmost
and its rightmost point. All lengths are in cells, in the kernel frame of a grid.
"""

import math

from hnr_planner.core.kernels.kernel import inlined, kernel

#: Distance [cells] up to which a footprint counts as touching a cell, far above rounding.
SLACK = 1e-9


@kernel
def overlaps(free_distance, pieces, piece_ends, circle, x, y, yaw):
    """
    Return whether a footprint at the pose (x, y, yaw) touches a blocked cell or the map's edge.

    ``free_distance`` (rows, columns) is 0 on blocked cells and on the rim; ``pieces``,
    ``piece_ends`` and ``circle`` are those of ``Footprint``.
    """
    rows, columns = free_distance.shape
    cos, sin = math.cos(yaw), math.sin(yaw)
    centre_x = x + cos * circle[0] - sin * circle[1]
    centre_y = y + sin * circle[0] + cos * circle[1]
    # Every footprint in the map has the centre of its circle there.
    if not (0.0 < centre_x < columns and 0.0 < centre_y < rows):
        return True
    if free_distance[math.floor(centre_y), math.floor(centre_x)] - 1.0 > circle[2] + SLACK:
        return False
    begin = 0
    for end in piece_ends:
        if _piece_overlaps(free_distance, pieces, begin, end, x, y, cos, sin):
            return True
        begin = end
    return False


@kernel
def _piece_overlaps(free_distance, pieces, begin, end, x, y, cos, sin):
    """Return whether a convex piece, rows ``begin`` to ``end`` of ``pieces``, is blocked."""
    rows, columns = free_distance.shape
    lowest, highest = math.inf, -math.inf
    for k in range(begin, end):
        height = y + sin * pieces[k, 0] + cos * pieces[k, 1]
        lowest, highest = min(lowest, height), max(highest, height)
    first, last = math.floor(lowest - SLACK), math.floor(highest + SLACK)
    if first < 0 or last >= rows:
        return True
    for row in range(first, last + 1):
        left, right = math.inf, -math.inf
        bottom, top = row - SLACK, row + 1.0 + SLACK
        bx = x + cos * pieces[end - 1, 0] - sin * pieces[end - 1, 1]
        by = y + sin * pieces[end - 1, 0] + cos * pieces[end - 1, 1]
        for k in range(begin, end):
            ax, ay = bx, by
            bx = x + cos * pieces[k, 0] - sin * pieces[k, 1]
            by = y + sin * pieces[k, 0] + cos * pieces[k, 1]
            left, right = with_span(ax, ay, bx, by, bottom, top, left, right)
        column, last_column = math.floor(left - SLACK), math.floor(right + SLACK)
        if column < 0 or last_column >= columns:
            return True
        while column <= last_column:
            distance = free_distance[row, column]
            if distance == 0:
                return True
            column += int(distance)
    return False


@inlined
def with_span(ax, ay, bx, by, bottom, top, left, right):
    """
    Return the interval (left, right) extended by the span in x of a part of the segment a-b.

    The part is that between the heights ``bottom`` and ``top``; where there is none, the interval
    stays as it is.
    """
    if ay > by:
        ax, ay, bx, by = bx, by, ax, ay
    if ay > top or by < bottom:
        return left, right
    if ay < bottom:
        slope = (bx - ax) / (by - ay)
        first = ax + (bottom - ay) * slope
    else:
        first = ax
    if by > top:
        slope = (bx - ax) / (by - ay)
        last = ax + (top - ay) * slope
    else:
        last = bx
    return min(left, min(first, last)), max(right, max(first, last))
