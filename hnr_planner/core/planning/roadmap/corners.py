"""
Corners at which short paths bend, found by Hit-and-Run steps.

Two steps from one point end at two points visible from it. Where the segment between these is not
free, the path through the first point, pulled taut, bends at corners of the obstacle between them.
That takes visibility alone, so it works in any space: in the plane the bends are the corners of
obstacles, in more dimensions points on their edges.
"""

from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.lengths import norm
from hnr_planner.core.sampling.draws import hit_and_run_step
from hnr_planner.core.spaces.primitives import contains, first_exit, segment_is_free
import numpy as np

#: Largest number of corners between two points; other pairs find the rest of a longer bend.
CORNERS_MAX = 16


@kernel
def cast_rays(space, points, rng, rays):
    """Take k steps of Hit-and-Run from each of ``points`` (n, dim); write the ends to ``rays``."""
    space, points, rng, rays = borrowed(space), borrowed(points), borrowed(rng), borrowed(rays)
    for point in range(len(points)):
        for k in range(rays.shape[1]):
            hit_and_run_step(space, points[point], rng, rays[point, k])


@kernel
def find_corners(space, points, rays, known, offset):
    """
    Find the corners (c, dim) between the ends of successive rays from the same point.

    ``rays`` (n, k, dim) are the ends of the rays from ``points`` (n, dim). Pairs of rays that are
    equal in ``known`` (n, k, dim), the earlier rays or NaN, are left out. A corner is moved off
    the obstacle by ``offset``, kernel frame.
    """
    space, points, rays = borrowed(space), borrowed(points), borrowed(rays)
    corners = np.empty((len(points) * rays.shape[1] * CORNERS_MAX, points.shape[1]))
    n = 0
    for point in range(len(points)):
        is_known = False
        for k in range(rays.shape[1]):
            was_known, is_known = is_known, (rays[point, k] == known[point, k]).all()
            if k > 0 and not (is_known and was_known):
                a, b = rays[point, k - 1], rays[point, k]
                n += _corners_around(space, a, points[point], b, offset, corners[n:])
    return corners[:n].copy()


@kernel
def _corners_around(space, a, x, b, offset, corners):
    """
    Pull the path a-x-b (dim,) taut and write its ``corners``, from b to a; return their number.

    At most ``CORNERS_MAX`` corners are found.
    """
    corner = b
    for n in range(CORNERS_MAX):
        if segment_is_free(space, a, corner):
            return n
        x = _corner_behind(space, a, x, corner, offset, corners[n])
        if not (
            segment_is_free(space, x, corners[n]) and segment_is_free(space, corners[n], corner)
        ):
            return n
        corner = corners[n]
    return CORNERS_MAX


@kernel
def _corner_behind(space, a, x, b, offset, corner):
    """
    Return the last point from ``x`` to ``a`` visible from ``b``; write the corner behind it.

    Just behind that point the segment to ``b`` is blocked by the corner. The point written is the
    same for every pair at one corner, and visible from everywhere that the corner is visible from.
    """
    step = a - x
    free, middle, blocked = 0.0, 0.5, 1.0
    # To the last bit: a line that runs along a wall touches it anywhere but at its end.
    while free < middle < blocked:
        if segment_is_free(space, b, x + middle * step):
            free = middle
        else:
            blocked = middle
        middle = (free + blocked) / 2.0
    last = x + free * step
    s = min(first_exit(space, b, x + blocked * step - b, 0.0, 1.0), 1.0)
    for i in range(len(corner)):
        corner[i] = b[i] + s * (last[i] - b[i])
    _move_off_obstacle(space, corner, offset)
    return last


@kernel
def _move_off_obstacle(space, x, offset):
    """
    Move ``x`` (dim,), in place, by ``offset`` along the mean of the free diagonal directions.

    It stays where it is if no direction is free or the free ones cancel out.
    """
    y, free = np.empty(len(x)), np.zeros(len(x))
    for signs in range(1 << len(x)):
        for i in range(len(x)):
            y[i] = x[i] + (offset if signs >> i & 1 else -offset)
        if contains(space, y):
            free += y - x
    if norm(free) > 0.0:
        x += offset / norm(free) * free


@kernel
def widen_to_opened(space, points, rays, known, lower, upper):
    """
    Widen the box from ``lower`` to ``upper`` (dim,), in place, towards space that has become free.

    ``space`` is the space before a change. The box is widened to hold each point at which that
    space blocks a ray that is new: one of ``rays`` (n, k, dim) that differs from ``known``.
    """
    for point in range(len(points)):
        for k in range(rays.shape[1]):
            if (rays[point, k] == known[point, k]).all():
                continue
            step = rays[point, k] - points[point]
            s = first_exit(space, points[point], step, 0.0, 1.0)
            if s < 1.0:
                for i in range(len(step)):
                    lower[i] = min(lower[i], points[point, i] + s * step[i])
                    upper[i] = max(upper[i], points[point, i] + s * step[i])


@kernel
def distinct(points, n_kept, radius):
    """
    Return which of ``points`` (k, dim) to keep so that none is a duplicate: (k,) bool.

    The first ``n_kept`` points are kept, and each later point unless it is within ``radius`` of a
    point kept before it.
    """
    is_kept = np.zeros(len(points), dtype=np.bool_)
    order = np.argsort(points[:, 0], kind='mergesort')
    rank = np.empty(len(points), dtype=np.int64)
    rank[order] = np.arange(len(points))
    for k in range(len(points)):
        is_kept[k] = k < n_kept or not _kept_is_near(points, is_kept, order, rank[k], radius)
    return is_kept


@kernel
def _kept_is_near(points, is_kept, order, rank, radius):
    """Return whether a kept point is within ``radius`` of the point at ``rank`` in order of x."""
    x = points[order[rank]]
    for step in (-1, 1):
        other = rank + step
        while 0 <= other < len(order) and abs(points[order[other], 0] - x[0]) <= radius:
            k = order[other]
            if is_kept[k] and norm(points[k] - x) <= radius:
                return True
            other += step
    return False
