"""
Build the data of a roadmap: draws, corners, visibility, shortest paths, exits.

Everything follows from uniform draws, one in each of a number of *slots*. After a change of the
space only what it affects is computed again. A draw that is kept casts its rays with the same
random numbers as before: a ray with the same end has met no change.
"""

from hnr_planner.core.cancellation import Event, in_chunks
from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.streams import stream
from hnr_planner.core.planning.roadmap.corners import (
    cast_rays,
    distinct,
    find_corners,
    widen_to_opened,
)
from hnr_planner.core.planning.roadmap.data import N_RAYS, RoadmapData
from hnr_planner.core.planning.roadmap.draws import draw_slots
from hnr_planner.core.planning.roadmap.exits import exits_of, mark_exits
from hnr_planner.core.planning.roadmap.visibility import (
    edges_of,
    empty_paths,
    mark_unknown_through,
    repair,
    resolve,
    ShortestPaths,
    UNKNOWN,
    Visibility,
    VISIBLE,
)
from hnr_planner.core.spaces.primitives import are_free
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.trees import NONE
import numpy as np
from numpy.typing import NDArray

#: Uniform draws that cast rays to find corners.
N_DRAWS = 4096
#: Fraction of the draws that are guides, whose exits are computed, and fraction of the draws from
#: which the shortest paths to the guides are followed to find these exits.
GUIDE_FRACTION, SOURCE_FRACTION = 1 / 2, 1 / 16
#: Largest number of nodes; the table of shortest paths has the square of it.
NODES_MAX = 3072
#: Distance of a node from the corner of an obstacle, in units of the typical clearance.
OFFSET = 1e-3
#: Number of conversions of nodes to the caller's frame and back, which leaves most unchanged.
ROUNDS = 8
#: Purpose of the random streams for rays, beside those of the draws.
RAYS = 2


def build_data(
    before: RoadmapData, space: Space, n_draws: int, seed: int, cancel: Event | None
) -> RoadmapData:
    """
    Return the roadmap data of ``space`` from ``n_draws`` draws, given the data before a change.

    The change is of the space or of the number of draws; only what it affects is computed.

    Raises
    ------
    Cancelled
        When ``cancel`` was set.

    """
    lower, upper = space.kernel_bounds
    draws, stays = draw_slots(before, space, n_draws, seed, cancel)
    rays, corners, opened_box = _cast_and_find_corners(before, space, draws, stays, seed, cancel)
    nodes, was = _choose_nodes(before, space, corners)

    visibility = np.tril(_known_visibility(before, space, before.visibility, was, was), -1)
    _resolve(space, nodes, nodes, visibility, opened_box, cancel)
    visibility |= visibility.T
    guides = draws[: int(GUIDE_FRACTION * n_draws)]
    slots = np.arange(len(guides))
    guide_stays = stays[: len(guides)] & (slots < len(before.guide_visibility))
    guide_was = np.where(guide_stays, slots, NONE)
    guide_visibility = _known_visibility(before, space, before.guide_visibility, guide_was, was)
    _resolve(space, guides, nodes, guide_visibility, opened_box, cancel)

    paths = _repair_paths(before, nodes, was, visibility, cancel)
    n_sources = int(SOURCE_FRACTION * n_draws)
    is_exit = _find_exits(space, guides, nodes, guide_visibility, n_sources, paths, cancel)
    exits = exits_of(guides, is_exit, lower, upper)
    return RoadmapData(
        space,
        n_draws,
        before.age + 1,
        draws,
        rays,
        nodes,
        visibility,
        guide_visibility,
        paths,
        exits,
    )


# -- corners ------------------------------------------------------------------------------------


def _cast_and_find_corners(
    before: RoadmapData,
    space: Space,
    draws: Floats,
    stays: NDArray[np.bool_],
    seed: int,
    cancel: Event | None,
) -> tuple[Floats, Floats, tuple[Floats, Floats]]:
    """
    Return rays (k, N_RAYS, dim), new corners (n, dim), and a box around newly free space.

    The box is (lower, upper), each (dim,); lower is above upper where no space has become free.
    """
    rays, known = np.full((2, len(draws), N_RAYS, space.dim), np.nan)
    known[stays] = before.rays[: len(draws)][stays[: len(before.rays)]]
    opened_box = np.full(space.dim, np.inf), np.full(space.dim, -np.inf)
    offset = OFFSET * space.typical_clearance
    found = [np.empty((0, space.dim))]
    for chunk in in_chunks(len(draws), cancel):
        cast_rays(space.data, draws[chunk], stream(seed, RAYS, chunk.start), rays[chunk])
        found.append(find_corners(space.data, draws[chunk], rays[chunk], known[chunk], offset))
        if before.age > 0 and space is not before.space:
            widen_to_opened(
                before.space.data, draws[chunk], rays[chunk], known[chunk], *opened_box
            )
    return rays, np.concatenate(found), opened_box


