"""
Extensions of search trees towards poses, and connections between two trees.

An extension follows the cheapest connection from the nearest vertex, up to the exact contact with
an obstacle.
"""

import math

from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import uniform
from hnr_planner.core.planning.poses.connections import (
    connect,
    connection_is_free,
    is_seen_blocked,
    N_KEPT,
)
from hnr_planner.core.planning.poses.steps import add_vertex, driving_sign, has_room, SHORTEST
from hnr_planner.core.spaces.poses.data import first_contact_of
from hnr_planner.core.spaces.poses.motion import moved, wrapped
from hnr_planner.core.spaces.primitives import contains
from hnr_planner.core.trees import NONE

#: Number of vertices of the other tree that a new vertex is connected with.
N_NEAREST = 3
#: Number of connections between two poses that are tested, the cheapest first.
N_TESTED = N_KEPT - 1
#: Probability that an extension which meets an obstacle ends before it, where there is room; a
#: robot that needs room to get on always does.
BEFORE = 0.5


@kernel
def join_rows(problem, trees, first, last):
    """Return the index of a free connection from row ``first`` to ``last``, or ``NONE``."""
    return free_connection(problem, trees.poses[first], trees.poses[last], 1.0, trees.found)


@kernel
def free_connection(problem, begin, end, driven, found):
    """
    Return the index in ``found`` of the cheapest free connection between poses, or ``NONE``.

    Few of the cheapest are tested. ``driven`` is that of ``connect``.
    """
    space = problem.space
    connect(space, problem.prices, begin, end, driven, found)
    for k in range(N_TESTED):
        twists, n = found.twists[k], found.sizes[k]
        if (
            found.costs[k] < math.inf
            and not is_seen_blocked(space, begin, twists, n)
            and connection_is_free(space, begin, twists, n)
        ):
            return k
    return NONE


@kernel
def _choose(n, rng):
    """Return an index below ``n``: 0 with probability 1/2, else a uniform one."""
    draw = uniform(rng)
    return 0 if draw < 0.5 else min(math.floor(n * (2.0 * draw - 1.0)), n - 1)


@kernel
def find_nearest(problem, trees, tree, size, pose):
    """Write the rows of a tree that are nearest to ``pose`` (3,); return their number."""
    n, nearest, gaps = 0, trees.nearest, trees.gaps
    # The tree of the goal is reached from the pose, that of the start leads to it.
    lead = problem.lead if tree == 0 else -problem.lead
    lead_x, lead_y = lead * math.cos(pose[2]), lead * math.sin(pose[2])
    for row in range(size):
        if trees.owners[row] != tree:
            continue
        dx, dy = trees.poses[row, 0] - pose[0], trees.poses[row, 1] - pose[1]
        if lead != 0.0:
            yaw = trees.poses[row, 2]
            dx += lead * math.cos(yaw) + lead_x
            dy += lead * math.sin(yaw) + lead_y
        turn = abs(wrapped(trees.poses[row, 2] - pose[2]))
        gap = math.sqrt(dx * dx + dy * dy) + problem.weight * turn
        if n == N_NEAREST and gap >= gaps[n - 1]:
            continue
        k = n if n < N_NEAREST else n - 1
        while k > 0 and gap < gaps[k - 1]:
            gaps[k], nearest[k] = gaps[k - 1], nearest[k - 1]
            k -= 1
        gaps[k], nearest[k] = gap, row
        n = min(n + 1, N_NEAREST)
    return n


@kernel
def extend(problem, trees, tree, size, rng):
    """
    Extend a tree towards the pose in ``trees.work[0]``.

    Return the number of vertices, and whether the pose is reached.
    """
    space, found, target = problem.space, trees.found, trees.work[0]
    # Mostly from the nearest vertex by the cheapest connection, which may be blocked for ever.
    row = trees.nearest[_choose(find_nearest(problem, trees, tree, size, target), rng)]
    driven = driving_sign(tree)
    connect(space, problem.prices, trees.poses[row], target, driven, found)
    n_found = 0
    while n_found < N_KEPT and found.costs[n_found] < math.inf:
        n_found += 1
    if n_found == 0:
        return size, False
    chosen = _choose(n_found, rng)
    for k in range(found.sizes[chosen]):
        motion = found.twists[chosen, k]
        vx, vy, omega = motion[0], motion[1], motion[2]
        x, y, yaw = trees.poses[row, 0], trees.poses[row, 1], trees.poses[row, 2]
        reached = first_contact_of(space, x, y, yaw, vx, vy, omega, 1.0)
        share = 1.0
        if reached <= 1.0:
            length = math.hypot(vx, vy) + abs(omega) * space.reach
            share = reached - problem.margin / length
            if share * length < SHORTEST:
                return size, False
            if problem.room > 0.0 or uniform(rng) < BEFORE:
                share *= uniform(rng)
        at_x, at_y, at_yaw = moved(x, y, yaw, vx, vy, omega, share)
        pose = trees.poses[size]
        pose[0], pose[1], pose[2] = at_x, at_y, wrapped(at_yaw)
        if not contains(space, pose):
            return size, False
        is_last = reached <= 1.0 or k == found.sizes[chosen] - 1
        if is_last and not has_room(problem, tree, pose):
            return size, False
        twist = trees.twists[size]
        twist[0], twist[1], twist[2] = share * vx, share * vy, share * omega
        row = add_vertex(trees, tree, row, size)
        size += 1
        if reached <= 1.0:
            return size, False
    return size, True
