"""
Targets: where a search of ``polyanya`` may end, a point or the points of a disc.

A slab, the visible part of a slab and a disc are convex, so in each cone one point of the disc is
the nearest to the root of the cone. Free space is open: a point counts where it is at least
``inset`` inside its slab.
"""

import math
from typing import NamedTuple

from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.spaces.grid.slabs import OFF_LINE, slab_at
import numpy as np

#: A point of a disc counts as visible up to this distance [cells] beyond a bound of a cone.
SLACK = 1e-9
#: Index of the slab of a target that is a disc.
NO_SLAB = -1


class Target(NamedTuple):
    """
    Where a search has to end, kernel frame [cells].

    Attributes
    ----------
    x, y : float
        The point itself, or the centre of the disc, which need not be free.
    radius : float
        Radius of the disc; 0 where the search has to end exactly at the point.
    inset : float
        Least distance of a point of the disc to the edges of its slab.
    slab : int
        Slab that holds the point; ``NO_SLAB``, -1, for a disc.

    """

    x: float
    y: float
    radius: float
    inset: float
    slab: int


@kernel
def make_target(slabs, goal, radius, margin):
    """
    Return the target that is a free point ``goal`` (2,), or the disc of ``radius`` > 0 around it.

    The disc is smaller than asked for, and its points are inside their slabs, by half a ``margin``
    [cells]. So it holds a point wherever the disc asked for holds one at the margin from walls.
    """
    x, y, inset, slab = float(goal[0]), float(goal[1]), 0.5 * margin, NO_SLAB
    if radius == 0.0:
        y = off_line(y)
        slab = int(slab_at(slabs, x, y))
    return Target(x, y, radius - min(inset, 0.5 * radius), inset, slab)


@inlined
def off_line(y):
    """Return the height ``y`` of a free point, moved up by ``OFF_LINE`` if a line lies there."""
    return y + OFF_LINE if y == math.floor(y) else y


@inlined
def holds_target(slabs, target, slab):
    """Return whether a slab holds the target, or a point of it."""
    if target.radius == 0.0:
        return slab == target.slab
    left, right, lower, upper = _inner_box(slabs, target, slab)
    across = max(left - target.x, 0.0, target.x - right)
    return math.hypot(across, max(lower - target.y, 0.0, target.y - upper)) <= target.radius


@kernel
def _inner_box(slabs, target, slab):
    """Return left, right, lower and upper edge of the points of a slab that may count."""
    box = slabs.boxes[slab]
    inset = target.inset
    return box[0] + inset, box[1] - inset, box[2] + inset, box[3] - inset


@kernel
def nearest_of_disc(slabs, target, slab, x, y, bounds):
    """
    Return the point (x, y) of a disc in a slab that is nearest to (x, y); (nan, nan) if none is.

    Parameters
    ----------
    slabs : Slabs
        Slabs of the grid.
    target : Target
        The disc.
    slab : int
        Index of the slab.
    x, y : float
        A point outside the disc or on an edge of the slab.
    bounds : (k, 4) float64
        Bounds of what counts of the slab: the points to the left of the line from the first point
        to the second of each row (x, y, x, y). Rows of two equal points bound nothing.

    """
    left, right, lower, upper = _inner_box(slabs, target, slab)
    away = math.hypot(x - target.x, y - target.y)
    part = min(1.0, target.radius / away) if away > 0.0 else 1.0
    px, py = target.x + part * (x - target.x), target.y + part * (y - target.y)
    if left <= px <= right and lower <= py <= upper and _is_within(bounds, px, py):
        return px, py
    corners = np.empty((4 + len(bounds), 2))
    corners[0, 0], corners[1, 0], corners[2, 0], corners[3, 0] = left, right, right, left
    corners[0, 1], corners[1, 1], corners[2, 1], corners[3, 1] = lower, lower, upper, upper
    n = 4
    for k in range(len(bounds)):
        corners, n = _clipped(corners, n, bounds[k])
    return _nearest_on_edges(corners, n, target, x, y)


@kernel
def _is_within(bounds, px, py):
    """Return whether a point lies to the left of all bounds, up to ``SLACK``."""
    for k in range(len(bounds)):
        if _left_of(bounds[k], px, py) < -SLACK:
            return False
    return True


@kernel
def _left_of(bound, px, py):
    """Return the distance of a point from the line of a bound, negative on its right side."""
    ux, uy = bound[2] - bound[0], bound[3] - bound[1]
    length = math.hypot(ux, uy)
    return (ux * (py - bound[1]) - uy * (px - bound[0])) / length if length > 0.0 else 0.0


@kernel
def _clipped(corners, n, bound):
    """
    Return the corners of a convex polygon to the left of a line, up to ``SLACK``, and how many.

    ``corners`` (rows, 2) holds the ``n`` corners of the polygon, anticlockwise.
    """
    kept, n_kept = np.empty_like(corners), 0
    for k in range(n):
        ax, ay = corners[k - 1 if k > 0 else n - 1]
        bx, by = corners[k]
        a, b = _left_of(bound, ax, ay) + SLACK, _left_of(bound, bx, by) + SLACK
        if (a < 0.0) != (b < 0.0):
            part = a / (a - b)
            kept[n_kept, 0], kept[n_kept, 1] = ax + part * (bx - ax), ay + part * (by - ay)
            n_kept += 1
        if b >= 0.0:
            kept[n_kept, 0], kept[n_kept, 1] = bx, by
            n_kept += 1
    return kept, n_kept


@kernel
def _nearest_on_edges(corners, n, target, x, y):
    """Return the point of a disc on the edges of a polygon nearest to (x, y), or (nan, nan)."""
    nearest_x, nearest_y, least = math.nan, math.nan, math.inf
    for k in range(n):
        ax, ay = corners[k - 1 if k > 0 else n - 1]
        ux, uy = corners[k, 0] - ax, corners[k, 1] - ay
        squared = ux * ux + uy * uy
        if squared == 0.0:
            continue
        middle = ((target.x - ax) * ux + (target.y - ay) * uy) / squared
        away = math.hypot(ax + middle * ux - target.x, ay + middle * uy - target.y)
        if away > target.radius:
            continue
        half = math.sqrt((target.radius - away) * (target.radius + away) / squared)
        first, last = max(middle - half, 0.0), min(middle + half, 1.0)
        if first > last:
            continue
        t = min(max(((x - ax) * ux + (y - ay) * uy) / squared, first), last)
        px, py = ax + t * ux, ay + t * uy
        distance = math.hypot(px - x, py - y)
        if distance < least:
            nearest_x, nearest_y, least = px, py, distance
    return nearest_x, nearest_y
