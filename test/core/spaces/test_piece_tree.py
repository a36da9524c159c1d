"""A tree over convex pieces gives what the pieces give without it, to the last bit."""

from collections.abc import Iterator
import math
from typing import Any

from hnr_planner.core import BallSpace, BoxSpace, DifferenceSpace, UnionSpace
from hnr_planner.core.spaces.ball import BallData
from hnr_planner.core.spaces.box import BoxData
from hnr_planner.core.spaces.piece_tree import NONE, piece_tree, PieceTree
from hnr_planner.core.spaces.primitives import (
    contains,
    first_entry,
    first_exit,
    gap,
    line_touches,
    touches,
)
import numpy as np
from numpy.typing import NDArray
import pytest

pytestmark = pytest.mark.interpreted

#: Number of pieces of the sets below, and the largest gap between them that is closed.
N_PIECES, MAX_GAP = 24, 1e-9


def _rooms(rng: np.random.Generator, dim: int) -> BoxData:
    """Return boxes between the lines of a lattice of tenths, so that many abut or touch."""
    tenths = np.cumsum(np.full(12, 0.1))
    lower = rng.integers(0, 9, (N_PIECES, dim))
    sizes = rng.integers(1, 3, (N_PIECES, dim))
    # Of the sums of tenths and their products half differ by a rounding: gaps to be closed.
    return BoxData(tenths[lower], 0.1 * (lower + sizes + 1), MAX_GAP)


def _balls(rng: np.random.Generator, dim: int) -> BallData:
    """Return balls with whole radii around points with whole coordinates: many touch."""
    centres = rng.integers(0, 12, (N_PIECES, dim)).astype(float)
    return BallData(centres, rng.integers(1, 3, N_PIECES).astype(float), MAX_GAP)


def _chain(rng: np.random.Generator, dim: int) -> BoxData:
    """Return abutting boxes of one corridor, with gaps of at most ``MAX_GAP`` between them."""
    ends = np.cumsum(rng.uniform(0.1, 1.0, N_PIECES))
    lower, upper = np.zeros((N_PIECES, dim)), np.ones((N_PIECES, dim))
    lower[1:, 0], upper[:, 0] = ends[:-1], ends
    lower[1:, 0] += rng.choice(
        [0.0, 0.9 * MAX_GAP, 2.0 * MAX_GAP], N_PIECES - 1, p=[0.5, 0.4, 0.1]
    )
    return BoxData(lower, upper, MAX_GAP)


def _lines(rng: np.random.Generator, pieces: Any, count: int) -> Iterator[tuple[NDArray, NDArray]]:
    """Yield points and directions: at random, along axes, from one face or corner to another."""
    lower, upper = pieces.boxes
    least, most = lower.min(axis=0) - 1.0, upper.max(axis=0) + 1.0
    corners = np.concatenate([lower, upper])
    for k in range(count):
        x = rng.uniform(least, most)
        if k % 2 == 0:
            on_face = rng.random(len(x)) < 0.7
            x[on_face] = corners[rng.integers(len(corners))][on_face]
        u = rng.normal(size=len(x))
        if k % 3 == 0:
            u[rng.random(len(x)) < 0.6] = 0.0
            u[rng.integers(len(x))] = rng.choice([-1.0, 1.0, 1e-3])
        elif k % 3 == 1:
            u = corners[rng.integers(len(corners))] - x
        if u.any():
            yield x, u


def _results(space: Any, x: NDArray, u: NDArray) -> tuple:
    """Return what every primitive gives for one line."""
    return (
        contains.interpreted(space, x),
        touches.interpreted(space, x),
        *(first_exit.interpreted(space, x, u, t, h) for t in (0.0, 0.7) for h in (1.0, math.inf)),
        *(first_entry.interpreted(space, x, u, t) for t in (0.0, -2.0)),
        *gap.interpreted(space, x, u, -u),
        line_touches.interpreted(space, x, u, 1.0),
    )


@pytest.mark.parametrize(('kind', 'dim'), [(_rooms, 3), (_balls, 2), (_chain, 2)])
def test_every_primitive_is_the_same_to_the_last_bit(kind: Any, dim: int) -> None:
    """On lines along faces, through corners and over gaps too."""
    rng = np.random.default_rng(dim)
    pieces = kind(rng, dim)
    tree = piece_tree(pieces)
    met = 0
    for x, u in _lines(rng, pieces, 40):
        expected = _results(pieces, x, u)
        assert _results(tree, x, u) == expected
        met += expected[4] > 0.0
    assert met > 4


def test_the_nodes_are_linked_depth_first() -> None:
    """Each piece has one leaf, and the boxes of the nodes below lie in that of the node."""
    tree = piece_tree(_rooms(np.random.default_rng(2), 3))
    assert sorted(tree.piece[tree.piece != NONE]) == list(range(N_PIECES))
    assert (tree.after > np.arange(len(tree.after))).all()
    for node, after in enumerate(tree.after):
        assert (tree.lower[node] <= tree.lower[node:after]).all()
        assert (tree.upper[node] >= tree.upper[node:after]).all()
        assert (tree.piece[node] == NONE) == (after > node + 1)


def test_a_tree_is_made_of_many_pieces_that_do_not_fill_the_space() -> None:
    """Else the pieces are compiled without one."""
    boxes = [BoxSpace((k, 0.0), (k + 1.0, 1.0)) for k in range(24)]
    assert isinstance(UnionSpace(*boxes).data, PieceTree)
    assert isinstance(UnionSpace(*boxes[1:]).data, BoxData)
    floor = BoxSpace((0.0, 0.0), (len(boxes), 2.0))
    assert isinstance(DifferenceSpace(floor, *boxes).data.removed, PieceTree)
    rng = np.random.default_rng(0)
    crowd = [BallSpace(x, 2.0) for x in rng.uniform(0.0, 1.0, (128, 3))]
    assert isinstance(UnionSpace(*crowd).data, BallData)
