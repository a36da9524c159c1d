"""
Exact distance to the occupied squares of a grid, from points and along paths.

Squares are searched in rings of cells around the middle of a short piece of the path. The distance
field gives the first ring with an occupied cell; the search ends with the ring beyond which no
square can be nearer to the piece than the nearest found so far.

Kernel frame: ``wall_distance`` (rows, cols) is the Chebyshev distance [cells] to the nearest
occupied cell, points are (x, y) = (column, row), and all lengths are in cells.
"""

import math

from hnr_planner.core.kernels.kernel import kernel
import numpy as np

#: Largest value of the distance field: farther cells have this value [cells].
FARTHEST_WALL = 254.0
#: Least length of a piece of a path [cells]; where the least distance found so far is longer, a
#: piece is that long.
SHORTEST_PIECE = 2.0


@kernel
def point_clearance(wall_distance, points):
    """
    Return the distances (k,) from points (k, 2) to the nearest occupied square.

    Lengths are in cells. The distances are inf where no square is occupied.
    """
    clearance = np.empty(len(points))
    for k in range(len(points)):
        x, y = points[k]
        clearance[k] = _piece_clearance(wall_distance, x, y, x, y, math.inf)
    return clearance


@kernel
def clearance_within(wall_distance, x, most):
    """Return the distance [cells] from ``x`` (2,) to an occupied square, or ``most`` if less."""
    return _piece_clearance(wall_distance, x[0], x[1], x[0], x[1], most)


@kernel
def path_clearance(wall_distance, path):
    """
    Return the least distance [cells] from a path (m, 2) to an occupied square.

    It is inf where no square is occupied.
    """
    x, y = path[0]
    least = _piece_clearance(wall_distance, x, y, x, y, math.inf)
    for k in range(1, len(path)):
        ax, ay = path[k - 1]
        dx, dy = path[k, 0] - ax, path[k, 1] - ay
        length, done = math.hypot(dx, dy), 0.0
        while done < length:
            end = min(done + max(least, SHORTEST_PIECE), length)
            s, t = done / length, end / length
            least = _piece_clearance(
                wall_distance, ax + s * dx, ay + s * dy, ax + t * dx, ay + t * dy, least
            )
            done = end
    return least


@kernel
def _piece_clearance(wall_distance, ax, ay, bx, by, least):
    """Return the smaller of ``least`` and the distance from segment a-b to an occupied square."""
    rows, columns = wall_distance.shape
    half = math.hypot(bx - ax, by - ay) / 2.0
    column = min(max(math.floor((ax + bx) / 2.0), 0), columns - 1)
    row = min(max(math.floor((ay + by) / 2.0), 0), rows - 1)
    ring = int(wall_distance[row, column])
    farthest = max(column, columns - 1 - column, row, rows - 1 - row)
    # A square in this ring is at least ring - 1 from the middle of the segment.
    while ring <= farthest and ring - 1 - half < least:
        bottom, left, n = row - ring, column - ring, 2 * ring + 1
        for r in (bottom, row + ring):
            least = _side_clearance(wall_distance, r, left, 0, 1, n, ax, ay, bx, by, least)
        for c in (left, column + ring):
            least = _side_clearance(wall_distance, bottom, c, 1, 0, n, ax, ay, bx, by, least)
        ring += 1
    return least


@kernel
def _side_clearance(wall_distance, row, column, up, right, n, ax, ay, bx, by, least):
    """
    Return the smaller of ``least`` and the distance from segment a-b to the side of a ring.

    The distance is that to the occupied cells of the side, which has ``n`` cells from
    (row, column) on, in steps of (up, right).
    """
    rows, columns = wall_distance.shape
    x, y, half = (ax + bx) / 2.0, (ay + by) / 2.0, math.hypot(bx - ax, by - ay) / 2.0
    k = 0
    while k < n:
        r, c = row + k * up, column + k * right
        k += 1
        if 0 <= r < rows and 0 <= c < columns:
            # This many further cells of the row are not occupied.
            k += max(int(wall_distance[r, c]) - 1, 0)
            nearest = math.hypot(_outside(x, c), _outside(y, r)) - half
            if wall_distance[r, c] == 0 and nearest < least:
                least = min(least, _square_distance(ax, ay, bx, by, c, r))
    return least


@kernel
def _square_distance(ax, ay, bx, by, column, row):
    """Return the distance between the segment a-b and the square of a cell; 0 if they meet."""
    if _crosses(ax, ay, bx, by, column, row):
        return 0.0
    # If the two are disjoint, then in a nearest pair of their points, one is an end of the segment
    # or a corner of the square.
    nearest = min(
        math.hypot(_outside(ax, column), _outside(ay, row)),
        math.hypot(_outside(bx, column), _outside(by, row)),
    )
    for corner in range(4):
        x, y = column + corner % 2, row + corner // 2
        nearest = min(nearest, _point_to_segment(x, y, ax, ay, bx, by))
    return nearest


@kernel
def _outside(x, cell):
    """Return the distance from ``x`` to the interval [cell, cell + 1]."""
    return max(cell - x, x - (cell + 1), 0.0)


@kernel
def _point_to_segment(x, y, ax, ay, bx, by):
    """Return the distance from the point (x, y) to the segment a-b."""
    dx, dy = bx - ax, by - ay
    squared = dx * dx + dy * dy
    s = 0.0
    if squared > 0.0:
        s = min(max(((x - ax) * dx + (y - ay) * dy) / squared, 0.0), 1.0)
    return math.hypot(ax + s * dx - x, ay + s * dy - y)


@kernel
def _crosses(ax, ay, bx, by, column, row):
    """
    Return whether the segment a-b meets the closed square of a cell.

    It does where one parameter is both between its left and right and its lower and upper sides.
    """
    first, last = 0.0, 1.0
    for a, d, cell in ((ax, bx - ax, column), (ay, by - ay, row)):
        if d == 0.0:
            if _outside(a, cell) > 0.0:
                return False
        else:
            s, t = (cell - a) / d, (cell + 1 - a) / d
            first, last = max(first, min(s, t)), min(last, max(s, t))
    return first <= last
