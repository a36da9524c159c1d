"""
The graph of a grid: its corners, the edges between them, and their landmarks.

After a change of the map only corners that see something of it, before or after, are scanned
again. A graph is built by repairing an empty one.
"""

from typing import NamedTuple

from hnr_planner.core.cancellation import Event, in_chunks
from hnr_planner.core.checks import Floats
from hnr_planner.core.planning.roadmap.grid.corners import (
    Corners,
    find_corners,
    STEP_X,
    STEP_Y,
    X,
    Y,
)
from hnr_planner.core.planning.roadmap.grid.edges import Edges, scan
from hnr_planner.core.planning.roadmap.grid.landmarks import measure_landmarks
from hnr_planner.core.spaces.grid.grid_space import GridSpace
from hnr_planner.core.spaces.grid.slabs import Slabs
from hnr_planner.core.trees import NONE
import numpy as np
from numpy.typing import NDArray

Bools = NDArray[np.bool_]
Indices = NDArray[np.int64]


class Graph(NamedTuple):
    """
    The graph of a grid, kernel frame.

    Attributes
    ----------
    slabs : Slabs
        Slabs of the grid.
    corners : Corners
        Corners of the grid.
    edges, last_edges : Edges
        Edges and last edges of the states of the corners.
    reach : (n, 4) int32
        Box around all slabs in which each corner sees: left, right, lower and upper edge [cells].
    landmarks : (n, N_LANDMARKS)
        Distance [cells] of each corner from each landmark of its component.

    """

    slabs: Slabs
    corners: Corners
    edges: Edges
    last_edges: Edges
    reach: NDArray[np.int32]
    landmarks: Floats


def build_graph(space: GridSpace, cancel: Event | None) -> Graph:
    """
    Return the graph of a grid.

    Raises
    ------
    Cancelled
        When ``cancel`` was set.

    """
    slabs, corners = space.slabs, find_corners(space.slabs)
    no_edges = Edges(np.zeros(1, dtype=np.int64), np.empty(0, dtype=np.int32))
    no_reach = np.empty((0, 4), dtype=np.int32)
    empty = Graph(slabs, corners, no_edges, no_edges, no_reach, np.empty((0, 0)))
    none, unknown = np.empty(0, dtype=np.int64), np.full(len(corners.ends), NONE)
    return _repaired(empty, space, corners, unknown, none, cancel)


def repair_graph(before: Graph, old: GridSpace, space: GridSpace, cancel: Event | None) -> Graph:
    """
    Return the graph of ``space``, given the graph ``before`` of a grid ``old`` of the same shape.

    It equals the graph that ``build_graph`` returns.

    Raises
    ------
    Cancelled
        When ``cancel`` was set.

    """
    changed = (space.data.free_distance == 0) != (old.data.free_distance == 0)
    corners = find_corners(space.slabs)
    now = _same_places(before.corners, corners, changed.shape)
    kept = np.flatnonzero(_changes_in_reach(before.reach, changed) == 0)
    was = np.full(len(corners.ends), NONE)
    was[now[kept]] = kept
    return _repaired(before, space, corners, was, now, cancel)


def _repaired(
    before: Graph,
    space: GridSpace,
    corners: Corners,
    was: Indices,
    now: Indices,
    cancel: Event | None,
) -> Graph:
    """
    Return the graph of ``space``, with edges from ``before`` for the corners that see no change.

    ``was`` (n,) is the index in ``before`` of each of the ``corners``, NONE (-1) for those that
    are to be scanned; ``now`` (m,) is the index in ``corners`` of each corner of ``before``.
    """
    slabs, is_kept = space.slabs, was != NONE
    rows = np.flatnonzero(~is_kept)
    # At least one chunk, so that there is something to concatenate.
    chunks = in_chunks(max(len(rows), 1), cancel)
    found = zip(*(scan(slabs, corners, rows[chunk]) for chunk in chunks), strict=True)
    counts, edge_ends, last_edge_ends, reaches = map(np.concatenate, found)
    edges = _merge(before.edges, was, now, counts[:, 0], edge_ends)
    last_edges = _merge(before.last_edges, was, now, counts[:, 1], last_edge_ends)
    reach = np.empty((len(was), 4), dtype=np.int32)
    reach[rows], reach[is_kept] = reaches, before.reach[was[is_kept]]
    components = _components(space, corners)
    landmarks = measure_landmarks(slabs, corners, edges, last_edges, components, cancel)
    return Graph(slabs, corners, edges, last_edges, reach, landmarks)


