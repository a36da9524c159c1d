"""
Expansion of the search nodes of Polyanya: the cones that continue a cone beyond its portal.

Of every portal on the far edge of the slab an interval may be visible from the node's root. Where
a bound of the cone is a corner of an obstacle, the shortest path may also bend there and reach
points beyond the bound.
"""

import math

from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.planning.planners.cones import (
    add_node,
    add_vertex,
    CORNER,
    DISTANCE,
    is_over,
    LEFT_X,
    LEFT_Y,
    N_NODES,
    N_VERTICES,
    NONE,
    pop,
    PORTAL,
    push,
    RIGHT_X,
    RIGHT_Y,
    ROOT,
    UP,
    X,
    Y,
)
from hnr_planner.core.spaces.grid.slabs import LEFT, RIGHT

#: Ratio of the length of a path to that of another below which the former counts as shorter.
NEARER = 1.0 - 1e-13


@kernel
def expand(slabs, frontier, goal, goal_slab, n_iterations):
    """
    Expand at most ``n_iterations`` nodes in the order of their estimates; return how many.

    It ends early when the shortest path to ``goal`` (2,) is found, no node is open, or the arrays
    of ``frontier`` may have too few rows for the next node.
    """
    slabs, frontier, goal = borrowed(slabs), borrowed(frontier), borrowed(goal)
    sizes, nodes, vertices = frontier.sizes, frontier.nodes, frontier.vertices
    for i in range(n_iterations):
        if is_over(frontier):
            return i
        row = frontier.heap[0]
        portal, up = int(nodes[row, PORTAL]), int(nodes[row, UP])
        slab = slabs.portals[portal, 4] if up == 1 else slabs.portals[portal, 3]
        ahead = slabs.above if up == 1 else slabs.below
        back = slabs.below if up == 1 else slabs.above
        needed = 3 * (ahead[slab, 1] - ahead[slab, 0]) + 2 * (back[slab, 1] - back[slab, 0]) + 4
        if max(sizes[N_NODES], sizes[N_VERTICES]) + needed > len(nodes):
            return i
        pop(frontier)
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
    is_over(frontier)
    return n_iterations


@kernel
def _expand_ahead(slabs, frontier, goal, row, first, last):
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
        if up * _side_of(x, y, lx, ly, right, line) > 0.0:
            continue
        if up * _side_of(x, y, rx, ry, left, line) < 0.0:
            break
        a, b, c, d = lx, ly, rx, ry
        if up * _side_of(x, y, lx, ly, left, line) <= 0.0:
            a, b = left, line
        if up * _side_of(x, y, rx, ry, right, line) >= 0.0:
            c, d = right, line
        add_node(slabs, frontier, goal, root, a, b, c, d, k, up)


@kernel
def _expand_around(slabs, frontier, goal, row, side, slab, holds_goal):
    """
    Add the nodes, or the goal, beyond a bend at the corner on one side of node ``row``.

    Nothing is added where the bound of the cone on that side is no corner of an obstacle, or a
    shorter path to the corner is known. ``holds_goal`` states whether ``slab`` holds the goal.
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
    if holds_goal:
        if outwards * _side_of(x, y, cx, cy, goal[0], goal[1]) > 0.0:
            rest = math.hypot(goal[0] - cx, goal[1] - cy)
            push(frontier, vertices[vertex, DISTANCE] + rest, NONE - vertex)
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
            add_node(slabs, frontier, goal, vertex, outer, line, ix, iy, k, up)
        else:
            add_node(slabs, frontier, goal, vertex, ix, iy, outer, line, k, up)
    back = slabs.below if up == 1 else slabs.above
    for k in range(back[slab, 0], back[slab, 1]):
        left, right = slabs.portals[k, 0], slabs.portals[k, 1]
        near_side = RIGHT if side == LEFT else LEFT
        near = slabs.portals[k, near_side]
        if (near < cx) if side == LEFT else (near > cx):
            turn = _reach_corner(frontier, vertex, near, cy, 2 * k + near_side)
            if turn != NONE:
                add_node(slabs, frontier, goal, turn, left, cy, right, cy, k, -up)


@kernel
def _reach_goal(slabs, frontier, goal, row):
    """Push the goal on the heap where it lies in the cone of node ``row``."""
    nodes, vertices = frontier.nodes, frontier.vertices
    up, root = int(nodes[row, UP]), int(nodes[row, ROOT])
    x, y = vertices[root, X], vertices[root, Y]
    left = up * _side_of(x, y, nodes[row, LEFT_X], nodes[row, LEFT_Y], goal[0], goal[1])
    right = up * _side_of(x, y, nodes[row, RIGHT_X], nodes[row, RIGHT_Y], goal[0], goal[1])
    if left <= 0.0 <= right:
        rest = math.hypot(goal[0] - x, goal[1] - y)
        push(frontier, vertices[root, DISTANCE] + rest, NONE - root)


@kernel
def _reach_corner(frontier, root, x, y, corner):
    """
    Add the vertex at corner ``corner``, at (x, y), reached from row ``root``; return its row.

    Returns NONE (-1) and adds nothing where a path to the corner that is no longer is known.
    """
    vertices = frontier.vertices
    distance = vertices[root, DISTANCE] + math.hypot(x - vertices[root, X], y - vertices[root, Y])
    if distance >= NEARER * frontier.nearest[corner]:
        return NONE
    frontier.nearest[corner] = distance
    return add_vertex(frontier, x, y, distance, root, corner)


@kernel
def _side_of(ax, ay, bx, by, px, py):
    """Return a number > 0 where ``p`` is left of the line from ``a`` to ``b``, < 0 right of it."""
    return (bx - ax) * (py - ay) - (by - ay) * (px - ax)
