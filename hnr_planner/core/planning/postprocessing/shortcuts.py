"""
Kernels that shorten a path by visibility; each returns the number of its visibility tests.

``relax``: the shortest path over some of the vertices, in their order. ``skip``: each vertex is
followed by the last vertex visible from it. ``join``: random points of the path are joined.
``pull``: each vertex slides along its two segments up to the next obstacle, and the corner that
remains is cut off, so that the path is taut around obstacles.

Every segment of the result was tested itself, from its first point to its last: in a space that
tests segments at single points, a section of a free segment need not be free.

With ``islands`` the path stays in its homology class: no segment is replaced by one that passes an
island on the other side.
"""

from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.copies import copy_into, copy_rows
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import uniform
from hnr_planner.core.lengths import norm
from hnr_planner.core.planning.homology import crossings, loop_signature, signature
from hnr_planner.core.spaces.primitives import segment_is_free
import numpy as np

#: Largest number of tests from one vertex, where each is halfway to the one before.
TESTS_PER_VERTEX_MAX = 64
#: Halvings of the segment on which a vertex slides or its corner is cut.
HALVINGS = 12
#: Largest number of tests for one vertex that slides twice and whose corner is cut.
TESTS_OF_A_PULL = 1 + 3 * HALVINGS + 7
#: Least gain for which a corner is cut, as a fraction of its two segments.
LEAST_CUT = 1e-3


@kernel
def relax(space, islands, points, to_end, following, i, tests_max):
    """
    Extend the shortest paths over vertices, in their order, from the end back to vertex ``i``.

    ``to_end`` (m,) is the length of the shortest path from each vertex to the last one, and
    ``following`` (m,) the index of the vertex after it on that path; both are known for the
    vertices after ``i`` and written for the others. Returns (index of the vertex to go on with, -1
    when all are done; number of tests, at most ``tests_max``).
    """
    space, islands, points = borrowed(space), borrowed(islands), borrowed(points)
    tests = 0
    while i >= 0 and tests < tests_max:
        lengths = np.empty(len(points) - 1 - i)
        for k in range(len(lengths)):
            j = i + 1 + k
            lengths[k] = norm(points[j] - points[i]) + to_end[j]
        # The next vertex is known to be visible.
        to_end[i], following[i] = lengths[0], i + 1
        for k in np.argsort(lengths, kind='mergesort'):
            if lengths[k] >= to_end[i] or tests == tests_max:
                break
            tests += 1
            if _may_join(space, islands, points, i, i + 1 + k):
                to_end[i], following[i] = lengths[k], i + 1 + k
        i -= 1
    return i, tests


@kernel
def skip(space, islands, points, kept, n_kept, every, tests_max):
    """
    Extend the list of kept vertices: each is followed by a later vertex visible from it.

    ``kept`` holds indices into ``points`` (m, dim), ``n_kept`` of them at first. From a kept
    vertex the later ones are tested, the last first, until one is visible: all of them where
    ``every``, else the last one, the one halfway there, halfway to that one, and so on. A vertex
    is not begun unless enough of ``tests_max`` are left for it. Returns (number of vertices kept,
    number of tests).
    """
    space, points = borrowed(space), borrowed(points)
    last, tests = len(points) - 1, 0
    while kept[n_kept - 1] < last:
        at = kept[n_kept - 1]
        ahead = last - at
        if tests + (ahead if every else TESTS_PER_VERTEX_MAX) > tests_max:
            break
        while ahead > 1:
            tests += 1
            if _may_join(space, islands, points, at, at + ahead):
                break
            ahead = ahead - 1 if every else ahead // 2
        kept[n_kept] = at + ahead
        n_kept += 1
    return n_kept, tests


@kernel
def _may_join(space, islands, points, i, j):
    """
    Return whether the segment from vertex ``i`` to ``j`` may replace the path between them.

    It has to be free and pass each of the ``islands`` on the side where the path passes it.
    """
    if not segment_is_free(space, points[i], points[j]):
        return False
    after = j + 1
    return signature(islands, points[i:after]) == crossings(islands, points[i], points[j])


@kernel
def join(space, islands, points, rng, n_pairs):
    """
    Try to join ``n_pairs`` random pairs of points of a path (m, dim); return the path (k, dim).

    Each pair takes at most three visibility tests.
    """
    space, islands, rng = borrowed(space), borrowed(islands), borrowed(rng)
    for _ in range(n_pairs):
        points = _join_two(space, islands, points, rng)
    return points


