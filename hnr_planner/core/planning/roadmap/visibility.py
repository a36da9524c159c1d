"""
Which points see each other, and the shortest ways along what they see.

Everything is mended rather than made: a pair is looked at only when it has to be, and of a table
of shortest ways only what lost an edge or has a new one is searched again. To make it is to mend
one in which nothing is known.
"""

import heapq
import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.primitives import segment_is_free
from hnr_planner.core.trees import NONE
import numpy as np
from numpy.typing import NDArray

#: What is known of a pair of points: it does not see each other, it does, or it has to be asked.
HIDDEN, SEEN, ASK = 0, 1, 2

Sights = NDArray[np.uint8]


@kernel
def look(space, points, others, sights):
    """
    Answer for all pairs of ``points`` (k, dim) and ``others`` (m, dim) that ask, in ``sights``.

    A sight has to be free from either end, so that a way may be walked both ways.
    """
    space, points, others = borrowed(space), borrowed(points), borrowed(others)
    for i in range(len(points)):
        for j in range(len(others)):
            if sights[i, j] == ASK:
                seen = segment_is_free(space, points[i], others[j]) and segment_is_free(
                    space, others[j], points[i]
                )
                sights[i, j] = SEEN if seen else HIDDEN


@kernel
def ask_through(lower, upper, points, others, sights):
    """Let every hidden pair ask whose segment comes through the box from lower to upper."""
    for i in range(len(points)):
        for j in range(len(others)):
            if sights[i, j] == HIDDEN and _crosses(points[i], others[j], lower, upper):
                sights[i, j] = ASK


@kernel
def _crosses(a, b, lower, upper):
    """Say whether the segment a-b meets a box: the parts of it inside all slabs overlap."""
    first, last = 0.0, 1.0
    for i in range(len(a)):
        d = b[i] - a[i]
        if d == 0.0:
            if not lower[i] <= a[i] <= upper[i]:
                return False
        else:
            s, t = (lower[i] - a[i]) / d, (upper[i] - a[i]) / d
            first, last = max(first, min(s, t)), min(last, max(s, t))
    return first <= last


class Edges(NamedTuple):
    """
    What points see, point by point.

    Attributes
    ----------
    first : (n + 1,) int64
        Where the edges of each point begin; the last entry is their number.
    to : (edges,) int64
        The point that each leads to.
    length : (edges,) float32
        How far away that is.

    """

    first: NDArray[np.int64]
    to: NDArray[np.int64]
    length: NDArray[np.float32]


def edges_of(points: Floats, others: Floats, sights: Sights) -> Edges:
    """Return the edges from ``points`` (k, dim) to those of ``others`` (m, dim) that they see."""
    start, end = np.nonzero(sights == SEEN)
    return Edges(
        first=np.searchsorted(start, np.arange(len(points) + 1)),
        to=end,
        length=np.linalg.norm(others[end] - points[start], axis=1).astype(np.float32),
    )


class Ways(NamedTuple):
    """
    The shortest ways between all nodes of a graph.

    Attributes
    ----------
    distance : (n, n) float32
        Length of the way from the first to the second; inf where there is none.
    previous : (n, n) int16
        The node before the second on that way; NONE where there is none, and at the first itself.

    """

    distance: NDArray[np.float32]
    previous: NDArray[np.int16]


def no_ways(n_nodes: int) -> Ways:
    """Return the ways from each node to itself, and no other."""
    distance = np.full((n_nodes, n_nodes), np.inf, dtype=np.float32)
    np.fill_diagonal(distance, 0.0)
    return Ways(distance, np.full((n_nodes, n_nodes), NONE, dtype=np.int16))


@kernel
def mend(ways, rows, edges, sights, new, new_length):
    """
    Make the ways from the nodes of ``rows`` shortest again where edges have come or gone.

    Dijkstra's algorithm (1959), which begins where known ways meet nodes that have lost theirs,
    and where one of the ``new`` edges (k, 2), of ``new_length`` (k,), makes a way shorter.
    """
    ways, edges, sights = borrowed(ways), borrowed(edges), borrowed(sights)
    n_nodes = len(sights)
    sound, waits = np.empty(n_nodes, dtype=np.int8), np.empty(n_nodes, dtype=np.bool_)
    trail = np.empty(n_nodes, dtype=np.int64)
    for row in rows:
        distance, previous = ways.distance[row], ways.previous[row]
        _tell_sound(row, previous, sights, sound, trail)
        waits[:] = False
        for node in range(n_nodes):
            if sound[node] == 0:
                distance[node], previous[node] = math.inf, NONE
                for edge in range(edges.first[node], edges.first[node + 1]):
                    waits[edges.to[edge]] = True
        for k in range(len(new)):
            a, b = new[k]
            waits[a] = waits[a] or distance[a] + new_length[k] < distance[b]
        waiting = [(distance[k], k) for k in range(n_nodes) if waits[k] and sound[k] == 1]
        heapq.heapify(waiting)
        while waiting:
            length, node = heapq.heappop(waiting)
            if length > distance[node]:
                continue
            for edge in range(edges.first[node], edges.first[node + 1]):
                end, further = edges.to[edge], length + edges.length[edge]
                if further < distance[end]:
                    distance[end], previous[end] = further, node
                    heapq.heappush(waiting, (further, end))


@kernel
def _tell_sound(root, previous, sights, sound, trail):
    """Write 1 for nodes whose way from the root still has all its edges, else 0."""
    unknown = -1
    sound[:] = unknown
    sound[root] = 1
    for node in range(len(sound)):
        n, k = 0, node
        while sound[k] == unknown:
            trail[n] = k
            n += 1
            before = previous[k]
            if before == NONE or sights[before, k] != SEEN:
                sound[k] = 0
            else:
                k = before
        for i in range(n):
            sound[trail[i]] = sound[k]
