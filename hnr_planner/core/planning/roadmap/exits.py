"""
Exits: the nodes over which shortest paths leave the surroundings of a point.

The shortest paths from other draws reach a draw through few of the nodes visible from it: its
*exits*. Paths from a point nearby mostly leave over the same nodes. Square bins over the first two
coordinates find the draws near a point.
"""

import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.copies import copy_into
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.lengths import norm
from hnr_planner.core.planning.bins import bin_of, Bins, bins_of, make_bins
from hnr_planner.core.sampling.draws import hit_and_run_step
from hnr_planner.core.spaces.primitives import contains, segment_is_free
from hnr_planner.core.trees import NONE
import numpy as np
from numpy.typing import NDArray

#: Draws in one bin, on average over the whole box.
DRAWS_IN_A_BIN = 2.0
#: Number of nearest draws whose exits are tested, and of visible nodes that end the tests.
NEIGHBOURS, ENOUGH = 8, 16
#: Largest number of Hit-and-Run steps from a point without visible nodes to one with some.
STEPS_MAX = 64


class Exits(NamedTuple):
    """
    Draws and their exits, ordered by the bins that hold the draws.

    Attributes
    ----------
    bins : Bins
        Bins that divide the box around the space.
    first_draw : (bins + 1,) int64
        Index in ``draws`` where the draws of each bin begin.
    draws : (k, dim)
        Draws, kernel frame, bin by bin.
    first_exit : (k + 1,) int64
        Index in ``nodes`` where the exits of each draw begin.
    nodes : (exits,) int64
        Rows of the roadmap's nodes that are the exits of each draw, draw by draw.

    """

    bins: Bins
    first_draw: NDArray[np.int64]
    draws: Floats
    first_exit: NDArray[np.int64]
    nodes: NDArray[np.int64]


def exits_of(draws: Floats, is_exit: NDArray[np.bool_], lower: Floats, upper: Floats) -> Exits:
    """
    Return the exits of ``draws`` (k, dim): the nodes that ``is_exit`` (k, n) marks for each draw.

    Draws without an exit are left out. The bins cover the box from ``lower`` to ``upper`` (dim,).
    """
    useful = is_exit.any(axis=1)
    draws, is_exit = draws[useful], is_exit[useful]
    extent = (upper - lower)[:2]
    share = min(1.0, DRAWS_IN_A_BIN / max(len(draws), 1))
    side = float(np.prod(extent) * share) ** (1.0 / len(extent))
    bins = make_bins(lower, upper, side)
    index = bins_of(bins, draws)
    order = np.argsort(index, kind='stable')
    of_draw, nodes = np.nonzero(is_exit[order])
    return Exits(
        bins=bins,
        first_draw=np.searchsorted(index[order], np.arange(bins.rows * bins.columns + 1)),
        draws=draws[order],
        first_exit=np.searchsorted(of_draw, np.arange(len(draws) + 1)),
        nodes=nodes,
    )


@kernel
def mark_exits(space, draws, edges, sources, distance, is_exit):
    """
    Mark the exits of all draws, by the shortest paths from the draws numbered ``sources``.

    ``edges`` lead from the draws (k, dim) to the nodes, and ``distance`` (n, n) is between nodes.
    Sets ``is_exit`` (k, n) for the last node before a draw on the shortest path to it from a
    source from which the draw is not visible.
    """
    space, draws, edges = borrowed(space), borrowed(draws), borrowed(edges)
    from_source = np.empty(len(distance), dtype=np.float32)
    for source in sources:
        for k in range(len(from_source)):
            from_source[k] = math.inf
        for edge in range(edges.first[source], edges.first[source + 1]):
            node, length = edges.to[edge], edges.length[edge]
            for k in range(len(distance)):
                from_source[k] = min(from_source[k], length + distance[node, k])
        for draw in range(len(draws)):
            shortest, exit_node = math.inf, NONE
            for edge in range(edges.first[draw], edges.first[draw + 1]):
                node = edges.to[edge]
                if from_source[node] + edges.length[edge] < shortest:
                    shortest, exit_node = from_source[node] + edges.length[edge], node
            if exit_node != NONE and not segment_is_free(space, draws[source], draws[draw]):
                is_exit[draw, exit_node] = True


