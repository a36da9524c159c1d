"""
Polygons as a compiled space: edges in a grid of cells, each of which lists the edges near it.

A ray is followed from cell to cell and tested against the edges that each cell lists. The polygon
that contains a point follows from its cell alone: the polygon at the upper right corner of the
cell is stored, and from the point to that corner, to the right and then up, every edge crossed is
the exit from a polygon or the entry into one. Both segments are parallel to an axis, so that
comparisons of coordinates decide whether an edge is crossed, without rounding.

No ray passes between two edges that share a corner: on which side of the ray the corner lies is
computed from the same numbers for both edges. A point or a ray that is closer to an edge than
``rounding`` touches the edge.

Only this module knows what the arrays of ``PolygonData`` mean: hence its length.
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

#: Distance [cells] up to which an edge counts as near a cell; more than rounding.
AROUND = 1e-6


class PolygonData(NamedTuple):
    """
    Compiled polygons.

    Attributes
    ----------
    edges : (m, 4)
        Ends (x, y, x, y) of each edge, kernel frame, with the inside of its polygon on the left.
    numbers : (m,) int32
        Number of the polygon of each edge, from 1.
    rounding : float
        Distance to an edge up to which a point counts as on the edge.
    lower : (2,)
        Lower corner of the bounds, where the cells begin.
    side : float
        Side of a cell, in units of the kernel frame.
    levels : (rows, columns) int32
        Number of the polygon that holds the upper right corner of each cell; 0 outside.
    first : (cells + 1,) int32
        Index in ``near`` at which the list of each cell begins, row by row, and the length of
        ``near``.
    near : (entries,) int32
        Indices in ``edges`` of the edges in or near each cell.

    """

    edges: Floats
    numbers: NDArray[np.int32]
    rounding: float
    lower: Floats
    side: float
    levels: NDArray[np.int32]
    first: NDArray[np.int32]
    near: NDArray[np.int32]


@kernel
def line(lower, side, k):
    """Return the coordinate of the grid line ``k`` cells of length ``side`` after ``lower``."""
    return lower + k * side


@kernel
def is_right(edges, k, x, y):
    """
    Return whether edge ``k`` crosses the horizontal line through (x, y) right of that point.

    The edge has to cross that line somewhere.
    """
    ax, ay, bx, by = edges[k, 0], edges[k, 1], edges[k, 2], edges[k, 3]
    if x < min(ax, bx):
        return True
    if x >= max(ax, bx):
        return False
    return ((bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0.0) == (by > ay)


@kernel
def _is_above(edges, k, x, y):
    """
    Return whether edge ``k`` crosses the vertical line through (x, y) above that point.

    The edge has to cross that line somewhere.
    """
    ax, ay, bx, by = edges[k, 0], edges[k, 1], edges[k, 2], edges[k, 3]
    if y < min(ay, by):
        return True
    if y >= max(ay, by):
        return False
    return ((bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0.0) == (ax > bx)


@kernel
def _locate(space, x, y):
    """
    Return the number of the polygon, from 1, that contains the point (x, y).

    It is 0 outside of all polygons, and -1 on an edge.
    """
    rows, columns = space.levels.shape
    across, up = (x - space.lower[0]) / space.side, (y - space.lower[1]) / space.side
    if not (-AROUND < across < columns and -AROUND < up < rows):
        return 0
    column, row = max(int(across), 0), max(int(up), 0)
    at, level = row * columns + column, space.levels[row, column]
    if space.first[at] == space.first[at + 1]:
        return level
    right = line(space.lower[0], space.side, column + 1)
    top = line(space.lower[1], space.side, row + 1)
    for entry in range(space.first[at], space.first[at + 1]):
        k = space.near[entry]
        if _is_on(space, k, x, y):
            return -1
        ay, by = space.edges[k, 1], space.edges[k, 3]
        if (ay > y) != (by > y):
            passed = int(is_right(space.edges, k, x, y))
            passed -= int(is_right(space.edges, k, right, y))
            level += passed * (space.numbers[k] if by > ay else -space.numbers[k])
        ax, bx = space.edges[k, 0], space.edges[k, 2]
        if (ax > right) != (bx > right):
            passed = int(_is_above(space.edges, k, right, y))
            passed -= int(_is_above(space.edges, k, right, top))
            level += passed * (space.numbers[k] if ax > bx else -space.numbers[k])
    return level


@kernel
def _is_on(space, k, x, y):
    """Return whether the point (x, y) is on edge ``k``, up to a distance of ``rounding``."""
    ax, ay, bx, by = space.edges[k, 0], space.edges[k, 1], space.edges[k, 2], space.edges[k, 3]
    rounding = space.rounding
    if x < min(ax, bx) - rounding or x > max(ax, bx) + rounding:
        return False
    if y < min(ay, by) - rounding or y > max(ay, by) + rounding:
        return False
    across, up = bx - ax, by - ay
    area = across * (y - ay) - up * (x - ax)
    return area * area <= rounding * rounding * (across * across + up * up)


@contains.register(PolygonData)
@kernel
def _contains(space, x):
    """Return whether ``x`` (2,) is inside a polygon."""
    return _locate(space, x[0], x[1]) > 0


@touches.register(PolygonData)
@kernel
def _touches(space, x):
    """Return whether ``x`` (2,) is in a polygon or on an edge."""
    return _locate(space, x[0], x[1]) != 0


@component.register(PolygonData)
@kernel
def _component(space, x):
    """Return the number of the polygon that holds ``x`` (2,); 0 for none."""
    return max(_locate(space, x[0], x[1]), 0)


@first_exit.register(PolygonData)
@kernel
def _first_exit(space, x, u, t, horizon):
    """
    Return the first parameter from ``t`` on at which the ray meets an edge.

    It is ``t`` where the point at ``t`` is not inside a polygon.
    """
    px, py = x[0] + t * u[0], x[1] + t * u[1]
    if _locate(space, px, py) <= 0:
        return t
    return t + _first_edge(space, px, py, u[0], u[1], horizon - t)


@first_entry.register(PolygonData)
@kernel
def _first_entry(space, x, u, t):
    """
    Return the first parameter from ``t`` on at which the ray touches a polygon, or inf.

    It is ``t`` where the point at ``t`` is in a polygon or on an edge.
    """
    px, py = x[0] + t * u[0], x[1] + t * u[1]
    if _locate(space, px, py) != 0:
        return t
    return t + _first_edge(space, px, py, u[0], u[1], math.inf)


@kernel
def _first_edge(space, x, y, ux, uy, horizon):
    """
    Return the first parameter at which a ray from a point off the edges meets an edge.

    It is inf when the ray meets no edge at all, and may be any value above ``horizon`` when the
    ray meets no edge up to ``horizon``.
    """
    rows, columns = space.levels.shape
    # Point and direction in units of a cell.
    px, py = (x - space.lower[0]) / space.side, (y - space.lower[1]) / space.side
    vx, vy = ux / space.side, uy / space.side
    s, end = _within(px, vx, columns, 0.0, math.inf)
    s, end = _within(py, vy, rows, s, end)
    if s > end:
        return math.inf
    column = min(max(math.floor(px + s * vx), 0), columns - 1)
    row = min(max(math.floor(py + s * vy), 0), rows - 1)
    # Parameters at which the ray enters the next column and row, and the distance between such.
    next_column, per_column = _steps(px, vx, column)
    next_row, per_row = _steps(py, vy, row)
    right, above = (1 if vx > 0.0 else -1), (1 if vy > 0.0 else -1)
    tolerance = space.rounding / 2.0 * math.sqrt(ux * ux + uy * uy)
    begins, near, edges, first = space.first, space.near, space.edges, math.inf
    while 0 <= column < columns and 0 <= row < rows:
        at = row * columns + column
        for entry in range(begins[at], begins[at + 1]):
            first = min(first, _meet(edges[near[entry]], tolerance, x, y, ux, uy))
        s = min(next_column, next_row)
        if first <= s:
            return first
        if s > horizon:
            return s
        if next_column < next_row:
            column += right
            next_column += per_column
        else:
            row += above
            next_row += per_row
    return first


@kernel
def _steps(p, v, cell):
    """
    Return the parameter s at which ``p + s v`` leaves a cell, and the step of s for one cell.

    ``p`` and ``v`` are in cells, along one axis; both results are inf where ``v`` is 0.
    """
    if v == 0.0:
        return math.inf, math.inf
    return (cell + (v > 0.0) - p) / v, 1.0 / abs(v)


@kernel
def _within(p, v, cells, first, last):
    """
    Return the part of [first, last] in which ``p + s v`` is in [0, ``cells``].

    In an empty part, the first end is above the last.
    """
    if v == 0.0:
        return (first, last) if -AROUND <= p <= cells + AROUND else (math.inf, -math.inf)
    s, t = -p / v, (cells - p) / v
    return max(first, min(s, t)), min(last, max(s, t))


@kernel
def _meet(edge, tolerance, x, y, ux, uy):
    """
    Return the first parameter above 0 at which a ray meets an edge, or inf.

    The ray starts at (x, y), which must not be on the edge. It also meets the edge where it passes
    an end of the edge at a distance of at most ``tolerance / |u|``.
    """
    ax, ay, bx, by = edge[0] - x, edge[1] - y, edge[2] - x, edge[3] - y
    a, b = ux * ay - uy * ax, ux * by - uy * bx
    if min(a, b) > tolerance or max(a, b) < -tolerance:
        return math.inf
    first = math.inf
    touches_a, touches_b = abs(a) <= tolerance, abs(b) <= tolerance
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
    """Return the parameter ``s`` if it is above 0, and inf otherwise."""
    return s if s > 0.0 else math.inf


@kernel
def distance_to_edges(edges, points):
    """Return the distance (k,) from each of points (k, 2) to the nearest of edges (m, 4)."""
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
