"""
Graph of points with free segments between them, and its shortest paths by homology class.

Dijkstra's algorithm over pairs of a point and a signature, as in Bhattacharya, Likhachev and Kumar
(2012), with the distance to the goal as the heuristic of A*. The beginning of a path of one of the
k shortest classes is of one of the k shortest classes to its end, since the rest of the path could
continue the others: so each point keeps k signatures, which bounds the work. Paths that cross
themselves are left out; they go round an island and return.
"""

from heapq import heappop, heappush
import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.lengths import distance
from hnr_planner.core.planning.homology import crossings, Islands
from hnr_planner.core.spaces.primitives import segment_is_free
from hnr_planner.core.trees import branch, NONE
import numpy as np
from numpy.typing import NDArray

#: Indices of the nodes at the ends of the request.
START, GOAL = 0, 1


class ClassGraph(NamedTuple):
    """
    A graph of points, with an edge between two points where their segment is free.

    Attributes
    ----------
    points : (n, 2)
        The nodes, kernel frame, start and goal first.
    first : (n + 1,) int64
        Index in ``neighbours`` where each node's neighbours begin; the last entry is their number.
    neighbours : (edges,) int64
        Indices in ``points`` of the neighbours of all nodes, node by node.

    """

    points: Floats
    first: NDArray[np.int64]
    neighbours: NDArray[np.int64]


def class_graph(points: Floats, edges: NDArray[np.int64]) -> ClassGraph:
    """Return the graph with ``edges`` (k, 2) of indices in ``points``, each in both directions."""
    n = len(points)
    a, b = edges.T
    both = np.unique(np.concatenate([a * n + b, b * n + a]))
    first = np.searchsorted(both, n * np.arange(n + 1))
    return ClassGraph(points, first, both % n)


def shortest_classes(graph: ClassGraph, islands: Islands, n_classes: int) -> list[Floats]:
    """
    Return the shortest path (m, 2) of each of the ``n_classes`` shortest homology classes.

    The paths run from start to goal of the graph without crossing themselves, the shortest first.
    There are fewer where the search finds no more classes.
    """
    ends, nodes, parents = _search(graph, islands, n_classes)
    return [branch(graph.points[nodes], parents, end) for end in ends]


@kernel
def near_edges(space, points, rows, n_near):
    """
    Return the free edges (k, 2) from the points in ``rows`` to their ``n_near`` nearest points.

    Edges and ``rows`` are indices in ``points`` (n, 2). An edge is free if its segment is.
    """
    edges, n_edges = np.empty((len(rows) * n_near, 2), dtype=np.int64), 0
    nearest, squared = np.empty(n_near, dtype=np.int64), np.empty(n_near)
    for i in rows:
        for k in range(n_near):
            nearest[k], squared[k] = NONE, math.inf
        for j in range(len(points)):
            if j != i:
                distance_squared = (points[j, 0] - points[i, 0]) ** 2 + (
                    points[j, 1] - points[i, 1]
                ) ** 2
                _insert(nearest, squared, j, distance_squared)
        for j in nearest:
            if j != NONE and segment_is_free(space, points[i], points[j]):
                edges[n_edges, 0], edges[n_edges, 1] = i, j
                n_edges += 1
    return edges[:n_edges]


@kernel
def _insert(nearest, squared, j, distance_squared):
    """
    Insert ``j`` into the list of nearest points, ordered by distance, if it is near enough.

    ``squared`` holds the squared distances of the points in ``nearest``.
    """
    k = len(nearest)
    while k > 0 and distance_squared < squared[k - 1]:
        k -= 1
        if k + 1 < len(nearest):
            nearest[k + 1], squared[k + 1] = nearest[k], squared[k]
    if k < len(nearest):
        nearest[k], squared[k] = j, distance_squared


@kernel
def _search(graph, islands, n_classes):
    """
    Search from start to goal; return (labels at the goal, node of each label, parent label).

    A label is a path from the start to a node, of its own signature. The labels at the goal are
    those of the at most ``n_classes`` shortest classes, in the order of their lengths.
    """
    points, rows = graph.points, 1 + n_classes * len(graph.neighbours)
    nodes, parents = np.empty(rows, dtype=np.int64), np.empty(rows, dtype=np.int64)
    lengths, signatures = np.empty(rows), np.empty(rows, dtype=np.int64)
    nodes[0], parents[0], lengths[0], signatures[0] = START, NONE, 0.0, 0
    known = np.empty((len(points), n_classes), dtype=np.int64)
    n_known = np.zeros(len(points), dtype=np.int64)
    ends, waiting, n_labels = np.empty(n_classes, dtype=np.int64), [(0.0, 0)], 1
    while len(waiting) > 0 and n_known[GOAL] < n_classes:
        _, label = heappop(waiting)
        node = nodes[label]
        if not _is_new(known, n_known, node, signatures[label]):
            continue
        if node == GOAL:
            ends[n_known[GOAL]] = label
        known[node, n_known[node]] = signatures[label]
        n_known[node] += 1
        for k in range(graph.first[node], graph.first[node + 1]):
            near = graph.neighbours[k]
            passed = signatures[label] + crossings(islands, points[node], points[near])
            is_new = _is_new(known, n_known, near, passed)
            if is_new and not _crosses_itself(points, nodes, parents, label, near):
                nodes[n_labels], parents[n_labels] = near, label
                lengths[n_labels] = lengths[label] + distance(points[node], points[near])
                signatures[n_labels] = passed
                left = distance(points[near], points[GOAL])
                heappush(waiting, (lengths[n_labels] + left, n_labels))
                n_labels += 1
    found = n_known[GOAL]
    return ends[:found], nodes[:n_labels], parents[:n_labels]


@kernel
def _is_new(known, n_known, node, signature):
    """Return whether a node lacks ``signature`` and may get one more in its row of ``known``."""
    for k in range(n_known[node]):
        if known[node, k] == signature:
            return False
    return n_known[node] < known.shape[1]


@kernel
def _crosses_itself(points, nodes, parents, label, near):
    """Return whether the segment from a label's node to ``near`` crosses the path to the label."""
    node, later = nodes[label], parents[label]
    if later == NONE:
        return False
    earlier = parents[later]
    while earlier != NONE:
        a, b = points[nodes[earlier]], points[nodes[later]]
        if nodes[earlier] == near or _cross(a, b, points[node], points[near]):
            return True
        later, earlier = earlier, parents[earlier]
    return nodes[later] == near


@kernel
def is_simple(path):
    """Return whether no two segments of a path (m, 2) cross in a point inside both."""
    for j in range(1, len(path)):
        for i in range(1, j - 1):
            if _cross(path[i - 1], path[i], path[j - 1], path[j]):
                return False
    return True


@kernel
def _cross(a, b, c, d):
    """Return whether the segments a-b and c-d cross in a point inside both."""
    return _side(a, b, c) * _side(a, b, d) < 0.0 and _side(c, d, a) * _side(c, d, b) < 0.0


@kernel
def _side(a, b, x):
    """Return a number that is positive when ``x`` is to the left of the line from a to b."""
    return (b[0] - a[0]) * (x[1] - a[1]) - (b[1] - a[1]) * (x[0] - a[0])
