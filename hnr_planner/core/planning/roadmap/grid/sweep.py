"""
Sweeps: the corners visible from a point, found by a cone that spreads through the slabs.

A cone is bounded by two rays from the point. In each slab it is cut at the ends of the portals
ahead into narrower cones, which go on in the slabs beyond them. It is stored by the points that
bound it, relative to its root, so that between corners every test is an exact product of whole
numbers.

A corner counts as visible if the segment to it touches no corner before: whatever lies behind a
corner on the same line is visible from that corner in turn. So a ray that has met a corner is no
part of its cone any more.
"""

from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.spaces.grid.slabs import LEFT, RIGHT, slab_at
from hnr_planner.core.trees import NONE
import numpy as np
from numpy.typing import NDArray

#: Columns of an item of the stack: slab of a cone, and whether its left and right bound belong to
#: it, 0 or 1; or a corner to report, and ``IS_CORNER`` in the place of a flag.
SLAB, LEFT_OPEN, RIGHT_OPEN = range(3)
IS_CORNER = -1
#: Takes the place of a corner's index where the target is visible.
TARGET = -1


class Sweep(NamedTuple):
    """
    Work arrays of sweeps.

    Attributes
    ----------
    items : (rows, 3) int32
        Stack of cones and of corners to report; columns ``SLAB`` to ``RIGHT_OPEN``.
    bounds : (rows, 4)
        Points on the left and right bound of each cone, relative to its root [cells].
    seen : (2 n_corners + 8,) int32
        Indices of the corners found, and ``TARGET``.
    reach : (4,) int32
        Box around all slabs entered since it was reset: left, right, lower and upper edge.

    """

    items: NDArray[np.int32]
    bounds: Floats
    seen: NDArray[np.int32]
    reach: NDArray[np.int32]


@kernel
def make_sweep(corners):
    """Return work arrays large enough for sweeps between these corners."""
    # A cone only goes up, or only down, so that it enters each slab at most once; for each portal
    # on its way, and those beside it, at most three items wait.
    rows = 3 * len(corners.at) + 4
    return Sweep(
        np.empty((rows, 3), dtype=np.int32),
        np.empty((rows, 4)),
        np.empty(2 * len(corners.ends) + 8, dtype=np.int32),
        np.empty(4, dtype=np.int32),
    )


@kernel
def see_from_point(slabs, corners, x, y, target_x, target_y, sweep):
    """
    Write the corners visible from a free point on no line between rows; return their number.

    ``TARGET`` is among them if the free point (target_x, target_y) is visible; there is no target
    where ``target_x`` is below 0.
    """
    slab, target_slab, n = slab_at(slabs, x, y), NONE, 0
    if target_x >= 0.0:
        target_slab = slab_at(slabs, target_x, target_y)
        if target_slab == slab:
            sweep.seen[0], n = TARGET, 1
    target = target_slab, target_x - x, target_y - y
    for up in (1, -1):
        _push_cone(sweep.items, sweep.bounds, 0, slab, True, -1.0, 0.0, True, 1.0, 0.0)
        n = _spread(slabs, corners.at, x, y, up, target, sweep, n)
    return n


@kernel
def see_in_quadrant(slabs, corners, corner, right, up, sweep):
    """
    Write the corners visible from a corner in a closed quadrant without its horizontal side.

    Returns their number; they are in the order of their directions, from left to right. The
    quadrant lies to the right (``right`` = 1) or left (-1), and up (``up`` = 1) or down (-1).
    """
    portal, side = corners.ends[corner] // 2, corners.ends[corner] % 2
    x, y = float(slabs.portals[portal, side]), float(slabs.portals[portal, 2])
    slab = slabs.portals[portal, 4] if up == 1 else slabs.portals[portal, 3]
    if right == 1:
        _push_cone(sweep.items, sweep.bounds, 0, slab, True, 0.0, float(up), True, 1.0, 0.0)
    else:
        _push_cone(sweep.items, sweep.bounds, 0, slab, True, -1.0, 0.0, True, 0.0, float(up))
    return _spread(slabs, corners.at, x, y, up, (NONE, 0.0, 0.0), sweep, 0)


