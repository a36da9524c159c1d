"""
Cones: the search nodes of ``polyanya``, and the state of its search.

Slabs are rectangles of free cells, and portals the intervals along which two slabs meet
(``spaces.grid.slabs``).

A node is a root, the last corner at which the path bends, and the interval of a portal that is
visible from the root: the cone between two bounds, through that portal into the next slab. Corners
and the ends of portals have integer coordinates, and a cone is stored as the points that bound it,
so the sign of an exact product states whether a corner lies in a cone.

Cones are closed, so that a path may touch corners on both sides. Left and right are those of the
grid, also for cones that open downwards.
"""

import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.planning.planner import with_capacity
from hnr_planner.core.planning.planners.heap import add_open, HAS_HOLE, N_OPEN
from hnr_planner.core.planning.planners.target import holds_target, nearest_of_disc, off_line
from hnr_planner.core.spaces.grid.slabs import slab_at, THROUGH
import numpy as np
from numpy.typing import NDArray

#: Index that stands for no vertex or no corner.
NONE = -1
#: Columns of a node: row of its root vertex, points on the left and right bound of its cone, index
#: of its portal, direction in which the cone opens (+1 up, -1 down).
ROOT, LEFT_X, LEFT_Y, RIGHT_X, RIGHT_Y, PORTAL, UP = range(7)
#: Columns of a vertex: point, length of the path from the start, row of the vertex before on that
#: path, number of its corner (2 portal + side).
X, Y, DISTANCE, PARENT, CORNER = range(5)
#: Entries of ``Frontier.sizes``, beside those of the heap: nodes and vertices, the row of the last
#: vertex, and the rows that one expansion may fill.
N_NODES, N_VERTICES, FINAL, AT_ONCE = 0, 1, 3, 4


class Frontier(NamedTuple):
    """
    State of a search, in arrays that a later search can use again.

    Points and lengths are in the kernel frame, in units of cells.

    Attributes
    ----------
    nodes : (rows, 7)
        Search nodes; columns ``ROOT`` to ``UP``.
    vertices : (rows, 5)
        The start, row 0, the corners reached, and the points of a disc where the search may end;
        columns ``X`` to ``CORNER``.
    estimates, heap : (rows,)
        Binary heap of open nodes: lower bounds on the length of paths through each node, and the
        row of each node in ``nodes``; ``NONE - row`` stands for the target, a point reached from
        the vertex in that row, or a disc reached at that vertex.
    nearest : (2 n_portals,)
        Length of the shortest path by which each corner has been reached; inf at first.
    is_open : (n_slabs,) bool
        Slabs that a path may pass: all but dead ends that hold neither start nor target.
    sizes : (6,) int64
        Numbers of nodes, of vertices and of open nodes; the row of the last vertex of the shortest
        path, NONE (-1) while the search is not solved; the rows that one expansion may fill; and
        whether the heap has a hole at its top (``take_first``).

    """

    nodes: Floats
    vertices: Floats
    estimates: Floats
    heap: NDArray[np.int64]
    nearest: Floats
    is_open: NDArray[np.bool_]
    sizes: NDArray[np.int64]


@kernel
def empty_frontier(slabs, rows):
    """
    Return the state of a search among ``slabs`` that has no nodes yet.

    Its arrays have at least ``rows`` rows, and as many as one expansion may fill.
    """
    at_once = 3 * slabs.most_portals + 7
    rows = max(rows, at_once)
    sizes = np.zeros(6, dtype=np.int64)
    sizes[FINAL], sizes[AT_ONCE] = NONE, at_once
    return Frontier(
        np.empty((rows, 7)),
        np.empty((rows, 5)),
        np.empty(rows),
        np.empty(rows, dtype=np.int64),
        np.full(2 * len(slabs.portals), np.inf),
        np.empty(len(slabs.boxes), dtype=np.bool_),
        sizes,
    )


