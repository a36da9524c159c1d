"""
Trees of boxes: exact nearest neighbours of growing sets of points.

Each node halves its box in the middle, along one axis after the other, and each leaf holds a short
list of points. The boxes do not depend on the order of the points, so that a corridor explored
from one end to the other gives no deeper a tree than points at random; the cost of insertion and
query is logarithmic in the number of points. Several sets may share the arrays of one tree, each
with its own root: compiled code pays for every array that is an argument.
"""

from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.trees import NONE
import numpy as np
from numpy.typing import NDArray

#: Largest number of points in a leaf; a leaf with more is halved, unless it is as deep as allowed.
LEAF_SIZE = 8
#: Depth of the deepest leaves, which are not halved however many points they hold.
DEPTH_MAX = 100


class BoxTree(NamedTuple):
    """
    Sets of points in trees of boxes, one tree for each root, in common arrays.

    Attributes
    ----------
    lower, upper : (dim,)
        Opposite corners of the box of every root. The roots are the first nodes.
    child : (nodes, 2) int32
        Indices of the nodes of the lower and the upper half of each node; NONE (-1) in a leaf.
    split : (nodes,)
        Coordinate at which each node is halved, along axis depth modulo dim.
    first : (nodes,) int32
        Index of the first point in each leaf's list; NONE for an empty list.
    following : (points,) int32
        Index of the point after each point in its leaf's list; NONE after the last one.
    size : (nodes,) int32
        Number of points in each leaf.
    n_nodes : (1,) int64
        Number of nodes in use.
    waiting : (DEPTH_MAX + 2, 3)
        Work array of a query, its stack of halves still to visit: node, depth, and squared
        distance to the plane in front of it. So a tree can serve one query at a time only.

    """

    lower: Floats
    upper: Floats
    child: NDArray[np.int32]
    split: Floats
    first: NDArray[np.int32]
    following: NDArray[np.int32]
    size: NDArray[np.int32]
    n_nodes: NDArray[np.int64]
    waiting: Floats


def empty_box_tree(lower: Floats, upper: Floats, capacity: int, n_roots: int = 1) -> BoxTree:
    """Return ``n_roots`` trees without points, with a common capacity of ``capacity`` points."""
    nodes = 2 * capacity + n_roots
    return BoxTree(
        lower=lower,
        upper=upper,
        child=np.full((nodes, 2), NONE, dtype=np.int32),
        split=np.zeros(nodes),
        first=np.full(nodes, NONE, dtype=np.int32),
        following=np.full(capacity, NONE, dtype=np.int32),
        size=np.zeros(nodes, dtype=np.int32),
        n_nodes=np.full(1, n_roots, dtype=np.int64),
        waiting=np.zeros((DEPTH_MAX + 2, 3)),
    )


def grown(tree: BoxTree, capacity: int) -> BoxTree:
    """Return a copy of the trees with a larger common capacity of ``capacity`` points."""
    n_roots = len(tree.child) - 2 * len(tree.following)
    larger = empty_box_tree(tree.lower, tree.upper, capacity, n_roots)
    for name in ('child', 'split', 'first', 'following', 'size', 'n_nodes'):
        old = getattr(tree, name)
        getattr(larger, name)[: len(old)] = old
    return larger


@kernel
def insert(tree, points, k, root=0):
    """Add point ``k`` of ``points`` (n, dim) to the tree whose root is node ``root``."""
    dim = points.shape[1]
    lower, upper = tree.lower.copy(), tree.upper.copy()
    node, depth = root, 0
    while tree.child[node, 0] != NONE:
        axis = depth % dim
        if points[k, axis] < tree.split[node]:
            upper[axis] = tree.split[node]
            node = tree.child[node, 0]
        else:
            lower[axis] = tree.split[node]
            node = tree.child[node, 1]
        depth += 1
    _push(tree, node, k)
    if tree.size[node] > LEAF_SIZE and depth < DEPTH_MAX:
        axis = depth % dim
        _halve(tree, points, node, axis, (lower[axis] + upper[axis]) / 2.0)


@kernel
def _push(tree, leaf, k):
    """Insert point ``k`` at the head of a leaf's list."""
    tree.following[k] = tree.first[leaf]
    tree.first[leaf] = k
    tree.size[leaf] += 1


@kernel
def _halve(tree, points, leaf, axis, middle):
    """Turn ``leaf`` into an inner node halved at coordinate ``middle``; move its points down."""
    new = tree.n_nodes[0]
    tree.n_nodes[0] += 2
    k = tree.first[leaf]
    tree.child[leaf, 0], tree.child[leaf, 1] = new, new + 1
    tree.split[leaf] = middle
    while k != NONE:
        following = tree.following[k]
        _push(tree, new if points[k, axis] < middle else new + 1, k)
        k = following


@kernel
def nearest(tree, points, x, root=0):
    """
    Return the index in ``points`` (n, dim) of the point nearest to ``x`` (dim,) in a root's tree.

    Of several at the same distance it is the lowest index; it is NONE (-1) in an empty tree.
    """
    dim = points.shape[1]
    waiting = tree.waiting
    waiting[0, 0], waiting[0, 1], waiting[0, 2] = root, 0.0, 0.0
    n_waiting = 1
    best, best_squared = NONE, np.inf
    while n_waiting > 0:
        n_waiting -= 1
        if waiting[n_waiting, 2] > best_squared:
            continue
        node, depth = int(waiting[n_waiting, 0]), int(waiting[n_waiting, 1])
        while tree.child[node, 0] != NONE:
            offset = x[depth % dim] - tree.split[node]
            near = 0 if offset < 0.0 else 1
            depth += 1
            waiting[n_waiting, 0], waiting[n_waiting, 1] = tree.child[node, 1 - near], depth
            waiting[n_waiting, 2] = offset * offset
            n_waiting += 1
            node = tree.child[node, near]
        k = tree.first[node]
        while k != NONE:
            squared = 0.0
            for i in range(dim):
                squared += (points[k, i] - x[i]) ** 2
            if squared < best_squared or (squared == best_squared and k < best):
                best, best_squared = k, squared
            k = tree.following[k]
    return best
