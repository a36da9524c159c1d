"""
Edges of polygons as a compiled space: cells that know which edges come near them.

A ray goes from cell to cell and looks only at the edges there. Where a point lies follows from its
cell alone: the corner of the cell knows in which polygon it is, and on the way there, to the right
and then up, every edge that is crossed leads out of one polygon or into one. Both legs run along
an axis, so that comparing coordinates tells whether an edge is crossed at all: nothing is rounded.

Nothing slips through between two edges: at both a corner is on the same side of a ray, by the same
numbers. What comes nearer to an edge than rounding can tell touches it.
"""

import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.primitives import (
    component,
    contains,
    first_entry,
    first_exit,
    touches,
)
import numpy as np
from numpy.typing import NDArray

#: Cells for one edge, on average over the bounds.
CELLS_FOR_AN_EDGE = 2.0
#: An edge counts as in a cell from this far around it, so that no rounding misses it [cells].
AROUND = 1e-6


class PolygonData(NamedTuple):
    """
    Compiled polygons.

    Attributes
    ----------
    edges : (m, 4)
        From (x, y) to (x, y), with the inside on the left.
    numbers : (m,) int32
        The polygon of each edge, from 1.
    rounding : float
        A point as near to an edge as this is on it.
    lower : (2,)
        Corner of the bounds, where the cells begin.
    side : float
        Side of a cell.
    levels : (rows, columns) int32
        Number of the polygon that holds the upper right corner of each cell; 0 outside.
    first : (cells + 1,) int32
        Where the edges of each cell begin, row by row.
    near : (entries,) int32
        The edges in or at each cell.

    """

    edges: Floats
    numbers: NDArray[np.int32]
    rounding: float
    lower: Floats
    side: float
    levels: NDArray[np.int32]
    first: NDArray[np.int32]
    near: NDArray[np.int32]


def edges_in_cells(edges: Floats, numbers: NDArray[np.int32], rounding: float) -> PolygonData:
    """Return the compiled polygons with these edges (m, 4), inside on the left."""
    corners = edges.reshape(-1, 2)
    lower, extent = corners.min(axis=0), np.ptp(corners, axis=0)
    side = math.sqrt(extent.prod() / (CELLS_FOR_AN_EDGE * len(edges)))
    # A long thin polygon gets fewer cells, in one row.
    side = max(side, extent.max() / (CELLS_FOR_AN_EDGE * len(edges)))
    columns, rows = (extent / side).astype(int) + 1
    levels = np.zeros((rows, columns), dtype=np.int32)
    _level(edges, numbers, lower, side, levels)
    first = np.zeros(rows * columns + 1, dtype=np.int32)
    _enlist(edges, lower, side, (rows, columns), first[1:], np.empty(0, dtype=np.int32))
    first = np.cumsum(first, dtype=np.int32)
    near = np.empty(first[-1], dtype=np.int32)
    _enlist(edges, lower, side, (rows, columns), first[:-1].copy(), near)
    return PolygonData(edges, numbers, rounding, lower, side, levels, first, near)


@kernel
def _enlist(edges, lower, side, shape, filled, near):
    """Write each edge behind those ``filled`` (cells,) of each cell that it comes to, or count."""
    rows, columns = shape
    for k in range(len(edges)):
        ax, ay = (edges[k, 0] - lower[0]) / side, (edges[k, 1] - lower[1]) / side
        bx, by = (edges[k, 2] - lower[0]) / side, (edges[k, 3] - lower[1]) / side
        lowest, highest = min(ay, by) - AROUND, max(ay, by) + AROUND
        for row in range(max(math.floor(lowest), 0), min(math.floor(highest) + 1, rows)):
            s, t = 0.0, 1.0
            if ay != by:
                s, t = (row - AROUND - ay) / (by - ay), (row + 1 + AROUND - ay) / (by - ay)
                s, t = max(min(s, t), 0.0), min(max(s, t), 1.0)
            x, y = ax + s * (bx - ax), ax + t * (bx - ax)
            leftmost, rightmost = min(x, y) - AROUND, max(x, y) + AROUND
            for column in range(
                max(math.floor(leftmost), 0), min(math.floor(rightmost) + 1, columns)
            ):
                at = row * columns + column
                if len(near) > 0:
                    near[filled[at]] = k
                filled[at] += 1