def _merge(
    before: Edges, was: Indices, now: Indices, counts: Indices, to: NDArray[np.int32]
) -> Edges:
    """
    Return the edges of all corners: those from ``before`` of kept corners, and those found.

    ``was`` (n,) is the index in ``before`` of each corner, NONE (-1) for those that were scanned,
    and ``now`` (m,) the index of each corner of ``before``, NONE for those that are gone.
    ``counts`` (2 k,) are the numbers of edges of the states of scanned corners, and ``to`` is
    where they lead.
    """
    is_kept, kept_before = np.repeat(was != NONE, 2), _states(was[was != NONE])
    source = np.concatenate([to, _states(now)[before.to]])
    n_edges, begin = np.empty((2, len(is_kept)), dtype=np.int64)
    n_edges[~is_kept], n_edges[is_kept] = counts, np.diff(before.first)[kept_before]
    begin[~is_kept] = np.cumsum(counts) - counts
    begin[is_kept] = len(to) + before.first[kept_before]
    first = np.concatenate([[0], np.cumsum(n_edges)])
    taken = np.arange(first[-1]) + np.repeat(begin - first[:-1], n_edges)
    return Edges(first, source[taken].astype(np.int32))


def _states(corners: Indices) -> Indices:
    """Return the states (2 k,) of corners (k,)."""
    return (2 * corners[:, np.newaxis] + np.arange(2)).ravel()


def _changes_in_reach(reach: NDArray[np.int32], changed: Bools) -> Indices:
    """
    Return how many of the ``changed`` cells (rows, columns) are in or beside each reach.

    ``reach`` (n, 4) are boxes, as in ``Graph``. The counts (n,) come from a table of sums over the
    part of the map that holds all changes (Crow, "Summed-area tables for texture mapping",
    SIGGRAPH 1984).
    """
    rows, columns = (np.flatnonzero(changed.any(axis=axis)) for axis in (1, 0))
    if len(rows) == 0:
        return np.zeros(len(reach), dtype=np.int64)
    bottom, top, first, last = rows[0], rows[-1] + 1, columns[0], columns[-1] + 1
    part = np.pad(changed[bottom:top, first:last], ((1, 0), (1, 0)))
    sums = part.cumsum(axis=0).cumsum(axis=1)
    left, right = (reach[:, :2] + (-1, 1) - first).clip(0, sums.shape[1] - 1).T
    lower, upper = (reach[:, 2:] + (-1, 1) - bottom).clip(0, sums.shape[0] - 1).T
    return sums[upper, right] - sums[lower, right] - sums[upper, left] + sums[lower, left]


def _same_places(before: Corners, corners: Corners, shape: tuple[int, ...]) -> Indices:
    """
    Return the index in ``corners`` of each corner (m,) of ``before``; NONE (-1) where it is gone.

    ``shape`` (rows, columns) is that of the grids of both.
    """
    # Grid points in the order of the corners: by height, then from left to right.
    old, new = (c.places[:, Y] * (shape[1] + 1) + c.places[:, X] for c in (before, corners))
    index = np.searchsorted(new, old)
    index[~np.isin(old, new)] = NONE
    return index


def _components(space: GridSpace, corners: Corners) -> NDArray[np.int32]:
    """Return the component (n,) of the free space at each corner."""
    # The cell across from the blocked one: its lower left corner is one back for a step of -1.
    cells = corners.places[:, [Y, X]] + np.minimum(corners.places[:, [STEP_Y, STEP_X]], 0.0)
    rows, columns = cells.astype(np.int64).T
    return space.data.labels[rows, columns]