@kernel
def visible_nodes(space, nodes, exits, x, leaves):
    """
    Return the nodes visible from ``x`` among the exits of the nearest draws, and their distances.

    The nodes are rows of ``nodes`` (n, dim); all points are in the kernel frame. Where none of
    those exits is visible, all nodes are tested. Segments are tested in the direction of the path:
    from ``x`` (dim,) when ``leaves``, else from the nodes to ``x``.
    """
    visible, distance = np.empty(len(nodes), dtype=np.int64), np.empty(len(nodes))
    if not contains(space, x):
        return visible[:0], distance[:0]
    is_new, near = np.ones(len(nodes), dtype=np.bool_), np.empty(NEIGHBOURS, dtype=np.int64)
    n = 0
    for i in range(_nearest_draws(exits, x, near)):
        if n < ENOUGH:
            first, end = exits.first_exit[near[i]], exits.first_exit[near[i] + 1]
            of_draw = exits.nodes[first:end]
            n = _add_visible(space, x, nodes, of_draw, leaves, is_new, visible, distance, n)
    if n == 0:
        every = np.arange(len(nodes))
        n = _add_visible(space, x, nodes, every, leaves, is_new, visible, distance, n)
    return visible[:n], distance[:n]


@kernel
def _add_visible(space, x, nodes, candidates, leaves, is_new, visible, distance, n):
    """
    Append candidates visible from ``x`` to the first ``n`` of ``visible``; return their number.

    Candidates are rows of ``nodes``; those that ``is_new`` marks as tested already are left out.
    """
    for node in candidates:
        if is_new[node]:
            is_new[node] = False
            if (
                segment_is_free(space, x, nodes[node])
                if leaves
                else segment_is_free(space, nodes[node], x)
            ):
                visible[n], distance[n] = node, norm(nodes[node] - x)
                n += 1
    return n


@kernel
def _nearest_draws(exits, x, near):
    """
    Write the indices of the draws nearest to ``x`` (dim,), the nearest first; return their number.

    Only draws in the bin that holds ``x`` and the 8 bins around it are found.
    """
    nearest_squared = np.empty(len(near))
    n, at = 0, bin_of(exits.bins, x)
    for row in (-1, 0, 1):
        begin = at + row * exits.bins.columns - 1
        for k in range(exits.first_draw[begin], exits.first_draw[begin + 3]):
            squared = 0.0
            for i in range(len(x)):
                squared += (exits.draws[k, i] - x[i]) ** 2
            if n < len(near):
                n += 1
            elif squared >= nearest_squared[n - 1]:
                continue
            rank = n - 1
            while rank > 0 and nearest_squared[rank - 1] > squared:
                near[rank], nearest_squared[rank] = near[rank - 1], nearest_squared[rank - 1]
                rank -= 1
            near[rank], nearest_squared[rank] = k, squared
    return n


@kernel
def walk_to_node(space, nodes, exits, x, rng):
    """
    Take Hit-and-Run steps from ``x`` (dim,) until a node is visible; return the points (k, dim).

    ``x`` is the first point. After ``STEPS_MAX`` steps the walk ends without a visible node.
    """
    walk = np.empty((STEPS_MAX + 1, len(x)))
    copy_into(walk[0], x)
    steps = 0
    while steps < STEPS_MAX and len(visible_nodes(space, nodes, exits, walk[steps], True)[0]) == 0:
        hit_and_run_step(space, walk[steps], rng, walk[steps + 1])
        steps += 1
    end = steps + 1
    return walk[:end]
