"""
Learning a space: draws, corners, sights, ways, exits; of what is known already only what changed.

Everything follows from uniform draws, one in each of a number of *slots*. A draw that stays where
it was looks around with the same random numbers as before: what leads to the same place as then
has met no change, and there is nothing to learn from it.
"""

from hnr_planner.core.cancellation import Event, in_parts
from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.streams import stream
from hnr_planner.core.planning.roadmap.corners import (
    distinct,
    find_corners,
    find_opening,
    look_around,
)
from hnr_planner.core.planning.roadmap.data import Knowledge, LOOKS
from hnr_planner.core.planning.roadmap.draws import place_draws
from hnr_planner.core.planning.roadmap.exits import arrive, exits_of
from hnr_planner.core.planning.roadmap.visibility import (
    ASK,
    ask_through,
    edges_of,
    look,
    mend,
    no_ways,
    SEEN,
    Sights,
    Ways,
)
from hnr_planner.core.spaces.primitives import are_free
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.trees import NONE
import numpy as np
from numpy.typing import NDArray

#: Uniform draws that look around for corners; a part of them also learn their exits, and from a
#: part of these again paths are asked for.
N_DRAWS = 4096
GUIDES, SOURCES = 1 / 2, 1 / 16
#: Nodes at most: their ways fill a table.
NODES_MAX = 3072
#: How far a node is from the corner that it stands for, in units of the typical clearance.
AWAY = 1e-3
#: Times that nodes are taken to the caller's frame and back until they stay the same.
ROUNDS = 8
#: What random streams are for, beside those of the draws: the looks.
LOOK = 2


def learn(
    before: Knowledge, space: Space, n_draws: int, seed: int, cancel: Event | None
) -> Knowledge:
    """
    Return what is known of ``space`` from ``n_draws`` draws, given what was known before.

    Raises
    ------
    Cancelled
        When ``cancel`` was set.

    """
    lower, upper = space.kernel_bounds
    draws, stays = place_draws(before, space, n_draws, seed, cancel)
    looks, corners, opening = _look_for_corners(before, space, draws, stays, seed, cancel)
    nodes, was = _choose_nodes(before, space, corners)

    sights = np.tril(_sights_before(before, space, before.sights, was, was), -1)
    _ask(space, nodes, nodes, sights, opening, cancel)
    sights |= sights.T
    guides = draws[: int(GUIDES * n_draws)]
    slots = np.arange(len(guides))
    guide_stays = stays[: len(guides)] & (slots < len(before.guide_sights))
    guide_was = np.where(guide_stays, slots, NONE)
    guide_sights = _sights_before(before, space, before.guide_sights, guide_was, was)
    _ask(space, guides, nodes, guide_sights, opening, cancel)

    ways = _mend_ways(before, nodes, was, sights, cancel)
    is_exit = _find_exits(space, guides, nodes, guide_sights, int(SOURCES * n_draws), ways, cancel)
    exits = exits_of(guides, is_exit, lower, upper)
    return Knowledge(
        space, n_draws, before.age + 1, draws, looks, nodes, sights, guide_sights, ways, exits
    )


# -- corners ------------------------------------------------------------------------------------


def _look_for_corners(
    before: Knowledge,
    space: Space,
    draws: Floats,
    stays: NDArray[np.bool_],
    seed: int,
    cancel: Event | None,
) -> tuple[Floats, Floats, tuple[Floats, Floats]]:
    """Return looks, new corners (n, dim), and lower and upper corner of what was opened."""
    looks, known = np.full((2, len(draws), LOOKS, space.dim), np.nan)
    known[stays] = before.looks[: len(draws)][stays[: len(before.looks)]]
    opening = np.full(space.dim, np.inf), np.full(space.dim, -np.inf)
    away = AWAY * space.typical_clearance
    found = [np.empty((0, space.dim))]
    for part in in_parts(len(draws), cancel):
        look_around(space.data, draws[part], stream(seed, LOOK, part.start), looks[part])
        found.append(find_corners(space.data, draws[part], looks[part], known[part], away))
        if before.age > 0 and space is not before.space:
            find_opening(before.space.data, draws[part], looks[part], known[part], *opening)
    return looks, np.concatenate(found), opening


