"""
Edges: from each state of a corner to what is visible from there, tangent to the corner.

An edge leads to a state, where it is tangent to the other corner too: shortest paths consist of
edges. A *last edge* leads to a corner at which no path goes on: only shortest paths that end at
that corner use it. The edges of either kind of a state are ordered by their directions, those
turned most towards the obstacle first. So those that continue a path in its turn come first.
"""

from typing import NamedTuple

from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.copies import copy_into
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.planning.roadmap.grid.corners import (
    corner_beside,
    state_along,
    STEP_X,
    STEP_Y,
    X,
    Y,
)
from hnr_planner.core.planning.roadmap.grid.sweep import make_sweep, see_in_quadrant
from hnr_planner.core.trees import NONE
import numpy as np
from numpy.typing import NDArray

#: Coordinates are below this.
FAR = 2**31 - 1


class Edges(NamedTuple):
    """
    Edges of one kind of the states of n corners.

    Attributes
    ----------
    first : (2 n + 1,) int64
        Index in ``to`` of the first edge of each state; the last entry is the number of edges.
    to : (edges,) int32
        State in which each edge arrives; for a last edge, twice the corner that it leads to.

    """

    first: NDArray[np.int64]
    to: NDArray[np.int32]


@kernel
def scan(slabs, corners, rows):
    """
    Return the edges and the last edges of some corners, and how far each of these corners sees.

    Parameters
    ----------
    slabs : Slabs
        Slabs of the grid.
    corners : Corners
        All corners of the grid.
    rows : (k,) int64
        The corners to scan.

    Returns
    -------
    counts : (2 k, 2) int64
        Numbers of edges and of last edges of each state of the corners ``rows``.
    edges, last_edges : (m,) int32
        ``to`` of ``Edges``, state after state.
    reach : (k, 4) int32
        Box around all slabs in which each corner sees: left, right, lower and upper edge [cells].

    """
    slabs, corners, rows = borrowed(slabs), borrowed(corners), borrowed(rows)
    sweep, places = make_sweep(corners), corners.places
    counts = np.zeros((2 * len(rows), 2), dtype=np.int64)
    reach = np.empty((len(rows), 4), dtype=np.int32)
    edges, last_edges = np.empty(1, dtype=np.int32), np.empty(1, dtype=np.int32)
    n_edges, n_last = 0, 0
    for i in range(len(rows)):
        corner = rows[i]
        sweep.reach[0], sweep.reach[1], sweep.reach[2], sweep.reach[3] = FAR, 0, FAR, 0
        for sense in range(2):
            n_seen = _see_along(slabs, corners, 2 * corner + sense, sweep)
            edges, last_edges = fit(edges, n_edges + n_seen), fit(last_edges, n_last + n_seen)
            before_edges, before_last = n_edges, n_last
            for k in range(n_seen):
                other = sweep.seen[k]
                dx = places[other, X] - places[corner, X]
                dy = places[other, Y] - places[corner, Y]
                state = state_along(places, other, dx, dy)
                if state == NONE:
                    last_edges[n_last] = 2 * other
                    n_last += 1
                else:
                    edges[n_edges] = state
                    n_edges += 1
            counts[2 * i + sense, 0] = n_edges - before_edges
            counts[2 * i + sense, 1] = n_last - before_last
        copy_into(reach[i], sweep.reach)
    return counts, edges[:n_edges].copy(), last_edges[:n_last].copy(), reach


@kernel
def _see_along(slabs, corners, state, sweep):
    """
    Write the corners visible in the quadrant of a state to ``sweep.seen``; return their number.

    They are ordered by their directions, those turned most towards the obstacle first.
    """
    corner, seen = state // 2, sweep.seen
    step_x, step_y = int(corners.places[corner, STEP_X]), int(corners.places[corner, STEP_Y])
    right, up = (step_x, -step_y) if state % 2 == 0 else (-step_x, step_y)
    n = see_in_quadrant(slabs, corners, corner, right, up, sweep)
    beside = corner_beside(slabs, corners, state)
    if beside != NONE:
        seen[n] = beside
        n += 1
        if right == -1:  # it is the leftmost: move it before the others
            for k in range(n - 1, 0, -1):
                seen[k - 1], seen[k] = seen[k], seen[k - 1]
    if step_x == -1:  # the obstacle is on the right
        for k in range(n // 2):
            seen[k], seen[n - 1 - k] = seen[n - 1 - k], seen[k]
    return n


@kernel
def fit(array, n):
    """Return ``array`` (m,), or a copy of at least twice its length that has room for ``n``."""
    if n <= len(array):
        return array
    larger = np.empty(2 * n, dtype=array.dtype)
    copy_into(larger[: len(array)], array)
    return larger
