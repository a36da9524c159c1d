"""
Frontier of a tree: the newest vertex in the bin that was chosen least often.

The plane of the first two coordinates is divided into square bins. Each tree keeps lists of the
bins that hold one of its vertices, one list for each number of times that bins were chosen. A bin
chosen least often comes next, and of several the one that was put in its list last. So a tree
first explores from its newest vertices, and returns later to the regions that it left.
"""

import math
from typing import NamedTuple

from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import uniform
from hnr_planner.core.planning.bins import bin_of, Bins, make_bins
from hnr_planner.core.trees import NONE
import numpy as np
from numpy.typing import NDArray

#: Largest number of bins along the longer side, which limits the time to start a search.
BINS_MAX = 128
#: Side of a bin in units of the typical clearance; measured on building maps and spirals.
SIDE = 1.75
#: Largest number of choices counted: bins that were chosen more often share one list.
USES_MAX = 63
#: Fraction of choices made uniformly among all bins, so that every bin is chosen again.
ANY = 0.07


class Frontier(NamedTuple):
    """
    Bins of two trees; the first index of each array is the number of the tree.

    A bin counts as empty for a tree that has no vertex in it.

    Attributes
    ----------
    bins : Bins
        Sides and numbers of the bins, common to both trees.
    newest : (2, bins) int32
        Row of the tree's newest vertex in each bin; NONE (-1) for an empty bin.
    first : (2, USES_MAX + 1) int32
        Number of the first bin in the list of bins that were chosen k times, for each k; NONE for
        an empty list.
    following : (2, bins) int32
        Number of the bin after each bin in its list; NONE after the last one.
    filled : (2, bins) int32
        Numbers of the bins that are not empty, in the order in which they got their first vertex.
    n_filled : (2,) int64
        Number of bins of each tree that are not empty: entries of ``filled`` in use.

    """

    bins: Bins
    newest: NDArray[np.int32]
    first: NDArray[np.int32]
    following: NDArray[np.int32]
    filled: NDArray[np.int32]
    n_filled: NDArray[np.int64]


@kernel
def empty_frontier(lower, upper, clearance):
    """Return the frontiers of two empty trees in a box, with bins sized by a typical clearance."""
    width, height = upper[0] - lower[0], upper[1] - lower[1] if len(lower) > 1 else 0.0
    side = max(SIDE * clearance, max(width, height) / BINS_MAX)
    bins = make_bins(lower, upper, side)
    shape = (2, bins.rows * bins.columns)
    return Frontier(
        bins,
        np.full(shape, NONE, dtype=np.int32),
        np.full((2, USES_MAX + 1), NONE, dtype=np.int32),
        np.empty(shape, dtype=np.int32),
        np.empty(shape, dtype=np.int32),
        np.zeros(2, dtype=np.int64),
    )


@kernel
def add_to_bin(frontier, tree, x, k):
    """Make vertex ``k`` at ``x`` (dim,) the newest of its bin; return the number of the bin."""
    at = bin_of(frontier.bins, x)
    if frontier.newest[tree, at] == NONE:
        _put_first(frontier, tree, at, 0)
        frontier.filled[tree, frontier.n_filled[tree]] = at
        frontier.n_filled[tree] += 1
    frontier.newest[tree, at] = k
    return at


@kernel
def choose_vertex(frontier, tree, rng):
    """
    Choose the vertex from which a tree grows next; return its row.

    It is the newest vertex of a bin: of a uniform one with probability ``ANY``, else of the bin
    chosen least often. The latter choice is counted.
    """
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
    """Insert bin ``at`` at the head of the list of bins that were chosen ``uses`` times."""
    frontier.following[tree, at] = frontier.first[tree, uses]
    frontier.first[tree, uses] = at