def _choose_nodes(
    before: Knowledge, space: Space, corners: Floats
) -> tuple[Floats, NDArray[np.int64]]:
    """
    Return the nodes (n, dim) among old nodes and corners, and which each was before, or NONE.

    Corners that are found often are found early, and so are not among those for which there is no
    room. Old nodes that no way goes over come last.
    """
    old = np.flatnonzero(are_free(space.data, before.nodes))
    new = _settled(space, corners)
    points, n_old = np.concatenate([before.nodes[old], new]), len(old)
    stands = distinct(points, n_old, AWAY * space.typical_clearance / 2.0)[n_old:]
    is_used = np.zeros(len(before.nodes), dtype=bool)
    is_used[before.ways.previous[before.ways.previous != NONE]] = True
    is_used[before.exits.nodes] = True
    was = np.concatenate(
        [old[is_used[old]], np.full(np.count_nonzero(stands), NONE), old[~is_used[old]]]
    )[:NODES_MAX]
    nodes = np.empty((len(was), space.dim))
    nodes[was != NONE] = before.nodes[was[was != NONE]]
    nodes[was == NONE] = new[stands][: np.count_nonzero(was == NONE)]
    return nodes, was


def _settled(space: Space, points: Floats) -> Floats:
    """
    Return those of ``points`` that are free and the same after a way through the caller's frame.

    A path over such nodes is checked in the caller's frame with the very numbers that it was
    found with.
    """
    for _ in range(ROUNDS):
        before, points = points, space.to_kernel(space.from_kernel(points))
    settled = points[(points == before).all(axis=1)]
    return settled[are_free(space.data, settled)]


# -- sights, ways and exits -----------------------------------------------------------------------


def _sights_before(
    before: Knowledge,
    space: Space,
    sights: Sights,
    rows: NDArray[np.int64],
    columns: NDArray[np.int64],
) -> Sights:
    """Return what old sights say for new rows and columns; NONE where those are really new."""
    known = np.full((len(rows), len(columns)), ASK, dtype=np.uint8)
    old_rows, old_columns = np.flatnonzero(rows != NONE), np.flatnonzero(columns != NONE)
    known[np.ix_(old_rows, old_columns)] = sights[np.ix_(rows[old_rows], columns[old_columns])]
    if space is not before.space:
        known[known == SEEN] = ASK
    return known


def _ask(
    space: Space,
    points: Floats,
    others: Floats,
    sights: Sights,
    opening: tuple[Floats, Floats],
    cancel: Event | None,
) -> None:
    """Answer what ``sights`` (k, n) ask, and what an opening may have changed."""
    for part in in_parts(len(points), cancel):
        if (opening[0] <= opening[1]).all():
            ask_through(*opening, points[part], others, sights[part])
        look(space.data, points[part], others, sights[part])


def _mend_ways(
    before: Knowledge,
    nodes: Floats,
    was: NDArray[np.int64],
    sights: Sights,
    cancel: Event | None,
) -> Ways:
    """Return the shortest ways along the sights of nodes: the old ones, mended."""
    ways = no_ways(len(nodes))
    old = np.flatnonzero(was != NONE)
    if len(old) > 0:
        number = np.full(len(before.nodes) + 1, NONE, dtype=np.int16)  # the last one is for NONE
        number[was[old]] = old
        pairs, pairs_before = np.ix_(old, old), np.ix_(was[old], was[old])
        ways.distance[pairs] = before.ways.distance[pairs_before]
        ways.previous[pairs] = number[before.ways.previous[pairs_before]]
        is_new = (sights[pairs] == SEEN) & (before.sights[pairs_before] != SEEN)
        new = old[np.argwhere(is_new)]
    else:
        new = np.empty((0, 2), dtype=np.int64)
    new_length = np.linalg.norm(np.diff(nodes[new], axis=1)[:, 0], axis=1).astype(np.float32)
    edges = edges_of(nodes, nodes, sights)
    for part in in_parts(len(nodes), cancel):
        mend(ways, np.arange(part.start, part.stop), edges, sights, new, new_length)
    return ways


def _find_exits(
    space: Space,
    guides: Floats,
    nodes: Floats,
    guide_sights: Sights,
    n_sources: int,
    ways: Ways,
    cancel: Event | None,
) -> NDArray[np.bool_]:
    """Say through which nodes (g, n) the guides are reached from the first of them."""
    is_exit = np.zeros(guide_sights.shape, dtype=bool)
    edges = edges_of(guides, nodes, guide_sights)
    for part in in_parts(min(n_sources, len(guides)), cancel):
        sources = np.arange(part.start, part.stop)
        arrive(space.data, guides, edges, sources, ways.distance, is_exit)
    return is_exit