@kernel
def _level(edges, numbers, lower, side, levels):
    """Write the number of the polygon at the upper right corner of each cell."""
    rows, columns = levels.shape
    for k in range(len(edges)):
        ax, ay, bx, by = edges[k]
        first = max(math.floor((min(ay, by) - lower[1]) / side) - 1, 0)
        last = min(math.floor((max(ay, by) - lower[1]) / side) + 1, rows - 1)
        for row in range(first, last + 1):
            y = _line(lower[1], side, row + 1)
            if (ay > y) == (by > y):
                continue
            # As seen from the right: from column to column only what changes is added.
            crossed = ax + (y - ay) / (by - ay) * (bx - ax)
            column = min(math.floor((crossed - lower[0]) / side) + 1, columns - 1)
            while column >= 0 and not _is_right(edges, k, _line(lower[0], side, column + 1), y):
                column -= 1
            if column >= 0:
                levels[row, column] += numbers[k] if by > y else -numbers[k]
    for row in range(rows):
        for column in range(columns - 2, -1, -1):
            levels[row, column] += levels[row, column + 1]


@kernel
def _line(lower, side, k):
    """Coordinate of the line after ``k`` cells."""
    return lower + k * side


@kernel
def _is_right(edges, k, x, y):
    """Say whether edge ``k``, which crosses the height of a point, passes on its right."""
    ax, ay, bx, by = edges[k, 0], edges[k, 1], edges[k, 2], edges[k, 3]
    if x < min(ax, bx):
        return True
    if x >= max(ax, bx):
        return False
    return ((bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0.0) == (by > ay)


@kernel
def _is_above(edges, k, x, y):
    """Say whether edge ``k``, which crosses the line up from a point, passes above it."""
    ax, ay, bx, by = edges[k, 0], edges[k, 1], edges[k, 2], edges[k, 3]
    if y < min(ay, by):
        return True
    if y >= max(ay, by):
        return False
    return ((bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0.0) == (ax > bx)


@kernel
def _locate(space, x, y):
    """Return the number of the polygon that holds a point; 0 outside of all, -1 on an edge."""
    rows, columns = space.levels.shape
    across, up = (x - space.lower[0]) / space.side, (y - space.lower[1]) / space.side
    if not (-AROUND < across < columns and -AROUND < up < rows):
        return 0
    column, row = max(int(across), 0), max(int(up), 0)
    at, level = row * columns + column, space.levels[row, column]
    if space.first[at] == space.first[at + 1]:
        return level
    right = _line(space.lower[0], space.side, column + 1)
    top = _line(space.lower[1], space.side, row + 1)
    for entry in range(space.first[at], space.first[at + 1]):
        k = space.near[entry]
        if _is_on(space, k, x, y):
            return -1
        ay, by = space.edges[k, 1], space.edges[k, 3]
        if (ay > y) != (by > y):
            passed = int(_is_right(space.edges, k, x, y))
            passed -= int(_is_right(space.edges, k, right, y))
            level += passed * (space.numbers[k] if by > ay else -space.numbers[k])
        ax, bx = space.edges[k, 0], space.edges[k, 2]
        if (ax > right) != (bx > right):
            passed = int(_is_above(space.edges, k, right, y))
            passed -= int(_is_above(space.edges, k, right, top))
            level += passed * (space.numbers[k] if ax > bx else -space.numbers[k])
    return level


@kernel
def _is_on(space, k, x, y):
    """Say whether a point is nearer to edge ``k`` than rounding can tell."""
    ax, ay, bx, by = space.edges[k, 0], space.edges[k, 1], space.edges[k, 2], space.edges[k, 3]
    around = space.rounding
    if x < min(ax, bx) - around or x > max(ax, bx) + around:
        return False
    if y < min(ay, by) - around or y > max(ay, by) + around:
        return False
    across, up = bx - ax, by - ay
    apart = across * (y - ay) - up * (x - ax)
    return apart * apart <= around * around * (across * across + up * up)


@contains.register(PolygonData)
@kernel
def _contains(space, x):
    return _locate(space, x[0], x[1]) > 0


@touches.register(PolygonData)
@kernel
def _touches(space, x):
    return _locate(space, x[0], x[1]) != 0


@component.register(PolygonData)
@kernel
def _component(space, x):
    return max(_locate(space, x[0], x[1]), 0)


@first_exit.register(PolygonData)
@kernel
def _first_exit(space, x, u, t, enough):
    px, py = x[0] + t * u[0], x[1] + t * u[1]
    if _locate(space, px, py) <= 0:
        return t
    return t + _first_edge(space, px, py, u[0], u[1], enough - t)


@first_entry.register(PolygonData)
@kernel
def _first_entry(space, x, u, t):
    px, py = x[0] + t * u[0], x[1] + t * u[1]
    if _locate(space, px, py) != 0:
        return t
    return t + _first_edge(space, px, py, u[0], u[1], math.inf)


@kernel
def _first_edge(space, x, y, ux, uy, enough):
    """
    Return the first parameter at which a ray from a point off the edges meets an edge.

    Inf when it never does; anything above ``enough`` once it is known to meet none until there.
    """
    rows, columns = space.levels.shape
    # The same in cells.
    px, py = (x - space.lower[0]) / space.side, (y - space.lower[1]) / space.side
    vx, vy = ux / space.side, uy / space.side
    s, end = _within(px, vx, columns, 0.0, math.inf)
    s, end = _within(py, vy, rows, s, end)
    if s > end:
        return math.inf
    column = min(max(math.floor(px + s * vx), 0), columns - 1)
    row = min(max(math.floor(py + s * vy), 0), rows - 1)
    # Where the ray crosses the next column and the next row, and how far these are apart.
    aside, across = _steps(px, vx, column)
    along, up = _steps(py, vy, row)
    right, above = (1 if vx > 0.0 else -1), (1 if vy > 0.0 else -1)
    around = space.rounding / 2.0 * math.sqrt(ux * ux + uy * uy)
    begins, near, edges, first = space.first, space.near, space.edges, math.inf
    while 0 <= column < columns and 0 <= row < rows:
        at = row * columns + column
        for entry in range(begins[at], begins[at + 1]):
            first = min(first, _meet(edges[near[entry]], around, x, y, ux, uy))
        s = min(aside, along)
        if first <= s:
            return first
        if s > enough:
            return s
        if aside < along:
            column += right
            aside += across
        else:
            row += above
            along += up
    return first


@kernel
def _steps(p, v, cell):
    """Return where ``p + s v`` leaves a cell, and how much further it leaves the next one."""
    if v == 0.0:
        return math.inf, math.inf
    return (cell + (v > 0.0) - p) / v, 1.0 / abs(v)


@kernel
def _within(p, v, cells, first, last):
    """Cut the part of ``p + s v`` between 0 and ``cells`` out of an interval of parameters."""
    if v == 0.0:
        return (first, last) if -AROUND <= p <= cells + AROUND else (math.inf, -math.inf)
    s, t = -p / v, (cells - p) / v
    return max(first, min(s, t)), min(last, max(s, t))


@kernel
def _meet(edge, around, x, y, ux, uy):
    """
    Return the first parameter above 0 at which a ray from off an edge meets it, or inf.

    A ray as near to a corner as ``around``, a distance in units of |u|, meets it.
    """
    ax, ay, bx, by = edge[0] - x, edge[1] - y, edge[2] - x, edge[3] - y
    a, b = ux * ay - uy * ax, ux * by - uy * bx
    if min(a, b) > around or max(a, b) < -around:
        return math.inf
    first = math.inf
    touches_a, touches_b = abs(a) <= around, abs(b) <= around
    if touches_a:
        first = _if_ahead((ux * ax + uy * ay) / (ux * ux + uy * uy))
    if touches_b:
        first = min(first, _if_ahead((ux * bx + uy * by) / (ux * ux + uy * uy)))
    if min(a, b) < 0.0 < max(a, b) and not (touches_a and touches_b):
        across, up = edge[2] - edge[0], edge[3] - edge[1]
        first = min(first, _if_ahead((ax * up - ay * across) / (ux * up - uy * across)))
    return first


@kernel
def _if_ahead(s):
    return s if s > 0.0 else math.inf


@kernel
def distance_to_edges(edges, points):
    """Distances (k,) from points (k, 2) to the nearest of edges (m, 4)."""
    nearest = np.empty(len(points))
    for i in range(len(points)):
        least = math.inf
        for k in range(len(edges)):
            ax, ay = edges[k, 0] - points[i, 0], edges[k, 1] - points[i, 1]
            across, up = edges[k, 2] - edges[k, 0], edges[k, 3] - edges[k, 1]
            s = -(ax * across + ay * up) / (across * across + up * up)
            s = min(max(s, 0.0), 1.0)
            least = min(least, (ax + s * across) ** 2 + (ay + s * up) ** 2)
        nearest[i] = math.sqrt(least)
    return nearest
