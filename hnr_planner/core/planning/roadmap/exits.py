"""
Where shortest paths leave a place: learned from paths between uniform draws.

The shortest paths from other draws arrive at a draw through a few nodes of all that it sees: its
*exits*. A point nearby leaves by the same ones. Draws are found through square bins over the first
two coordinates.
"""

import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.lengths import norm
from hnr_planner.core.sampling.draws import hit_and_run_step
from hnr_planner.core.spaces.primitives import contains, segment_is_free
from hnr_planner.core.trees import NONE
import numpy as np
from numpy.typing import NDArray

#: Draws for one bin, on average over the whole box.
DRAWS_IN_A_BIN = 2.0
#: Draws around a point whose exits it tries, until it has seen this many.
NEIGHBOURS, ENOUGH = 8, 16
#: Hit-and-Run steps that a point which sees no node may take until one does.
STEPS_MAX = 64


class Exits(NamedTuple):
    """
    Draws and their exits, bin by bin.

    Attributes
    ----------
    lower : (dim,)
        Corner of the bounds, where the bins begin.
    side : float
        Side of a bin.
    columns : int
        Bins in a row, with a rim of empty bins all around.
    first_draw : (bins + 1,) int64
        Where the draws of each bin begin.
    draws : (k, dim)
        The draws, kernel frame.
    first_exit : (k + 1,) int64
        Where the exits of each draw begin.
    nodes : (exits,) int64
        The exits.

    """

    lower: Floats
    side: float
    columns: int
    first_draw: NDArray[np.int64]
    draws: Floats
    first_exit: NDArray[np.int64]
    nodes: NDArray[np.int64]


def exits_of(draws: Floats, is_exit: NDArray[np.bool_], lower: Floats, upper: Floats) -> Exits:
    """Return ``draws`` (k, dim) in a box with the nodes that ``is_exit`` (k, n) marks."""
    useful = is_exit.any(axis=1)
    draws, is_exit = draws[useful], is_exit[useful]
    extent = (upper - lower)[:2]
    share = min(1.0, DRAWS_IN_A_BIN / max(len(draws), 1))
    side = float(np.prod(extent) * share) ** (1.0 / len(extent))
    shape = (extent / side).astype(np.int64) + 3
    bins = 1 + ((draws[:, :2] - lower[:2]) / side).astype(np.int64)
    index = bins @ np.cumprod([1, *shape[:-1]])
    order = np.argsort(index, kind='stable')
    of_draw, nodes = np.nonzero(is_exit[order])
    return Exits(
        lower=lower,
        side=side,
        columns=int(shape[0]),
        first_draw=np.searchsorted(index[order], np.arange(np.prod(shape) + 1)),
        draws=draws[order],
        first_exit=np.searchsorted(of_draw, np.arange(len(draws) + 1)),
        nodes=nodes,
    )


@kernel
def arrive(space, draws, edges, sources, distance, is_exit):
    """
    Go the shortest ways from the draws numbered ``sources`` to all, over what they see.

    Marks the nodes in ``is_exit`` (k, n) through which each draw is reached from one that does
    not see it.
    """
    space, draws, edges = borrowed(space), borrowed(draws), borrowed(edges)
    from_source = np.empty(len(distance), dtype=np.float32)
    for source in sources:
        from_source[:] = math.inf
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
def nodes_seen(space, nodes, exits, x, leaves):
    """
    Nodes that ``x`` sees among the exits of the draws around, or else at all; and how far away.

    Looked at from ``x`` when it leaves and else from the nodes: as a path will go.
    """
    seen, distance = np.empty(len(nodes), dtype=np.int64), np.empty(len(nodes))
    if not contains(space, x):
        return seen[:0], distance[:0]
    is_new, near = np.ones(len(nodes), dtype=np.bool_), np.empty(NEIGHBOURS, dtype=np.int64)
    n = 0
    for i in range(_nearest_draws(exits, x, near)):
        if n < ENOUGH:
            first, end = exits.first_exit[near[i]], exits.first_exit[near[i] + 1]
            of_draw = exits.nodes[first:end]
            n = _look_at(space, x, nodes, of_draw, leaves, is_new, seen, distance, n)
    if n == 0:
        n = _look_at(space, x, nodes, np.arange(len(nodes)), leaves, is_new, seen, distance, n)
    return seen[:n], distance[:n]


@kernel
def _look_at(space, x, nodes, candidates, leaves, is_new, seen, distance, n):
    """Write those of the candidates that are new and seen behind the first n; return how many."""
    for node in candidates:
        if is_new[node]:
            is_new[node] = False
            if (
                segment_is_free(space, x, nodes[node])
                if leaves
                else segment_is_free(space, nodes[node], x)
            ):
                seen[n], distance[n] = node, norm(nodes[node] - x)
                n += 1
    return n


@kernel
def _nearest_draws(exits, x, near):
    """Write the draws nearest to ``x`` of those in the bins around; return how many."""
    apart = np.empty(len(near))
    n, at, stride = 0, 0, 1
    for i in range(min(len(x), 2)):
        at += stride * (1 + math.floor((x[i] - exits.lower[i]) / exits.side))
        stride *= exits.columns
    for row in range(-1, 2) if len(x) > 1 else range(1):
        begin = at + row * exits.columns - 1
        for k in range(exits.first_draw[begin], exits.first_draw[begin + 3]):
            squared = 0.0
            for i in range(len(x)):
                squared += (exits.draws[k, i] - x[i]) ** 2
            if n < len(near):
                n += 1
            elif squared >= apart[n - 1]:
                continue
            place = n - 1
            while place > 0 and apart[place - 1] > squared:
                near[place], apart[place] = near[place - 1], apart[place - 1]
                place -= 1
            near[place], apart[place] = k, squared
    return n


@kernel
def way_to_node(space, nodes, exits, x, rng):
    """Take Hit-and-Run steps from ``x`` until a node is seen: the way (k, dim)."""
    way = np.empty((STEPS_MAX + 1, len(x)))
    way[0] = x
    steps = 0
    while steps < STEPS_MAX and len(nodes_seen(space, nodes, exits, way[steps], True)[0]) == 0:
        hit_and_run_step(space, way[steps], rng, way[steps + 1])
        steps += 1
    end = steps + 1
    return way[:end]
