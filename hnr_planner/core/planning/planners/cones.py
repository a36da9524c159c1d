"""
Cones: the search nodes of Polyanya on slabs, their expansion, and the heap of those that are open.

A node is a root, the last corner at which the path bends, and the part of a portal that the root
sees: the cone between two bounds, through that portal into the next slab. Corners and the ends of
portals are whole numbers, and a cone is kept by the points that bound it, so whether a corner lies
in a cone is the sign of an exact product.

Cones are closed, so that a path may touch corners on both sides; left and right are those of the
grid, whichever way a cone opens.
"""

import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.grid.slabs import LEFT, RIGHT, slab_at, THROUGH
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
#: Ratio of two distances from which on the one counts as the shorter.
NEARER = 1.0 - 1e-13


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
        Slabs that a way may lead through: all but dead ends that hold neither start nor goal.
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
def open_frontier(slabs, start, goal, room):
    """Return the state of a search from ``start`` to ``goal`` (2,), free and off grid lines."""
    frontier = Frontier(
        np.empty((room, 7)),
        np.empty((room, 5)),
        np.empty(room),
        np.empty(room, dtype=np.int64),
        np.full(2 * len(slabs.portals), np.inf),
        slabs.exits == THROUGH,
        np.zeros(4, dtype=np.int64),
    )
    frontier.sizes[FINAL] = NONE
    _add_vertex(frontier, start[0], start[1], 0.0, NONE, NONE)
    slab, goal_slab = slab_at(slabs, start[0], start[1]), slab_at(slabs, goal[0], goal[1])
    _open_way_out(slabs, frontier, slab)
    _open_way_out(slabs, frontier, goal_slab)
    if slab == goal_slab:
        _push(frontier, math.hypot(goal[0] - start[0], goal[1] - start[1]), NONE)
        return frontier
    for up in (1, -1):
        edge = slabs.above if up == 1 else slabs.below
        for k in range(edge[slab, 0], edge[slab, 1]):
            left, right, y = slabs.portals[k, 0], slabs.portals[k, 1], slabs.portals[k, 2]
            _add_node(slabs, frontier, goal, 0, left, y, right, y, k, up)
    return frontier


@kernel
def _open_way_out(slabs, frontier, slab):
    """Open the slabs that lead out of the dead end that holds ``slab``."""
    while not frontier.is_open[slab]:
        frontier.is_open[slab] = True
        slab = slabs.exits[slab]


@kernel
def room_at(slabs, start):
    """Return how many rows the first nodes of a search from a point need."""
    slab = slab_at(slabs, start[0], start[1])
    above = slabs.above[slab, 1] - slabs.above[slab, 0]
    return above + slabs.below[slab, 1] - slabs.below[slab, 0] + 2


@kernel
def expand(slabs, frontier, goal, goal_slab, n_iterations):
    """
    Expand at most ``n_iterations`` nodes, and return how many.

    It ends early when the goal is reached, no node is open, or there are no rows left.
    """
    slabs, frontier, goal = borrowed(slabs), borrowed(frontier), borrowed(goal)
    sizes, nodes, vertices = frontier.sizes, frontier.nodes, frontier.vertices
    for i in range(n_iterations):
        if _is_over(frontier):
            return i
        row = frontier.heap[0]
        portal, up = int(nodes[row, PORTAL]), int(nodes[row, UP])
        slab = slabs.portals[portal, 4] if up == 1 else slabs.portals[portal, 3]
        ahead = slabs.above if up == 1 else slabs.below
        back = slabs.below if up == 1 else slabs.above
        needed = 3 * (ahead[slab, 1] - ahead[slab, 0]) + 2 * (back[slab, 1] - back[slab, 0]) + 4
        if max(sizes[N_NODES], sizes[N_VERTICES]) + needed > len(nodes):
            return i
        _pop(frontier)
        root = int(nodes[row, ROOT])
        corner = int(vertices[root, CORNER])
        if corner != NONE and vertices[root, DISTANCE] > frontier.nearest[corner]:
            continue
        if slab == goal_slab:
            _reach_goal(slabs, frontier, goal, row)
        else:
            _expand_ahead(slabs, frontier, goal, row, ahead[slab, 0], ahead[slab, 1])
        for side in (LEFT, RIGHT):
            _expand_around(slabs, frontier, goal, row, side, slab, slab == goal_slab)
    _is_over(frontier)
    return n_iterations


@kernel
def _is_over(frontier):
    """Return whether no node is left to expand; note the goal where it comes first."""
    sizes = frontier.sizes
    if sizes[N_OPEN] > 0 and frontier.heap[0] <= NONE:
        sizes[FINAL] = NONE - frontier.heap[0]
    return sizes[N_OPEN] == 0 or sizes[FINAL] != NONE


@kernel
def _side_of(ax, ay, bx, by, px, py):
    """Return a number > 0 where ``p`` is left of the line from ``a`` to ``b``, < 0 right of it."""
    return (bx - ax) * (py - ay) - (by - ay) * (px - ax)


@kernel
def _expand_ahead(slabs, frontier, goal, row, first, last):
    """Add the nodes that the root of node ``row`` sees on the far edge of the slab."""
    nodes, vertices = frontier.nodes, frontier.vertices
    up, root = int(nodes[row, UP]), int(nodes[row, ROOT])
    x, y = vertices[root, X], vertices[root, Y]
    lx, ly, rx, ry = (
        nodes[row, LEFT_X],
        nodes[row, LEFT_Y],
        nodes[row, RIGHT_X],
        nodes[row, RIGHT_Y],
    )
    for k in range(first, last):
        left, right, line = slabs.portals[k, 0], slabs.portals[k, 1], slabs.portals[k, 2]
        if up * _side_of(x, y, lx, ly, right, line) > 0.0:
            continue
        if up * _side_of(x, y, rx, ry, left, line) < 0.0:
            break
        a, b, c, d = lx, ly, rx, ry
        if up * _side_of(x, y, lx, ly, left, line) <= 0.0:
            a, b = left, line
        if up * _side_of(x, y, rx, ry, right, line) >= 0.0:
            c, d = right, line
        _add_node(slabs, frontier, goal, root, a, b, c, d, k, up)


