"""
Trees of boxes over many convex pieces: a line looks only at pieces whose boxes it meets.

Every node has a box around all pieces below it; each leaf holds one piece. The nodes are stored
depth first, and each names the node to go on with when its box is missed, so that a traversal
needs no stack. The boxes are enlarged by more than rounding, and each piece that is looked at
gives the number that it gives without a tree: the results are the same to the last bit.
"""

from collections.abc import Sequence
import math
from typing import Any, NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.spaces.convex import (
    count_pieces,
    first_exit_of_pieces,
    pack,
    piece_contains,
    piece_entry,
    piece_span,
    span_end_at,
)
from hnr_planner.core.spaces.curves.curve import first_exit_on_curve
from hnr_planner.core.spaces.curves.surfaces import (
    add_crossings,
    first_exit_between_surfaces,
    max_gap_of,
    own_max_gap,
)
from hnr_planner.core.spaces.primitives import (
    contains,
    entry_beyond,
    first_entry,
    first_exit,
    gap,
    line_touches,
    touches,
)
from hnr_planner.core.trees import NONE
import numpy as np
from numpy.typing import NDArray

#: Largest mean fraction of the boxes that one of them meets for which there is a tree, and number
#: of boxes from which that is estimated: a line among balls that fill the space meets most boxes.
CROWDED, N_BOXES = 0.5, 256
#: Rounding of the ends of an interval on a line, as a fraction of them.
ROUNDING = 1e-14


class PieceTree(NamedTuple):
    """
    Convex pieces in a tree of boxes, with the nodes depth first.

    Attributes
    ----------
    pieces : NamedTuple
        The convex pieces, of one type.
    lower, upper : (nodes, dim)
        Corners of each node's box, enlarged by ``max_gap``.
    after : (nodes,) int64
        Index of the first node after those below each node.
    piece : (nodes,) int64
        Index of the piece of each leaf; NONE (-1) for other nodes.
    max_gap : float
        Longest gap between two pieces that counts as free: a ray passes over it.

    """

    pieces: Any
    lower: Floats
    upper: Floats
    after: NDArray[np.int64]
    piece: NDArray[np.int64]
    max_gap: float


def pack_many(pieces: Sequence[Any], max_gap: float) -> Any:
    """
    Return the union of compiled convex spaces of one type, in a tree where that is worthwhile.

    Gaps up to ``max_gap`` between the pieces count as free. A tree is made of at least
    ``tree_from`` pieces, a number of their type, unless most of their boxes overlap.
    """
    packed = pack(pieces, max_gap)
    few = len(pieces) < packed.tree_from
    return packed if few or is_crowded(*packed.boxes) else piece_tree(packed)


def piece_tree(pieces: Any) -> PieceTree:
    """Return the union of compiled convex pieces of one type with a tree over their boxes."""
    lower, upper = pieces.boxes
    nodes = _nodes(lower - pieces.max_gap, upper + pieces.max_gap)
    return PieceTree(pieces, *nodes, pieces.max_gap)


def is_crowded(lower: Floats, upper: Floats) -> bool:
    """Return whether a box (n, dim) meets more than ``CROWDED`` of the others in the mean."""
    some = np.linspace(0, len(lower) - 1, min(len(lower), N_BOXES)).astype(int)
    met = [np.mean((lower <= upper[k]).all(1) & (upper >= lower[k]).all(1)) for k in some]
    return float(np.mean(met)) > CROWDED


def _nodes(
    lower: Floats, upper: Floats
) -> tuple[Floats, Floats, NDArray[np.int64], NDArray[np.int64]]:
    """
    Return the boxes and links of a tree over boxes (n, dim), as ``PieceTree`` has them.

    The boxes of a node are halved at the median of their centres, along the axis on which these
    extend farthest.
    """
    boxes: list[tuple[Floats, Floats]] = []
    after: list[int] = []
    piece: list[int] = []

    def add(below: NDArray[np.int64]) -> None:
        node = len(boxes)
        boxes.append((lower[below].min(axis=0), upper[below].max(axis=0)))
        after.append(0)
        piece.append(int(below[0]) if len(below) == 1 else NONE)
        if len(below) > 1:
            centres = lower[below] + upper[below]
            axis = int(np.argmax(np.ptp(centres, axis=0)))
            order = below[np.argsort(centres[:, axis], kind='stable')]
            middle = len(order) // 2
            add(order[:middle])
            add(order[middle:])
        after[node] = len(boxes)

    add(np.arange(len(lower)))
    lowers, uppers = (np.array(corners) for corners in zip(*boxes, strict=True))
    return lowers, uppers, np.array(after), np.array(piece)


first_exit.register(PieceTree)(first_exit_of_pieces)
first_exit_on_curve.register(PieceTree)(first_exit_between_surfaces)
max_gap_of.register(PieceTree)(own_max_gap)


@count_pieces.register(PieceTree)
@inlined
def _count_pieces(tree):
    """Return the number of pieces."""
    return count_pieces(tree.pieces)


@inlined
def _leaf_at(tree, node, x, u, s):
    """Return the first leaf from ``node`` on whose box holds ``x + s u``; the size for none."""
    while node < len(tree.piece):
        is_in = True
        for i in range(len(x)):
            y = x[i] + s * u[i]
            if y < tree.lower[node, i] or y > tree.upper[node, i]:
                is_in = False
                break
        if is_in and tree.piece[node] != NONE:
            return node
        node = node + 1 if is_in else tree.after[node]
    return node