@kernel
def _spread(slabs, at, x, y, up, target, sweep, n_seen):
    """
    Spread the cone in row 0 of the stack from its root (x, y), up (``up`` = 1) or down (-1).

    Appends the visible corners to the first ``n_seen`` of ``sweep.seen``, from left to right;
    returns their number. ``target`` is the slab of the target and its point relative to the root.
    """
    items, bounds, seen, reach = sweep.items, sweep.bounds, sweep.seen, sweep.reach
    boxes, portals = slabs.boxes, slabs.portals
    ahead = slabs.above if up == 1 else slabs.below
    beyond = 4 if up == 1 else 3
    target_slab, target_x, target_y = target
    n = 1
    while n > 0:
        n -= 1
        if items[n, LEFT_OPEN] == IS_CORNER:
            seen[n_seen] = items[n, SLAB]
            n_seen += 1
            continue
        slab = items[n, SLAB]
        left_open, right_open = items[n, LEFT_OPEN] == 1, items[n, RIGHT_OPEN] == 1
        lx, ly, rx, ry = bounds[n, 0], bounds[n, 1], bounds[n, 2], bounds[n, 3]
        _extend_reach(reach, boxes, slab)
        # From right to left, so that the stack returns them from left to right.
        for k in range(ahead[slab, 1] - 1, ahead[slab, 0] - 1, -1):
            ax, bx, line = portals[k, LEFT] - x, portals[k, RIGHT] - x, portals[k, 2] - y
            # How far each end of the portal is inside each bound: 0 on it, below 0 outside.
            b_in_left, a_in_right = up * cross(bx, line, lx, ly), up * cross(rx, ry, ax, line)
            if b_in_left <= 0.0:
                if b_in_left == 0.0 and left_open:
                    n = _push_corner(items, n, at[k, RIGHT])
                break
            if a_in_right <= 0.0:
                if a_in_right == 0.0 and right_open:
                    n = _push_corner(items, n, at[k, LEFT])
                continue
            a_in_left, b_in_right = up * cross(ax, line, lx, ly), up * cross(rx, ry, bx, line)
            a_seen, a_open = _end_of_portal(a_in_left, left_open, at[k, LEFT])
            b_seen, b_open = _end_of_portal(b_in_right, right_open, at[k, RIGHT])
            cx, cy = (ax, line) if a_in_left > 0.0 else (lx, ly)
            dx, dy = (bx, line) if b_in_right > 0.0 else (rx, ry)
            if portals[k, beyond] == target_slab and (
                up * cross(target_x, target_y, cx, cy) >= 0.0
                and up * cross(dx, dy, target_x, target_y) >= 0.0
            ):
                seen[n_seen] = TARGET
                n_seen += 1
            n = _push_corner(items, n, at[k, RIGHT] if b_seen else NONE)
            n = _push_cone(items, bounds, n, portals[k, beyond], a_open, cx, cy, b_open, dx, dy)
            n = _push_corner(items, n, at[k, LEFT] if a_seen else NONE)
    return n_seen


@inlined
def cross(ax, ay, bx, by):
    """Return the cross product of two vectors: above 0 where ``b`` is to the left of ``a``."""
    return ax * by - ay * bx


@inlined
def _end_of_portal(inside, is_open, corner):
    """
    Return whether an end of a portal is visible, and whether the bound beyond belongs to the cone.

    ``inside`` is above 0 where the end lies inside the cone's bound on this side, and 0 on it;
    ``is_open`` states whether the bound belongs to the cone before. ``corner`` is the corner at
    the end, NONE where there is none.
    """
    is_seen = inside > 0.0 or (inside == 0.0 and is_open)
    if inside < 0.0:
        return is_seen, is_open
    return is_seen, is_seen and corner == NONE


@inlined
def _push_cone(items, bounds, n, slab, left_open, lx, ly, right_open, rx, ry):
    """Write a cone in row ``n`` of the stack; return the number of rows used."""
    items[n, SLAB], items[n, LEFT_OPEN], items[n, RIGHT_OPEN] = slab, left_open, right_open
    bounds[n, 0], bounds[n, 1], bounds[n, 2], bounds[n, 3] = lx, ly, rx, ry
    return n + 1


@inlined
def _push_corner(items, n, corner):
    """Write a corner to report in row ``n``, unless it is NONE; return the rows used."""
    if corner == NONE:
        return n
    items[n, SLAB], items[n, LEFT_OPEN] = corner, IS_CORNER
    return n + 1


@inlined
def _extend_reach(reach, boxes, slab):
    """Extend the box ``reach`` (4,), in place, to hold a slab."""
    reach[0], reach[1] = min(reach[0], boxes[slab, 0]), max(reach[1], boxes[slab, 1])
    reach[2], reach[3] = min(reach[2], boxes[slab, 2]), max(reach[3], boxes[slab, 3])
