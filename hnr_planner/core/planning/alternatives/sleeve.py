"""
The shortest of the paths that can be deformed into a given one, exactly: the funnel algorithm.

A free path on a grid passes from slab to slab through portals. Where it leaves a slab by the
portal by which it has come, it can be pulled out of that slab. The portals that remain are passed,
in this order, by every path that can be deformed into it, and the shortest of these is found by a
funnel between the ends of the portals.
Sources: Lee and Preparata, "Euclidean shortest paths in the presence of rectilinear barriers",
Networks 14 (1984); Hershberger and Snoeyink, "Computing minimum length paths of a given homotopy
class", Computational Geometry 4 (1994).
"""

from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.copies import copy_into
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.lengths import distance
from hnr_planner.core.planning.planners.cones import side_of
from hnr_planner.core.planning.planners.target import off_line
from hnr_planner.core.planning.planners.taut_path import step_aside
from hnr_planner.core.spaces.grid.slabs import LEFT, RIGHT, slab_at
import numpy as np

#: Way of a portal that is passed upwards; 0 for downwards.
UP = 1


@kernel
def shortest_in_class(space, slabs, points, margin):
    """
    Return the shortest path that a free path can be deformed into, and its length.

    Parameters
    ----------
    space : GridData
        The grid.
    slabs : Slabs
        Its slabs.
    points : (m, 2)
        The path, kernel frame.
    margin : float
        Distance [cells] at which the result passes corners.

    Returns
    -------
    path : (k, 2)
        The path, kernel frame; (0, 2) where roundings hide which portals ``points`` passes.
    length : float
        Length of the shortest path [cells] without the margins: no path of the class is shorter.

    """
    slabs, points = borrowed(slabs), borrowed(points)
    passed, is_whole = _portals_passed(slabs, points)
    if not is_whole:
        return np.empty((0, 2)), 0.0
    ends = _ends(slabs, passed, points[0], points[-1])
    corners = _pull(ends)
    length = 0.0
    path = np.empty((len(corners) + 2, 2))
    copy_into(path[0], points[0])
    before = points[0]
    for k in range(len(corners)):
        portal, side = corners[k] // 2, corners[k] % 2
        is_up = passed[portal] % 2 == UP
        end = side if is_up else 1 - side
        step = slabs.steps[passed[portal] // 2, end]
        corner = ends[portal + 1, side]
        path[k + 1, 0] = corner[0] + margin * step[0]
        path[k + 1, 1] = corner[1] + margin * step[1]
        length += distance(before, corner)
        before = corner
    copy_into(path[len(corners) + 1], points[-1])
    length += distance(before, points[-1])
    return step_aside(space, path, margin), length


@kernel
def _portals_passed(slabs, points):
    """
    Return the portals that a path (m, 2) passes, without those by which it comes straight back.

    Returns (passed, is_whole): ``passed`` (k,) holds twice the index of each portal, plus ``UP``
    where it is passed upwards; ``is_whole`` is false where they do not lead to the path's end.
    """
    passed, n = np.empty(64, dtype=np.int64), 0
    x, y = points[0, 0], off_line(points[0, 1])
    slab = slab_at(slabs, x, y)
    for k in range(1, len(points)):
        end_x, end_y = points[k, 0], off_line(points[k, 1])
        while end_y > slabs.boxes[slab, 3] or end_y < slabs.boxes[slab, 2]:
            up = end_y > slabs.boxes[slab, 3]
            line = slabs.boxes[slab, 3 if up else 2]
            edge = slabs.above if up else slabs.below
            at = x + (end_x - x) * (line - y) / (end_y - y)
            portal = edge[slab, 0]
            while portal + 1 < edge[slab, 1] and slabs.portals[portal, 1] < at:
                portal += 1
            if edge[slab, 0] == edge[slab, 1]:
                return passed[:n], False
            slab = slabs.portals[portal, 4 if up else 3]
            way = 2 * portal + (UP if up else 0)
            if n > 0 and passed[n - 1] == way ^ 1:
                n -= 1
                continue
            if n == len(passed):
                longer = np.empty(2 * n, dtype=np.int64)
                for i in range(n):
                    longer[i] = passed[i]
                passed = longer
            passed[n] = way
            n += 1
        x, y = end_x, end_y
    return passed[:n], slab == slab_at(slabs, x, y)


@kernel
def _ends(slabs, passed, start, goal):
    """
    Return the ends (k + 2, 2, 2) of the portals passed, as the path sees them: left, then right.

    The first and the last row are the start and the goal (2,), twice each.
    """
    ends = np.empty((len(passed) + 2, 2, 2))
    for side in (LEFT, RIGHT):
        copy_into(ends[0, side], start)
        copy_into(ends[len(ends) - 1, side], goal)
        for k in range(len(passed)):
            portal = slabs.portals[passed[k] // 2]
            is_up = passed[k] % 2 == UP
            ends[k + 1, side, 0] = portal[side if is_up else 1 - side]
            ends[k + 1, side, 1] = portal[2]
    return ends


@kernel
def _pull(ends):
    """
    Return the ends of portals at which the shortest path through all of them bends.

    ``ends`` (k + 2, 2, 2) is as ``_ends`` returns it. The result (m,) holds twice the number of
    each portal, counted from 0, plus the side of its end, in the order of the path. The path from
    the apex to the next portal lies in a funnel between two of the ends, one on each side.
    """
    bends, n = np.empty(2 * len(ends), dtype=np.int64), 0
    apex, bounds, rows = ends[0, LEFT].copy(), ends[0].copy(), np.zeros(2, dtype=np.int64)
    k = 1
    while k < len(ends):
        has_bent = False
        for side in (LEFT, RIGHT):
            inwards, other, new = (1.0 if side == RIGHT else -1.0), 1 - side, ends[k, side]
            if has_bent or inwards * _side_of(apex, bounds[side], new) < 0.0:
                continue
            is_open = rows[other] == k or inwards * _side_of(apex, bounds[other], new) < 0.0
            if is_open or _equal(apex, bounds[side]):
                copy_into(bounds[side], new)
                rows[side] = k
                continue
            has_bent = True
            bends[n] = 2 * (rows[other] - 1) + other
            n += 1
            copy_into(apex, bounds[other])
            copy_into(bounds[side], apex)
            rows[side] = k = rows[other]
        k += 1
    return bends[:n].copy()


@kernel
def _equal(a, b):
    """Return whether two points (2,) are equal."""
    return a[0] == b[0] and a[1] == b[1]


@kernel
def _side_of(a, b, p):
    """Return a number > 0 where ``p`` is left of the line from ``a`` to ``b``, < 0 right of it."""
    return side_of(a[0], a[1], b[0], b[1], p[0], p[1])