@inlined
def _leaf_on(tree, node, x, inverse, first, last):
    """
    Return the first leaf from ``node`` on whose box the line meets; the number of nodes for none.

    ``inverse`` is 1 over the direction of the line (dim,), and only its section from ``first`` to
    ``last`` counts.
    """
    while node < len(tree.piece):
        near, far = first, last
        is_met = True
        for i in range(len(x)):
            below, above = tree.lower[node, i] - x[i], tree.upper[node, i] - x[i]
            if math.isinf(inverse[i]):
                is_met = below <= 0.0 <= above
            else:
                p, q = below * inverse[i], above * inverse[i]
                near, far = max(near, min(p, q)), min(far, max(p, q))
                is_met = near <= far or near - far <= ROUNDING * (abs(near) + abs(far))
            if not is_met:
                break
        if is_met and tree.piece[node] != NONE:
            return node
        node = node + 1 if is_met else tree.after[node]
    return node


@kernel
def _inverse(u):
    """Return 1 over each coordinate of a direction (dim,), inf for 0."""
    inverse = np.empty(len(u))
    for i in range(len(u)):
        inverse[i] = 1.0 / u[i] if u[i] != 0.0 else math.inf
    return inverse


@kernel
def _any_contains(tree, x, closed):
    """Return whether one of the pieces, open or closed, contains ``x`` (dim,)."""
    node = _leaf_at(tree, 0, x, x, 0.0)
    while node < len(tree.piece):
        if piece_contains(tree.pieces, tree.piece[node], x, closed):
            return True
        node = _leaf_at(tree, node + 1, x, x, 0.0)
    return False


@contains.register(PieceTree)
@kernel
def _contains(tree, x):
    """Return whether a piece contains ``x`` (dim,)."""
    return _any_contains(tree, x, False)


@touches.register(PieceTree)
@kernel
def _touches(tree, x):
    """Return whether the closure of a piece contains ``x`` (dim,)."""
    return _any_contains(tree, x, True)


@span_end_at.register(PieceTree)
@kernel
def _span_end_at(tree, x, u, s):
    """Return the largest end of the pieces that contain ``x + s u``; ``s`` where none does."""
    end = s
    node = _leaf_at(tree, 0, x, u, s)
    while node < len(tree.piece):
        lower, upper = piece_span(tree.pieces, tree.piece[node], x, u, False)
        if lower < s < upper:
            end = max(end, upper)
        node = _leaf_at(tree, node + 1, x, u, s)
    return end


@first_entry.register(PieceTree)
@kernel
def _first_entry(tree, x, u, t):
    """Return the first parameter from ``t`` on at which the line touches a piece."""
    inverse, first = _inverse(u), math.inf
    node = _leaf_on(tree, 0, x, inverse, t, first)
    while node < len(tree.piece):
        first = min(first, piece_entry(tree.pieces, tree.piece[node], x, u, t, first))
        node = _leaf_on(tree, node + 1, x, inverse, t, first)
    return first


@gap.register(PieceTree)
@kernel
def _gap(tree, x, u, back):
    """Return the interval (lower, upper) of the line around ``x`` that touches no piece."""
    inverse, lower, upper = _inverse(u), -math.inf, math.inf
    node = _leaf_on(tree, 0, x, inverse, lower, upper)
    while node < len(tree.piece):
        first, last = piece_span(tree.pieces, tree.piece[node], x, u, True)
        if first <= 0.0 <= last:
            return 0.0, 0.0
        if last < 0.0:
            lower = max(lower, last)
        elif first <= last:
            upper = min(upper, first)
        node = _leaf_on(tree, node + 1, x, inverse, lower, upper)
    return lower, upper


@line_touches.register(PieceTree)
@kernel
def _line_touches(tree, x, u, end):
    """Return whether the line touches a piece at a parameter from 0 to ``end``."""
    inverse = _inverse(u)
    node = _leaf_on(tree, 0, x, inverse, 0.0, end)
    while node < len(tree.piece):
        if piece_entry(tree.pieces, tree.piece[node], x, u, 0.0, end) < math.inf:
            return True
        node = _leaf_on(tree, node + 1, x, inverse, 0.0, end)
    return False


@entry_beyond.register(PieceTree)
@kernel
def _entry_beyond(tree, x, u, t, end):
    """Return the first entry into a piece up to ``end``, else ``end``; or a value up to ``t``."""
    inverse = _inverse(u)
    node = _leaf_on(tree, 0, x, inverse, 0.0, end)
    while node < len(tree.piece) and end > t:
        end = min(end, piece_entry(tree.pieces, tree.piece[node], x, u, 0.0, end))
        node = _leaf_on(tree, node + 1, x, inverse, 0.0, end)
    return end


@add_crossings.register(PieceTree)
@kernel
def _add_crossings(tree, curve, end, crossings, n):
    """
    Append to ``crossings``, from index ``n``, where a curve meets a surface of a piece.

    Return ``n`` plus the number of these parameters, also of those that do not fit.
    """
    return add_crossings(tree.pieces, curve, end, crossings, n)
