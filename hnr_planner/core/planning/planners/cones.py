"""
Cones: the search nodes of Polyanya on slabs, and the heap of those that are open.

A node is a root, the last corner at which the path bends, and the interval of a portal that is
visible from the root: the cone between two bounds, through that portal into the next slab. Corners
and the ends of portals have integer coordinates, and a cone is stored as the points that bound it,
so whether a corner lies in a cone is the sign of an exact product.

Cones are closed, so that a path may touch corners on both sides. Left and right are those of the
grid, also for cones that open downwards.
"""

import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.grid.slabs import slab_at, THROUGH
import numpy as np
from numpy.typing import NDArray

#: No vertex, no portal.
NONE = -1
#: Columns of a node: row of its root, bounds of its cone, portal, direction of travel (+1 up).
ROOT, LEFT_X, LEFT_Y, RIGHT_X, RIGHT_Y, PORTAL, UP = range(7)
#: Columns of a vertex: point, distance from the start, row of the vertex before, corner.
X, Y, DISTANCE, PARENT, CORNER = range(5)
#: Entries of ``sizes``.
N_NODES, N_VERTICES, N_OPEN, FINAL = range(4)


class Frontier(NamedTuple):
    """
    State of a search.

    Attributes
    ----------
    nodes : (rows, 7)
        Columns as above.
    vertices : (rows, 5)
        Columns as above; row 0 is the start.
    estimates, heap : (rows,)
        Binary heap of open nodes: their estimates, and their rows (``NONE - row`` of a vertex for
        the goal reached from there).
    nearest : (2 n_portals,)
        Least distance at which each corner has been reached.
    is_open : (n_slabs,) bool
        Slabs that a path may pass: all but dead ends that hold neither start nor goal.
    sizes : (4,) int64
        Rows in use, and the vertex from which the goal was reached.

    """

    nodes: Floats
    vertices: Floats
    estimates: Floats
    heap: NDArray[np.int64]
    nearest: Floats
    is_open: NDArray[np.bool_]
    sizes: NDArray[np.int64]


@kernel
def open_frontier(slabs, start, goal, capacity):
    """Return the state of a search between free points (2,) off grid lines."""
    frontier = Frontier(
        np.empty((capacity, 7)),
        np.empty((capacity, 5)),
        np.empty(capacity),
        np.empty(capacity, dtype=np.int64),
        np.full(2 * len(slabs.portals), np.inf),
        slabs.exits == THROUGH,
        np.zeros(4, dtype=np.int64),
    )
    frontier.sizes[FINAL] = NONE
    add_vertex(frontier, start[0], start[1], 0.0, NONE, NONE)
    slab, goal_slab = slab_at(slabs, start[0], start[1]), slab_at(slabs, goal[0], goal[1])
    _open_exits(slabs, frontier, slab)
    _open_exits(slabs, frontier, goal_slab)
    if slab == goal_slab:
        push(frontier, math.hypot(goal[0] - start[0], goal[1] - start[1]), NONE)
        return frontier
    for up in (1, -1):
        edge = slabs.above if up == 1 else slabs.below
        for k in range(edge[slab, 0], edge[slab, 1]):
            left, right, y = slabs.portals[k, 0], slabs.portals[k, 1], slabs.portals[k, 2]
            add_node(slabs, frontier, goal, 0, left, y, right, y, k, up)
    return frontier


@kernel
def first_capacity(slabs, start):
    """Return how many rows the first nodes of a search from a point (2,) need."""
    slab = slab_at(slabs, start[0], start[1])
    above = slabs.above[slab, 1] - slabs.above[slab, 0]
    return above + slabs.below[slab, 1] - slabs.below[slab, 0] + 2


@kernel
def _open_exits(slabs, frontier, slab):
    """Mark as open the slabs from ``slab`` to the exit of its dead end."""
    while not frontier.is_open[slab]:
        frontier.is_open[slab] = True
        slab = slabs.exits[slab]


@kernel
def is_over(frontier):
    """Return whether the search has ended; store the goal's vertex once it comes first."""
    sizes = frontier.sizes
    if sizes[N_OPEN] > 0 and frontier.heap[0] <= NONE:
        sizes[FINAL] = NONE - frontier.heap[0]
    return sizes[N_OPEN] == 0 or sizes[FINAL] != NONE


@kernel
def add_vertex(frontier, x, y, distance, parent, corner):
    """Write a vertex in the first free row; return that row."""
    row = frontier.sizes[N_VERTICES]
    vertex = frontier.vertices[row]
    vertex[X], vertex[Y], vertex[DISTANCE] = x, y, distance
    vertex[PARENT], vertex[CORNER] = parent, corner
    frontier.sizes[N_VERTICES] += 1
    return row


@kernel
def add_node(slabs, frontier, goal, root, lx, ly, rx, ry, portal, up):
    """Add the node of a root and the cone between two bounds (x, y) through a portal."""
    if not frontier.is_open[slabs.portals[portal, 4] if up == 1 else slabs.portals[portal, 3]]:
        return
    row = frontier.sizes[N_NODES]
    node = frontier.nodes[row]
    node[ROOT], node[PORTAL], node[UP] = root, portal, up
    node[LEFT_X], node[LEFT_Y], node[RIGHT_X], node[RIGHT_Y] = lx, ly, rx, ry
    frontier.sizes[N_NODES] += 1
    vertex, line = frontier.vertices[root], float(slabs.portals[portal, 2])
    x, y = vertex[X], vertex[Y]
    left = max(_crossing(x, y, lx, ly, line), float(slabs.portals[portal, 0]))
    right = min(_crossing(x, y, rx, ry, line), float(slabs.portals[portal, 1]))
    goal_y = goal[1] if up * (goal[1] - line) > 0.0 else 2.0 * line - goal[1]
    at = _crossing(x, y, goal[0], goal_y, line) if y != line else x
    at = min(max(at, left), right)
    rest = math.hypot(at - x, line - y) + math.hypot(goal[0] - at, goal_y - line)
    push(frontier, vertex[DISTANCE] + rest, row)


@kernel
def _crossing(x, y, bx, by, line):
    """Return the x at which the ray from ``(x, y)`` through a bound meets a horizontal line."""
    return float(bx) if by == line else x + (bx - x) * (line - y) / (by - y)


@kernel
def push(frontier, estimate, row):
    """Insert a row in the heap of open nodes, ordered by ``estimate``."""
    estimates, heap = frontier.estimates, frontier.heap
    k = frontier.sizes[N_OPEN]
    frontier.sizes[N_OPEN] += 1
    while k > 0 and estimates[(k - 1) // 2] > estimate:
        estimates[k], heap[k] = estimates[(k - 1) // 2], heap[(k - 1) // 2]
        k = (k - 1) // 2
    estimates[k], heap[k] = estimate, row


@kernel
def pop(frontier):
    """Remove the row of the least estimate from the heap."""
    estimates, heap, sizes = frontier.estimates, frontier.heap, frontier.sizes
    sizes[N_OPEN] -= 1
    n = sizes[N_OPEN]
    estimate, row = estimates[n], heap[n]
    k = 0
    while 2 * k + 1 < n:
        child = 2 * k + 1
        if child + 1 < n and estimates[child + 1] < estimates[child]:
            child += 1
        if estimates[child] >= estimate:
            break
        estimates[k], heap[k] = estimates[child], heap[child]
        k = child
    estimates[k], heap[k] = estimate, row
