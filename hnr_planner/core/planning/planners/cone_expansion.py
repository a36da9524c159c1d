"""
Expansion of the search nodes of Polyanya: the cones that continue a cone beyond its portal.

Of every portal on the far edge of the slab an interval may be visible from the node's root. Where
a bound of the cone is a corner of an obstacle, the shortest path may also bend there and reach
points beyond the bound.
"""

from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.planning.planners.cones import (
    add_node,
    add_vertex,
    AT_ONCE,
    CORNER,
    DISTANCE,
    empty_frontier,
    is_over,
    LEFT_X,
    LEFT_Y,
    length_of,
    N_NODES,
    N_VERTICES,
    NONE,
    open_frontier,
    PORTAL,
    push_new,
    reach_disc,
    RIGHT_X,
    RIGHT_Y,
    ROOT,
    side_of,
    UP,
    X,
    Y,
)
from hnr_planner.core.planning.planners.heap import add_open, close_hole, N_OPEN, take_first
from hnr_planner.core.planning.planners.target import holds_target, make_target
from hnr_planner.core.spaces.grid.slabs import LEFT, RIGHT
import numpy as np

#: Ratio of the length of a path to that of another below which the former counts as shorter.
NEARER = 1.0 - 1e-13


@kernel
def begin(slabs, start, goal, radius, margin, rows, n_iterations):
    """
    Begin a search and expand its first nodes; return (frontier, target, number of expansions).

    Parameters
    ----------
    slabs : Slabs
        The slabs of the grid.
    start, goal : (2,)
        Start, and goal or centre of the goal region, kernel frame.
    radius, margin : float
        Radius of the goal region, 0 for none, and margin of the space [cells].
    rows : int
        Rows of the arrays of the frontier.
    n_iterations : int
        Largest number of expansions.

    """
    target = make_target(slabs, goal, radius, margin)
    frontier = empty_frontier(slabs, rows)
    open_frontier(slabs, frontier, start, target)
    return frontier, target, expand(slabs, frontier, target, n_iterations)


@kernel
def expand(slabs, frontier, target, n_iterations):
    """
    Expand at most ``n_iterations`` nodes in the order of their estimates; return how many.

    A node with a single successor is replaced by it at once, up to the next node with more: that
    counts as one expansion. The work ends early when the shortest path to ``target`` is found, no
    node is open, or the arrays of ``frontier`` may have too few rows for the next node.
    """
    slabs, frontier = borrowed(slabs), borrowed(frontier)
    sizes, vertices = frontier.sizes, frontier.vertices
    for i in range(n_iterations):
        if is_over(frontier):
            return i
        rows = max(sizes[N_NODES], sizes[N_VERTICES], sizes[N_OPEN]) + sizes[AT_ONCE]
        if rows > len(frontier.nodes):
            return i
        row = take_first(frontier)
        root = int(frontier.nodes[row, ROOT])
        corner = int(vertices[root, CORNER])
        if corner != NONE and vertices[root, DISTANCE] > frontier.nearest[corner]:
            close_hole(frontier)
            continue
        while _replace_node(slabs, frontier, target, row):
            pass
        close_hole(frontier)
    is_over(frontier)
    return n_iterations


@inlined
def _replace_node(slabs, frontier, target, row):
    """
    Add the successors of node ``row``; return whether there is one only, now in that row.

    Otherwise the successors, and the target where it is reached, are on the heap.
    """
    sizes, nodes = frontier.sizes, frontier.nodes
    first, n_open, n_vertices = sizes[N_NODES], sizes[N_OPEN], sizes[N_VERTICES]
    portal, up = int(nodes[row, PORTAL]), int(nodes[row, UP])
    slab = slabs.portals[portal, 4] if up == 1 else slabs.portals[portal, 3]
    holds = holds_target(slabs, target, slab)
    if holds:
        _reach_target(slabs, frontier, target, row, slab)
    if slab != target.slab:
        ahead = slabs.above if up == 1 else slabs.below
        _expand_ahead(slabs, frontier, row, ahead[slab, 0], ahead[slab, 1])
    for side in (LEFT, RIGHT):
        _expand_around(slabs, frontier, target, row, side, slab, holds)
    is_single = sizes[N_NODES] == first + 1
    if is_single and sizes[N_OPEN] == n_open and sizes[N_VERTICES] == n_vertices:
        for i in range(nodes.shape[1]):
            nodes[row, i] = nodes[first, i]
        sizes[N_NODES] = first
        return True
    push_new(slabs, frontier, target, first)
    return False