def _choose_nodes(
    before: RoadmapData, space: Space, corners: Floats
) -> tuple[Floats, NDArray[np.int64]]:
    """
    Return nodes (n, dim) chosen from old nodes and corners, and the old index (n,) of each node.

    The old index is NONE (-1) for a corner that was no node before.

    At most ``NODES_MAX`` are kept: old nodes on shortest paths first, then corners in the order in
    which they were found, which favours those found often, then the other old nodes.
    """
    old = np.flatnonzero(are_free(space.data, before.nodes))
    new = _stable(space, corners)
    points, n_old = np.concatenate([before.nodes[old], new]), len(old)
    is_kept = distinct(points, n_old, OFFSET * space.typical_clearance / 2.0)[n_old:]
    is_used = np.zeros(len(before.nodes), dtype=bool)
    is_used[before.shortest_paths.previous[before.shortest_paths.previous != NONE]] = True
    is_used[before.exits.nodes] = True
    was = np.concatenate(
        [old[is_used[old]], np.full(np.count_nonzero(is_kept), NONE), old[~is_used[old]]]
    )[:NODES_MAX]
    nodes = np.empty((len(was), space.dim))
    nodes[was != NONE] = before.nodes[was[was != NONE]]
    nodes[was == NONE] = new[is_kept][: np.count_nonzero(was == NONE)]
    return nodes, was


def _stable(space: Space, points: Floats) -> Floats:
    """
    Return the free ones of ``points`` (k, dim) that conversion to the caller's frame keeps equal.

    The points are first converted to that frame and back ``ROUNDS`` times.

    A path over such nodes is checked in the caller's frame with the very numbers that it was
    found with.
    """
    for _ in range(ROUNDS):
        before, points = points, space.to_kernel(space.from_kernel(points))
    stable = points[(points == before).all(axis=1)]
    return stable[are_free(space.data, stable)]


# -- visibility, shortest paths and exits --------------------------------------------------------


def _known_visibility(
    before: RoadmapData,
    space: Space,
    visibility: Visibility,
    rows: NDArray[np.int64],
    columns: NDArray[np.int64],
) -> Visibility:
    """
    Return the visibility (k, n) that pairs of points keep after a change; UNKNOWN for the others.

    In another space than before, pairs that were visible are UNKNOWN too.

    ``rows`` (k,) and ``columns`` (n,) are the old indices of the pairs' points, NONE (-1) for a
    point that is new.
    """
    known = np.full((len(rows), len(columns)), UNKNOWN, dtype=np.uint8)
    old_rows, old_columns = np.flatnonzero(rows != NONE), np.flatnonzero(columns != NONE)
    known[np.ix_(old_rows, old_columns)] = visibility[np.ix_(rows[old_rows], columns[old_columns])]
    if space is not before.space:
        known[known == VISIBLE] = UNKNOWN
    return known


def _resolve(
    space: Space,
    points: Floats,
    others: Floats,
    visibility: Visibility,
    opened_box: tuple[Floats, Floats],
    cancel: Event | None,
) -> None:
    """
    Compute unknown entries of ``visibility`` (k, n) between ``points`` and ``others``, in place.

    Hidden pairs whose segment meets ``opened_box`` (lower, upper) are computed again.
    """
    for chunk in in_chunks(len(points), cancel):
        if (opened_box[0] <= opened_box[1]).all():
            mark_unknown_through(*opened_box, points[chunk], others, visibility[chunk])
        resolve(space.data, points[chunk], others, visibility[chunk])


def _repair_paths(
    before: RoadmapData,
    nodes: Floats,
    was: NDArray[np.int64],
    visibility: Visibility,
    cancel: Event | None,
) -> ShortestPaths:
    """
    Return the shortest paths between ``nodes`` (n, dim), repaired from those before a change.

    ``was`` (n,) is the old index of each node, NONE (-1) for a new node.
    """
    paths = empty_paths(len(nodes))
    old = np.flatnonzero(was != NONE)
    if len(old) > 0:
        number = np.full(len(before.nodes) + 1, NONE, dtype=np.int16)  # the last one is for NONE
        number[was[old]] = old
        pairs, pairs_before = np.ix_(old, old), np.ix_(was[old], was[old])
        paths.distance[pairs] = before.shortest_paths.distance[pairs_before]
        paths.previous[pairs] = number[before.shortest_paths.previous[pairs_before]]
        is_new = (visibility[pairs] == VISIBLE) & (before.visibility[pairs_before] != VISIBLE)
        new = old[np.argwhere(is_new)]
    else:
        new = np.empty((0, 2), dtype=np.int64)
    new_length = np.linalg.norm(np.diff(nodes[new], axis=1)[:, 0], axis=1).astype(np.float32)
    edges = edges_of(nodes, nodes, visibility)
    for chunk in in_chunks(len(nodes), cancel):
        repair(paths, np.arange(chunk.start, chunk.stop), edges, visibility, new, new_length)
    return paths


def _find_exits(
    space: Space,
    guides: Floats,
    nodes: Floats,
    guide_visibility: Visibility,
    n_sources: int,
    paths: ShortestPaths,
    cancel: Event | None,
) -> NDArray[np.bool_]:
    """
    Return which of the nodes are exits of which guides, (g, n) bool.

    Only the shortest paths from the first ``n_sources`` guides are followed.
    """
    is_exit = np.zeros(guide_visibility.shape, dtype=bool)
    edges = edges_of(guides, nodes, guide_visibility)
    for chunk in in_chunks(min(n_sources, len(guides)), cancel):
        sources = np.arange(chunk.start, chunk.stop)
        mark_exits(space.data, guides, edges, sources, paths.distance, is_exit)
    return is_exit
