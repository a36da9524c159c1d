"""
Where short paths bend: the corners that Hit-and-Run steps go around.

Two steps from one point lead to two points that it sees. Where these do not see each other, the
way between them is pulled taut and comes to lie around the corners of what stands between. They
are found by visibility alone, so in any space: in the plane they are the corners of the obstacles,
in more dimensions points on their edges.
"""

from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.lengths import norm
from hnr_planner.core.sampling.draws import hit_and_run_step
from hnr_planner.core.spaces.primitives import contains, first_exit, segment_is_free
import numpy as np

#: Corners between two points at most: the rest of a longer bend is left to others.
IN_A_BEND = 16


@kernel
def look_around(space, points, rng, looks):
    """Take Hit-and-Run steps from each of ``points`` (n, dim) into a row of ``looks``."""
    space, points, rng, looks = borrowed(space), borrowed(points), borrowed(rng), borrowed(looks)
    for point in range(len(points)):
        for k in range(looks.shape[1]):
            hit_and_run_step(space, points[point], rng, looks[point, k])


@kernel
def find_corners(space, points, looks, known, away):
    """
    Find the corners (c, dim) between each look and the next one from the same point.

    Pairs are left out that are the same in ``known``, which is as ``looks`` (n, k, dim) and holds
    NaN where nothing is. A corner is taken ``away`` from the obstacle.
    """
    space, points, looks = borrowed(space), borrowed(points), borrowed(looks)
    corners = np.empty((len(points) * looks.shape[1] * IN_A_BEND, points.shape[1]))
    n = 0
    for point in range(len(points)):
        is_known = False
        for k in range(looks.shape[1]):
            was_known, is_known = is_known, (looks[point, k] == known[point, k]).all()
            if k > 0 and not (is_known and was_known):
                a, b = looks[point, k - 1], looks[point, k]
                n += _bend(space, a, points[point], b, away, corners[n:])
    return corners[:n].copy()


@kernel
def _bend(space, a, x, b, away, corners):
    """Pull the way a-x-b taut and write its corners, from b to a; return how many."""
    corner = b
    for n in range(IN_A_BEND):
        if segment_is_free(space, a, corner):
            return n
        x = _touch(space, a, x, corner, away, corners[n])
        if not (
            segment_is_free(space, x, corners[n]) and segment_is_free(space, corners[n], corner)
        ):
            return n
        corner = corners[n]
    return IN_A_BEND


@kernel
def _touch(space, a, x, b, away, corner):
    """
    Return the last point on the way from ``x`` to ``a`` that sees ``b``; write what ends its view.

    A little behind that point the line to ``b`` is blocked, by a corner that both lines touch. The
    point written is always the same one for one corner, and seen by all who see the corner.
    """
    way = a - x
    free, middle, blocked = 0.0, 0.5, 1.0
    # To the last bit: a line that runs along a wall touches it anywhere but at its end.
    while free < middle < blocked:
        if segment_is_free(space, b, x + middle * way):
            free = middle
        else:
            blocked = middle
        middle = (free + blocked) / 2.0
    last = x + free * way
    s = min(first_exit(space, b, x + blocked * way - b, 0.0, 1.0), 1.0)
    corner[:] = b + s * (last - b)
    _step_aside(space, corner, away)
    return last


@kernel
def _step_aside(space, x, away):
    """Move ``x`` so far, to the middle of those diagonal directions that are free there."""
    y, free = np.empty(len(x)), np.zeros(len(x))
    for signs in range(1 << len(x)):
        for i in range(len(x)):
            y[i] = x[i] + (away if signs >> i & 1 else -away)
        if contains(space, y):
            free += y - x
    if norm(free) > 0.0:
        x += away / norm(free) * free


@kernel
def find_opening(space, points, looks, known, lower, upper):
    """
    Widen a box to hold where ``space``, as it was, blocked the ways to looks that are not known.

    So it comes to hold what has been opened since.
    """
    for point in range(len(points)):
        for k in range(looks.shape[1]):
            if (looks[point, k] == known[point, k]).all():
                continue
            way = looks[point, k] - points[point]
            s = first_exit(space, points[point], way, 0.0, 1.0)
            if s < 1.0:
                for i in range(len(way)):
                    lower[i] = min(lower[i], points[point, i] + s * way[i])
                    upper[i] = max(upper[i], points[point, i] + s * way[i])


@kernel
def distinct(points, n_kept, apart):
    """
    Say which of ``points`` (k, dim) stand for all of them: (k,) bool.

    The first ``n_kept`` do. Of others within ``apart`` of each other the first does.
    """
    stands = np.zeros(len(points), dtype=np.bool_)
    order = np.argsort(points[:, 0], kind='mergesort')
    place = np.empty(len(points), dtype=np.int64)
    place[order] = np.arange(len(points))
    for k in range(len(points)):
        stands[k] = k < n_kept or not _stands_near(points, stands, order, place[k], apart)
    return stands


@kernel
def _stands_near(points, stands, order, at, apart):
    """Say whether a point that stands is near the one at this place in the order of x."""
    x = points[order[at]]
    for step in (-1, 1):
        place = at + step
        while 0 <= place < len(order) and abs(points[order[place], 0] - x[0]) <= apart:
            k = order[place]
            if stands[k] and norm(points[k] - x) <= apart:
                return True
            place += step
    return False