@kernel
def _expand_around(slabs, frontier, goal, row, side, slab, holds_goal):
    """Add what lies beyond a bend at the corner on one side of node ``row``."""
    nodes, vertices = frontier.nodes, frontier.vertices
    up, root, portal = int(nodes[row, UP]), int(nodes[row, ROOT]), int(nodes[row, PORTAL])
    x, y = vertices[root, X], vertices[root, Y]
    cx, cy = slabs.portals[portal, side], slabs.portals[portal, 2]
    bound_x, bound_y = nodes[row, LEFT_X + 2 * side], nodes[row, LEFT_Y + 2 * side]
    is_corner = slabs.steps[portal, side, 0] != 0
    if not is_corner or bound_x != cx or bound_y != cy or (x == cx and y == cy):
        return
    vertex = _reach_corner(frontier, root, cx, cy, 2 * portal + side)
    if vertex == NONE:
        return
    outwards = up if side == LEFT else -up  # the sign of what lies beyond the bound
    if holds_goal:
        if outwards * _side_of(x, y, cx, cy, goal[0], goal[1]) > 0.0:
            rest = math.hypot(goal[0] - cx, goal[1] - cy)
            _push(frontier, vertices[vertex, DISTANCE] + rest, NONE - vertex)
        return
    ahead = slabs.above if up == 1 else slabs.below
    for k in range(ahead[slab, 0], ahead[slab, 1]):
        line = slabs.portals[k, 2]
        outer, inner = slabs.portals[k, side], slabs.portals[k, 1 - side]
        if outwards * _side_of(x, y, cx, cy, outer, line) <= 0.0:
            continue
        ix, iy = float(inner), float(line)
        if outwards * _side_of(x, y, cx, cy, inner, line) < 0.0:
            ix, iy = 2.0 * cx - x, 2.0 * cy - y
        if side == LEFT:
            _add_node(slabs, frontier, goal, vertex, outer, line, ix, iy, k, up)
        else:
            _add_node(slabs, frontier, goal, vertex, ix, iy, outer, line, k, up)
    back = slabs.below if up == 1 else slabs.above
    for k in range(back[slab, 0], back[slab, 1]):
        left, right = slabs.portals[k, 0], slabs.portals[k, 1]
        near_side = RIGHT if side == LEFT else LEFT
        near = slabs.portals[k, near_side]
        if (near < cx) if side == LEFT else (near > cx):
            turn = _reach_corner(frontier, vertex, near, cy, 2 * k + near_side)
            if turn != NONE:
                _add_node(slabs, frontier, goal, turn, left, cy, right, cy, k, -up)


@kernel
def _reach_goal(slabs, frontier, goal, row):
    """Open the goal in the slab that node ``row`` leads into, where its root sees it."""
    nodes, vertices = frontier.nodes, frontier.vertices
    up, root = int(nodes[row, UP]), int(nodes[row, ROOT])
    x, y = vertices[root, X], vertices[root, Y]
    left = up * _side_of(x, y, nodes[row, LEFT_X], nodes[row, LEFT_Y], goal[0], goal[1])
    right = up * _side_of(x, y, nodes[row, RIGHT_X], nodes[row, RIGHT_Y], goal[0], goal[1])
    if left <= 0.0 <= right:
        rest = math.hypot(goal[0] - x, goal[1] - y)
        _push(frontier, vertices[root, DISTANCE] + rest, NONE - root)


@kernel
def _reach_corner(frontier, root, x, y, corner):
    """Add the vertex at a corner reached from ``root``; NONE where a shorter way is known."""
    vertices = frontier.vertices
    distance = vertices[root, DISTANCE] + math.hypot(x - vertices[root, X], y - vertices[root, Y])
    if distance >= NEARER * frontier.nearest[corner]:
        return NONE
    frontier.nearest[corner] = distance
    return _add_vertex(frontier, x, y, distance, root, corner)


@kernel
def _add_vertex(frontier, x, y, distance, parent, corner):
    """Write a vertex in the first free row; return that row."""
    row = frontier.sizes[N_VERTICES]
    vertex = frontier.vertices[row]
    vertex[X], vertex[Y], vertex[DISTANCE] = x, y, distance
    vertex[PARENT], vertex[CORNER] = parent, corner
    frontier.sizes[N_VERTICES] += 1
    return row


@kernel
def _add_node(slabs, frontier, goal, root, lx, ly, rx, ry, portal, up):
    """Open the node of a root and the cone between two bounds through a portal."""
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
    _push(frontier, vertex[DISTANCE] + rest, row)


@kernel
def _crossing(x, y, bx, by, line):
    """Return where the ray from ``(x, y)`` through a bound meets a horizontal line."""
    return float(bx) if by == line else x + (bx - x) * (line - y) / (by - y)


@kernel
def _push(frontier, estimate, row):
    """Put a row on the heap."""
    estimates, heap = frontier.estimates, frontier.heap
    k = frontier.sizes[N_OPEN]
    frontier.sizes[N_OPEN] += 1
    while k > 0 and estimates[(k - 1) // 2] > estimate:
        estimates[k], heap[k] = estimates[(k - 1) // 2], heap[(k - 1) // 2]
        k = (k - 1) // 2
    estimates[k], heap[k] = estimate, row


@kernel
def _pop(frontier):
    """Take the row of the least estimate off the heap."""
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