def with_more_rows(frontier: Frontier, rows: int) -> Frontier:
    """Return ``frontier`` with arrays of at least ``rows`` rows."""
    return frontier._replace(
        nodes=with_capacity(frontier.nodes, rows),
        vertices=with_capacity(frontier.vertices, rows),
        estimates=with_capacity(frontier.estimates, rows),
        heap=with_capacity(frontier.heap, rows),
    )


@kernel
def open_frontier(slabs, frontier, start, target):
    """
    Begin a new search from ``start`` (2,) to ``target`` in the arrays of a frontier.

    The start is a free point, kernel frame. What an earlier search has left is cleared.
    """
    slabs, frontier = borrowed(slabs), borrowed(frontier)
    sizes, vertices = frontier.sizes, frontier.vertices
    for row in range(sizes[N_VERTICES]):
        if vertices[row, CORNER] != NONE:
            frontier.nearest[int(vertices[row, CORNER])] = np.inf
    for slab in range(len(slabs.exits)):
        frontier.is_open[slab] = slabs.exits[slab] == THROUGH
    sizes[N_NODES], sizes[N_VERTICES], sizes[N_OPEN], sizes[FINAL] = 0, 0, 0, NONE
    sizes[HAS_HOLE] = 0
    x, y = start[0], off_line(start[1])
    add_vertex(frontier, x, y, 0.0, NONE, NONE)
    slab = slab_at(slabs, x, y)
    _open_exits(slabs, frontier, slab)
    _open_exits_of_target(slabs, frontier, target)
    if slab == target.slab:
        add_open(frontier, length_of(target.x - x, target.y - y), NONE)
        return
    if holds_target(slabs, target, slab):
        reach_disc(slabs, frontier, target, 0, slab, np.empty((0, 4)))
    for up in (1, -1):
        edge = slabs.above if up == 1 else slabs.below
        for k in range(edge[slab, 0], edge[slab, 1]):
            left, right, line = slabs.portals[k, 0], slabs.portals[k, 1], slabs.portals[k, 2]
            add_node(slabs, frontier, 0, left, line, right, line, k, up)
    push_new(slabs, frontier, target, 0)


@kernel
def _open_exits(slabs, frontier, slab):
    """Mark as open the slabs on the way from ``slab`` out of the dead end that holds it."""
    while not frontier.is_open[slab]:
        frontier.is_open[slab] = True
        slab = slabs.exits[slab]


@kernel
def _open_exits_of_target(slabs, frontier, target):
    """Mark as open all slabs that hold the target, and those on the way out of their dead ends."""
    if target.radius == 0.0:
        _open_exits(slabs, frontier, target.slab)
        return
    first = max(math.floor(target.y - target.radius), 0.0)
    last = min(math.floor(target.y + target.radius), len(slabs.rows) - 2.0)
    for row in range(int(first), int(last) + 1):
        for k in range(slabs.rows[row], slabs.rows[row + 1]):
            slab = slabs.runs[k]
            if not frontier.is_open[slab] and holds_target(slabs, target, slab):
                _open_exits(slabs, frontier, slab)


@kernel
def reach_disc(slabs, frontier, target, root, slab, bounds):
    """
    Push the point of a disc nearest to vertex ``root`` on the heap, where a slab holds one.

    Only points within ``bounds`` (k, 4) count; see ``nearest_of_disc``.
    """
    x, y = frontier.vertices[root, X], frontier.vertices[root, Y]
    px, py = nearest_of_disc(slabs, target, slab, x, y, bounds)
    if not math.isnan(px):
        length = frontier.vertices[root, DISTANCE] + length_of(px - x, py - y)
        add_open(frontier, length, NONE - add_vertex(frontier, px, py, length, root, NONE))


@inlined
def is_over(frontier):
    """
    Return whether the search has ended: the target is first in the heap, or the heap is empty.

    Where the target comes first, the last vertex of the shortest path is stored in ``sizes``.
    """
    sizes = frontier.sizes
    if sizes[N_OPEN] > 0 and frontier.heap[0] <= NONE:
        sizes[FINAL] = NONE - frontier.heap[0]
    return sizes[N_OPEN] == 0 or sizes[FINAL] != NONE


