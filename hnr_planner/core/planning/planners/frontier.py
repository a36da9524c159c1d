"""
Where a tree should grow: from the newest vertex of the part of it that was used least.

The plane of the first two coordinates is divided into square bins. Each tree knows the bins that
hold a vertex of it, by how often they were chosen: the least used come first, and of these the
newest. So a tree runs ahead where it has just got to, and comes back to what it left behind.
"""

import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import uniform
from hnr_planner.core.trees import NONE
import numpy as np
from numpy.typing import NDArray

#: Most bins along the longer side of the bounds, so that a search on a large map starts at once.
BINS_MAX = 128
#: Side of a bin in units of the typical clearance; measured on building maps and spirals.
SIDE = 1.75
#: Choices counted apart: a bin chosen more often stays with those chosen this often.
USES_MAX = 63
#: Part of the choices that any bin may get, so that no part of a tree is left for ever.
ANY = 0.07


class Frontier(NamedTuple):
    """
    Bins of two trees, index ``tree`` first.

    Attributes
    ----------
    lower : (dim,)
        Corner of the bounds, where the bins begin.
    side : float
        Side of a bin.
    columns : int
        Bins in a row, with a rim of empty bins on both sides.
    newest : (2, bins) int32
        Newest vertex in a bin, NONE in an empty one.
    first : (2, USES_MAX + 1) int32
        First of the bins used so many times.
    following : (2, bins) int32
        The next bin used as often.
    filled : (2, bins) int32
        The bins that are not empty, in the order in which they were filled.
    n_filled : (2,) int64
        How many those are.

    """

    lower: Floats
    side: float
    columns: int
    newest: NDArray[np.int32]
    first: NDArray[np.int32]
    following: NDArray[np.int32]
    filled: NDArray[np.int32]
    n_filled: NDArray[np.int64]


@kernel
def empty_frontier(lower, upper, clearance):
    """Return the frontier of two trees without vertices, for a space of this typical clearance."""
    width, height = upper[0] - lower[0], upper[1] - lower[1] if len(lower) > 1 else 0.0
    side = max(SIDE * clearance, max(width, height) / BINS_MAX)
    columns, rows = int(width / side) + 3, int(height / side) + 3
    shape = (2, rows * columns)
    return Frontier(
        lower,
        side,
        columns,
        np.full(shape, NONE, dtype=np.int32),
        np.full((2, USES_MAX + 1), NONE, dtype=np.int32),
        np.empty(shape, dtype=np.int32),
        np.empty(shape, dtype=np.int32),
        np.zeros(2, dtype=np.int64),
    )


@kernel
def bin_of(frontier, x):
    """Index of the bin that holds ``x`` (dim,)."""
    column = 1 + math.floor((x[0] - frontier.lower[0]) / frontier.side)
    row = 1 + math.floor((x[1] - frontier.lower[1]) / frontier.side) if len(x) > 1 else 1
    return row * frontier.columns + column


@kernel
def add_to_bin(frontier, tree, x, k):
    """Make vertex ``k`` at ``x`` the newest of its bin; return the bin."""
    at = bin_of(frontier, x)
    if frontier.newest[tree, at] == NONE:
        _put_first(frontier, tree, at, 0)
        frontier.filled[tree, frontier.n_filled[tree]] = at
        frontier.n_filled[tree] += 1
    frontier.newest[tree, at] = k
    return at


@kernel
def choose_vertex(frontier, tree, rng):
    """Choose the vertex of a tree to grow from."""
    if uniform(rng) < ANY:
        at = frontier.filled[tree, math.floor(frontier.n_filled[tree] * uniform(rng))]
        return frontier.newest[tree, at]
    uses = 0
    while frontier.first[tree, uses] == NONE:
        uses += 1
    at = frontier.first[tree, uses]
    frontier.first[tree, uses] = frontier.following[tree, at]
    _put_first(frontier, tree, at, min(uses + 1, USES_MAX))
    return frontier.newest[tree, at]


@kernel
def _put_first(frontier, tree, at, uses):
    frontier.following[tree, at] = frontier.first[tree, uses]
    frontier.first[tree, uses] = at
