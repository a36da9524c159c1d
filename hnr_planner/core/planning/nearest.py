"""
Exact nearest neighbours of a growing set of points.

A tree of boxes: each node halves its box in the middle, along one axis after the other, and each
leaf holds a short list of points. Boxes halve whatever the order in which points come, so that a
corridor explored from one end to the other gives no deeper a tree than points at random; insertion
and query cost like the logarithm of the number of points.
"""

from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels import kernel
from hnr_planner.core.planning.search import NONE
import numpy as np
from numpy.typing import NDArray

LEAF_SIZE = 8
#: Points nearer to each other than a box of this depth stay in one leaf.
DEPTH_MAX = 100


class BoxTree(NamedTuple):
    """
    Points in leaves of a tree of boxes.

    Attributes
    ----------
    lower, upper : (dim,)
        The box of the root, node 0.
    child : (nodes, 2) int32
        Lower and upper half; NONE in a leaf.
    split : (nodes,)
        Where the node is halved.
    first : (nodes,) int32
        First point of a leaf's list; NONE when it is empty.
    following : (points,) int32
        Next point of the list.
    size : (nodes,) int32
        Points in a leaf.
    n_nodes : (1,) int64
        Nodes in use.

    """

    lower: Floats
    upper: Floats
    child: NDArray[np.int32]
    split: Floats
    first: NDArray[np.int32]
    following: NDArray[np.int32]
    size: NDArray[np.int32]
    n_nodes: NDArray[np.int64]


def empty_box_tree(lower: Floats, upper: Floats, capacity: int) -> BoxTree:
    """Return a tree without points that has room for ``capacity`` of them."""
    nodes = 2 * capacity + 1
    return BoxTree(
        lower=lower,
        upper=upper,
        child=np.full((nodes, 2), NONE, dtype=np.int32),
        split=np.zeros(nodes),
        first=np.full(nodes, NONE, dtype=np.int32),
        following=np.full(capacity, NONE, dtype=np.int32),
        size=np.zeros(nodes, dtype=np.int32),
        n_nodes=np.ones(1, dtype=np.int64),
    )


def grown(tree: BoxTree, capacity: int) -> BoxTree:
    """Return the same tree with room for ``capacity`` points."""
    larger = empty_box_tree(tree.lower, tree.upper, capacity)
    for name in ('child', 'split', 'first', 'following', 'size', 'n_nodes'):
        old = getattr(tree, name)
        getattr(larger, name)[: len(old)] = old
    return larger


@kernel
def insert(tree, points, k):
    """Add point ``k`` of ``points`` (n, dim) to the tree; points are added in their order."""
    dim = points.shape[1]
    lower, upper = tree.lower.copy(), tree.upper.copy()
    node, depth = 0, 0
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
    tree.following[k] = tree.first[leaf]
    tree.first[leaf] = k
    tree.size[leaf] += 1


@kernel
def _halve(tree, points, leaf, axis, middle):
    """Make ``leaf`` an inner node and hand its points to its two halves."""
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
def nearest(tree, points, x):
    """Index of the point nearest to ``x``; the one added first where several are as near."""
    dim = points.shape[1]
    # Halves still to visit: node, depth, and squared distance from x to the plane before it.
    nodes = np.empty(DEPTH_MAX + 2, dtype=np.int64)
    depths = np.empty(DEPTH_MAX + 2, dtype=np.int64)
    apart = np.empty(DEPTH_MAX + 2)
    nodes[0], depths[0], apart[0] = 0, 0, 0.0
    waiting = 1
    best, best_squared = NONE, np.inf
    while waiting > 0:
        waiting -= 1
        node, depth = nodes[waiting], depths[waiting]
        if apart[waiting] > best_squared:
            continue
        while tree.child[node, 0] != NONE:
            offset = x[depth % dim] - tree.split[node]
            near = 0 if offset < 0.0 else 1
            depth += 1
            nodes[waiting], depths[waiting] = tree.child[node, 1 - near], depth
            apart[waiting] = offset * offset
            waiting += 1
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
