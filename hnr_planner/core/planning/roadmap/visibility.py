"""
Visibility between points, and the shortest paths along it.

After a change both are repaired instead of recomputed: a pair of points is tested only where its
visibility is unknown, and shortest paths are searched again only where they lost an edge or may
use a new one. A table is built by repairing an empty one.
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

#: Visibility of a pair of points: blocked, free, or still to be tested.
HIDDEN, VISIBLE, UNKNOWN = 0, 1, 2

Visibility = NDArray[np.uint8]


@kernel
def resolve(space, points, others, visibility):
    """
    Test the pairs of ``points`` (k, dim) and ``others`` (m, dim) whose visibility is unknown.

    ``visibility`` (k, m) is updated in place. A pair is visible if its segment is free when tested
    from either end, so that a path over it is free in both directions.
    """
    space, points, others = borrowed(space), borrowed(points), borrowed(others)
    for i in range(len(points)):
        for j in range(len(others)):
            if visibility[i, j] == UNKNOWN:
                visible = segment_is_free(space, points[i], others[j]) and segment_is_free(
                    space, others[j], points[i]
                )
                visibility[i, j] = VISIBLE if visible else HIDDEN


@kernel
def mark_unknown_through(lower, upper, points, others, visibility):
    """
    Mark hidden pairs as UNKNOWN whose segment meets the box from ``lower`` to ``upper`` (dim,).

    Pairs are of ``points`` (k, dim) and ``others`` (m, dim); ``visibility`` (k, m) is updated.
    """
    for i in range(len(points)):
        for j in range(len(others)):
            if visibility[i, j] == HIDDEN and _crosses(points[i], others[j], lower, upper):
                visibility[i, j] = UNKNOWN


@kernel
def _crosses(a, b, lower, upper):
    """Return whether the segment a-b meets a box: its intervals inside the slabs overlap."""
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
    Edges from points to the points visible from them.

    Attributes
    ----------
    first : (n + 1,) int64
        Index in ``to`` of the first edge of each point; the last entry is the number of edges.
    to : (edges,) int64
        Index of the end point of each edge among the points to which the edges lead.
    length : (edges,) float32
        Length of each edge, kernel frame.

    """

    first: NDArray[np.int64]
    to: NDArray[np.int64]
    length: NDArray[np.float32]


def edges_of(points: Floats, others: Floats, visibility: Visibility) -> Edges:
    """Return the edges from ``points`` (k, dim) to the visible ones of ``others`` (m, dim)."""
    start, end = np.nonzero(visibility == VISIBLE)
    return Edges(
        first=np.searchsorted(start, np.arange(len(points) + 1)),
        to=end,
        length=np.linalg.norm(others[end] - points[start], axis=1).astype(np.float32),
    )


class ShortestPaths(NamedTuple):
    """
    Shortest paths between all nodes of a graph.

    Attributes
    ----------
    distance : (n, n) float32
        Length of the path from the row's node to the column's node, kernel frame; inf where there
        is no path.
    previous : (n, n) int16
        Index of the node before the column's node on that path; NONE (-1) where there is no path,
        and on the diagonal.

    """

    distance: NDArray[np.float32]
    previous: NDArray[np.int16]


def empty_paths(n_nodes: int) -> ShortestPaths:
    """Return a table with the paths from each node to itself only."""
    distance = np.full((n_nodes, n_nodes), np.inf, dtype=np.float32)
    np.fill_diagonal(distance, 0.0)
    return ShortestPaths(distance, np.full((n_nodes, n_nodes), NONE, dtype=np.int16))


@kernel
def repair(paths, rows, edges, visibility, new, new_length):
    """
    Repair the shortest paths from the nodes of ``rows`` after edges were added or removed.

    Dijkstra's algorithm (1959), started at the intact neighbours of nodes whose path lost an edge,
    and at those of the ``new`` edges (k, 2), of ``new_length`` (k,), that shorten a path.
    """
    paths, edges, visibility = borrowed(paths), borrowed(edges), borrowed(visibility)
    n_nodes = len(visibility)
    intact, waits = np.empty(n_nodes, dtype=np.int8), np.empty(n_nodes, dtype=np.bool_)
    trail = np.empty(n_nodes, dtype=np.int64)
    for row in rows:
        distance, previous = paths.distance[row], paths.previous[row]
        _mark_intact(row, previous, visibility, intact, trail)
        for k in range(n_nodes):
            waits[k] = False
        for node in range(n_nodes):
            if intact[node] == 0:
                distance[node], previous[node] = math.inf, NONE
                for edge in range(edges.first[node], edges.first[node + 1]):
                    waits[edges.to[edge]] = True
        for k in range(len(new)):
            a, b = new[k]
            waits[a] = waits[a] or distance[a] + new_length[k] < distance[b]
        waiting = [(distance[k], k) for k in range(n_nodes) if waits[k] and intact[k] == 1]
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
def _mark_intact(root, previous, visibility, intact, trail):
    """
    Write 1 to ``intact`` (n,) for nodes whose path from node ``root`` has all its edges, else 0.

    ``previous`` (n,) are the nodes before each node; ``trail`` (n,) is a work array.
    """
    unknown = -1
    for k in range(len(intact)):
        intact[k] = unknown
    intact[root] = 1
    for node in range(len(intact)):
        n, k = 0, node
        while intact[k] == unknown:
            trail[n] = k
            n += 1
            before = previous[k]
            if before == NONE or visibility[before, k] != VISIBLE:
                intact[k] = 0
            else:
                k = before
        for i in range(n):
            intact[trail[i]] = intact[k]