@inlined
def add_vertex(frontier, x, y, distance, parent, corner):
    """Write a vertex in the first free row; return that row."""
    row = frontier.sizes[N_VERTICES]
    vertex = frontier.vertices[row]
    vertex[X], vertex[Y], vertex[DISTANCE] = x, y, distance
    vertex[PARENT], vertex[CORNER] = parent, corner
    frontier.sizes[N_VERTICES] += 1
    return row


@inlined
def add_node(slabs, frontier, root, lx, ly, rx, ry, portal, up):
    """
    Write the node of a root vertex and a cone through a portal in the first free row.

    The cone lies between the bounds through (lx, ly) and (rx, ry) and opens up (``up`` = 1) or
    down (-1). Nothing is written where the slab beyond the portal is not open. The node is not on
    the heap yet: see ``push_new``.
    """
    if frontier.is_open[slabs.portals[portal, 4] if up == 1 else slabs.portals[portal, 3]]:
        node = frontier.nodes[frontier.sizes[N_NODES]]
        node[ROOT], node[PORTAL], node[UP] = root, portal, up
        node[LEFT_X], node[LEFT_Y], node[RIGHT_X], node[RIGHT_Y] = lx, ly, rx, ry
        frontier.sizes[N_NODES] += 1


@inlined
def push_new(slabs, frontier, target, first):
    """Push the nodes from row ``first`` on on the heap, with their estimates."""
    for row in range(first, frontier.sizes[N_NODES]):
        add_open(frontier, _estimate(slabs, frontier, target, row), row)


@inlined
def _estimate(slabs, frontier, target, row):
    """
    Return a lower bound on the length of paths to the target through the cone of a node.

    A target behind the portal's line counts as its mirror image beyond it.
    """
    node = frontier.nodes[row]
    vertex, line = frontier.vertices[int(node[ROOT])], float(slabs.portals[int(node[PORTAL]), 2])
    x, y, up = vertex[X], vertex[Y], node[UP]
    lx, ly, rx, ry = node[LEFT_X], node[LEFT_Y], node[RIGHT_X], node[RIGHT_Y]
    goal_x, goal_y = target.x, target.y
    if up * (goal_y - line) <= 0.0:
        goal_y = 2.0 * line - goal_y
    if y == line:
        at = min(max(x, lx), rx)
        rest = abs(at - x) + length_of(goal_x - at, goal_y - line)
    elif up * side_of(x, y, lx, ly, goal_x, goal_y) > 0.0:
        at = _crossing(x, y, lx, ly, line)
        rest = length_of(at - x, line - y) + length_of(goal_x - at, goal_y - line)
    elif up * side_of(x, y, rx, ry, goal_x, goal_y) < 0.0:
        at = _crossing(x, y, rx, ry, line)
        rest = length_of(at - x, line - y) + length_of(goal_x - at, goal_y - line)
    else:
        rest = length_of(goal_x - x, goal_y - y)
    if target.radius > 0.0:
        left, right = _crossing(x, y, lx, ly, line), _crossing(x, y, rx, ry, line)
        near = min(max(x, left), right)
        rest = max(rest - target.radius, length_of(near - x, line - y))
    return vertex[DISTANCE] + rest


@inlined
def side_of(ax, ay, bx, by, px, py):
    """Return a number > 0 where ``p`` is left of the line from ``a`` to ``b``, < 0 right of it."""
    return (bx - ax) * (py - ay) - (by - ay) * (px - ax)


@inlined
def length_of(x, y):
    """Return the length of the vector (x, y), whose square is no overflow."""
    return math.sqrt(x * x + y * y)


@inlined
def _crossing(x, y, bx, by, line):
    """Return the x at which the ray from (x, y) through (bx, by) meets the height ``line``."""
    return float(bx) if by == line else x + (bx - x) * (line - y) / (by - y)