@kernel
def pull(space, islands, points, k, margin, tests_max):
    """
    Pull a path (m, dim) taut at the vertices from ``k`` on.

    A vertex whose neighbours may be joined is dropped. Any other slides towards one neighbour and
    then the other, and its corner is cut. A vertex is not begun unless ``TESTS_OF_A_PULL`` of
    ``tests_max`` are left. Returns (path, index of the vertex to go on from, number of tests).
    """
    space, islands = borrowed(space), borrowed(islands)
    tests = 0
    while k < len(points) - 1 and tests + TESTS_OF_A_PULL <= tests_max:
        if _may_join(space, islands, points, k - 1, k + 1):
            points = _replaced(points, k, points[:0])
            tests += 1
            continue
        before, x, after = points[k - 1], points[k], points[k + 1]
        for ahead in (False, True):
            kept = x.copy()
            if ahead:
                _slide(space, islands, after, x, before, margin)
            else:
                _slide(space, islands, before, x, after, margin)
            if not (segment_is_free(space, before, x) and segment_is_free(space, x, after)):
                copy_into(x, kept)
        corner = _cut(space, islands, before, x, after, margin)
        tests += TESTS_OF_A_PULL
        points = _replaced(points, k, corner)
        k += len(corner)
    return points, k, tests


@kernel
def _slide(space, islands, a, x, b, margin):
    """
    Slide ``x`` (dim,), in place, towards ``a`` as long as the segment from it to ``b`` is free.

    It stops ``margin`` before the point where that segment is blocked or passes an island.
    """
    free, blocked = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = (free + blocked) / 2.0
        y = x + middle * (a - x)
        if segment_is_free(space, y, b) and loop_signature(islands, y, x, b) == 0:
            free = middle
        else:
            blocked = middle
    length = norm(a - x)
    if free * length > margin:
        x += (free - margin / length) * (a - x)


@kernel
def _cut(space, islands, a, x, b, margin):
    """
    Return two vertices (2, dim) that cut the corner a-x-b as far as is free, or ``x`` (1, dim).

    It is ``x`` where the cut would shorten the two segments by less than ``LEAST_CUT`` of their
    length or one of the new segments is not free.
    """
    free, blocked = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = (free + blocked) / 2.0
        first, second = x + middle * (a - x), x + middle * (b - x)
        if (
            segment_is_free(space, first, second)
            and loop_signature(islands, first, x, second) == 0
        ):
            free = middle
        else:
            blocked = middle
    corner = np.empty((2, len(x)))
    around = norm(x - a) + norm(b - x)
    free = max(free - margin / around, 0.0)
    for i in range(len(x)):
        corner[0, i], corner[1, i] = x[i] + free * (a[i] - x[i]), x[i] + free * (b[i] - x[i])
    gain = free * around - norm(corner[1] - corner[0])
    if (
        gain > LEAST_CUT * around
        and segment_is_free(space, a, corner[0])
        and segment_is_free(space, corner[0], corner[1])
        and segment_is_free(space, corner[1], b)
    ):
        return corner
    copy_into(corner[0], x)
    return corner[:1]


@kernel
def _replaced(points, k, others):
    """Return the path with vertex ``k`` replaced by ``others`` (n, dim)."""
    after = k + 1
    n = k + len(others)
    path = np.empty((n + len(points) - after, points.shape[1]))
    copy_rows(path[:k], points)
    copy_rows(path[k:n], others)
    copy_rows(path[n:], points[after:])
    return path


@kernel
def _join_two(space, islands, points, rng):
    """
    Try to join two random points, uniform along the length of a path (m, dim); return the path.

    They are joined where all new segments are free and the homology class stays the same.
    """
    along = _lengths_along(points)
    s, t = along[-1] * uniform(rng), along[-1] * uniform(rng)
    i, j = _segment_at(along, min(s, t)), _segment_at(along, max(s, t))
    if i == j:
        return points
    a, b = _point_on(points, along, i, min(s, t)), _point_on(points, along, j, max(s, t))
    if (
        segment_is_free(space, points[i], a)
        and segment_is_free(space, a, b)
        and segment_is_free(space, b, points[j + 1])
    ):
        joined = _joined(points, i, a, b, j + 1)
        if signature(islands, joined) == signature(islands, points):
            return joined
    return points


@kernel
def _lengths_along(points):
    """Return the lengths (m,) of a path (m, dim) from its start to each of its vertices."""
    along = np.zeros(len(points))
    for k in range(1, len(points)):
        along[k] = along[k - 1] + norm(points[k] - points[k - 1])
    return along


@kernel
def _segment_at(along, s):
    """Return the index of the segment at length ``s``, given ``_lengths_along`` of the path."""
    k = 0
    while k < len(along) - 2 and along[k + 1] <= s:
        k += 1
    return k


@kernel
def _point_on(points, along, k, s):
    """Return the point (dim,) on segment ``k`` at length ``s`` from the start of the path."""
    length = along[k + 1] - along[k]
    fraction = (s - along[k]) / length if length > 0.0 else 0.0
    return points[k] + fraction * (points[k + 1] - points[k])


@kernel
def _joined(points, i, a, b, j):
    """Return the path with the vertices between ``i`` and ``j`` replaced by ``a`` and ``b``."""
    kept = i + 1
    shorter = np.empty((kept + 2 + len(points) - j, points.shape[1]))
    copy_rows(shorter[:kept], points)
    copy_into(shorter[kept], a)
    copy_into(shorter[kept + 1], b)
    tail = kept + 2
    copy_rows(shorter[tail:], points[j:])
    return shorter