@inlined
def _expand_ahead(slabs, frontier, row, first, last):
    """Add nodes for the portals ``first`` to ``last`` - 1 that lie in the cone of node ``row``."""
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
        if up * side_of(x, y, lx, ly, right, line) > 0.0:
            continue
        if up * side_of(x, y, rx, ry, left, line) < 0.0:
            break
        a, b, c, d = lx, ly, rx, ry
        if up * side_of(x, y, lx, ly, left, line) <= 0.0:
            a, b = left, line
        if up * side_of(x, y, rx, ry, right, line) >= 0.0:
            c, d = right, line
        add_node(slabs, frontier, root, a, b, c, d, k, up)


@inlined
def _expand_around(slabs, frontier, target, row, side, slab, holds):
    """
    Add the nodes, and the target, beyond a bend at the corner on one side of node ``row``.

    Nothing is added where the bound of the cone on that side is no corner of an obstacle, or a
    shorter path to the corner is known. ``holds`` states whether ``slab`` holds the target.
    """
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
    if slab == target.slab:
        if outwards * side_of(x, y, cx, cy, target.x, target.y) > 0.0:
            rest = length_of(target.x - cx, target.y - cy)
            add_open(frontier, vertices[vertex, DISTANCE] + rest, NONE - vertex)
        return
    if holds:
        reach_disc(slabs, frontier, target, vertex, slab, np.empty((0, 4)))
    ahead = slabs.above if up == 1 else slabs.below
    for k in range(ahead[slab, 0], ahead[slab, 1]):
        line = slabs.portals[k, 2]
        outer, inner = slabs.portals[k, side], slabs.portals[k, 1 - side]
        if outwards * side_of(x, y, cx, cy, outer, line) <= 0.0:
            continue
        ix, iy = float(inner), float(line)
        if outwards * side_of(x, y, cx, cy, inner, line) < 0.0:
            ix, iy = 2.0 * cx - x, 2.0 * cy - y
        if side == LEFT:
            add_node(slabs, frontier, vertex, outer, line, ix, iy, k, up)
        else:
            add_node(slabs, frontier, vertex, ix, iy, outer, line, k, up)
    back = slabs.below if up == 1 else slabs.above
    for k in range(back[slab, 0], back[slab, 1]):
        left, right = slabs.portals[k, 0], slabs.portals[k, 1]
        near_side = RIGHT if side == LEFT else LEFT
        near = slabs.portals[k, near_side]
        if (near < cx) if side == LEFT else (near > cx):
            turn = _reach_corner(frontier, vertex, near, cy, 2 * k + near_side)
            if turn != NONE:
                add_node(slabs, frontier, turn, left, cy, right, cy, k, -up)


@inlined
def _reach_target(slabs, frontier, target, row, slab):
    """Push the target on the heap where it lies in the cone of node ``row`` and in ``slab``."""
    nodes, vertices = frontier.nodes, frontier.vertices
    up, root = int(nodes[row, UP]), int(nodes[row, ROOT])
    x, y = vertices[root, X], vertices[root, Y]
    lx, ly = nodes[row, LEFT_X], nodes[row, LEFT_Y]
    rx, ry = nodes[row, RIGHT_X], nodes[row, RIGHT_Y]
    if target.radius > 0.0:
        bounds = np.empty((2, 4))
        to, away = bounds[0], bounds[1]  # lines to the root and away from it, the cone on the left
        to[0], to[1], to[2], to[3] = (lx, ly, x, y) if up == 1 else (rx, ry, x, y)
        away[0], away[1], away[2], away[3] = (x, y, rx, ry) if up == 1 else (x, y, lx, ly)
        reach_disc(slabs, frontier, target, root, slab, bounds)
        return
    left = up * side_of(x, y, lx, ly, target.x, target.y)
    right = up * side_of(x, y, rx, ry, target.x, target.y)
    if left <= 0.0 <= right:
        rest = length_of(target.x - x, target.y - y)
        add_open(frontier, vertices[root, DISTANCE] + rest, NONE - root)


@inlined
def _reach_corner(frontier, root, x, y, corner):
    """
    Add the vertex at corner ``corner``, at (x, y), reached from row ``root``; return its row.

    Returns NONE (-1) and adds nothing where a path to the corner that is no longer is known.
    """
    vertices = frontier.vertices
    distance = vertices[root, DISTANCE] + length_of(x - vertices[root, X], y - vertices[root, Y])
    if distance >= NEARER * frontier.nearest[corner]:
        return NONE
    frontier.nearest[corner] = distance
    return add_vertex(frontier, x, y, distance, root, corner)
