"""
Search for a path of poses by one or two trees of motions.

Every transition extends a tree by one of four proposals: towards a pose along the *guide* (a
shortest path of the disc inside the footprint), towards a uniform pose, by a step of Hit-and-Run
along a random twist, or by a *shuffle*, strokes back and forth that turn the robot where there is
little room. An extension towards a pose follows the cheapest connection from
the nearest vertex, up to the exact contact with an obstacle. Then the new vertex is connected with
the nearest vertices of the other tree. How often each proposal is made, and whether the goal has a
tree that grows, distinguishes the planners.
"""

import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream, uniform
from hnr_planner.core.planning.poses.connections import (
    connect,
    connection_is_free,
    Connections,
    is_seen_blocked,
    N_KEPT,
    Prices,
)
from hnr_planner.core.planning.poses.guide import draw_along_guide
from hnr_planner.core.planning.poses.steps import (
    add_vertex,
    hit_and_run_step,
    SHORTEST,
    shuffle,
)
from hnr_planner.core.spaces.poses.data import first_contact_of, PoseData
from hnr_planner.core.spaces.poses.motion import moved, wrapped
from hnr_planner.core.spaces.primitives import contains
from hnr_planner.core.trees import NONE
import numpy as np
from numpy.typing import NDArray

#: Number of vertices of the other tree that a new vertex is connected with; where they are far,
#: more than ``NEAR`` strides, the nearest alone.
N_NEAREST, NEAR = 3, 8.0
#: Probability that an extension which meets an obstacle ends before it, where there is room.
BEFORE = 0.5
#: Factors on the distance that a tree tries to get along the guide, where it got there or not.
FARTHER, NEARER = 2.0, 1.3


class Proposals(NamedTuple):
    """
    How a planner extends its trees.

    Attributes
    ----------
    guided, uniform, shuffle : float
        Probabilities of a pose along the guide, of a uniform pose, and of strokes back and forth;
        else a step of Hit-and-Run is made.
    from_newest : bool
        Whether a step of Hit-and-Run begins at the newest vertex, which makes the tree a chain;
        else it begins at a uniform vertex.
    n_trees : int
        2 where the tree of the goal grows as well, else 1.

    """

    guided: float
    uniform: float
    shuffle: float
    from_newest: bool
    n_trees: int


class PoseProblem(NamedTuple):
    """
    A request for a path of poses, as kernels take it; all lengths in cells.

    Attributes
    ----------
    space : PoseData
        The free poses.
    prices : Prices
        What motions cost.
    lower, upper : (3,)
        Bounds of the poses.
    guide : (k, 3)
        Points (x, y) and the length of the guide up to each; (0, 3) for none.
    disc : (2,)
        Centre of the disc that follows the guide, in the robot's frame.
    weight : float
        Distance [cells] that counts as much as a turn of 1 rad, for the nearest vertex.
    margin : float
        Distance [cells] before a contact at which a motion stops.

    """

    space: PoseData
    prices: Prices
    lower: Floats
    upper: Floats
    guide: Floats
    disc: Floats
    weight: float
    margin: float


class PoseTrees(NamedTuple):
    """
    Both trees in one table, the start's vertices and the goal's in the order of their growth.

    Attributes
    ----------
    poses : (rows, 3)
        Vertices.
    twists : (rows, 3)
        Motion from the parent to each vertex.
    parents, owners : (rows,) int64
        Row of the parent, ``NONE`` for a root; 0 for the start's tree, 1 for the goal's.
    found : Connections
        Work arrays for connections.
    nearest : (N_NEAREST,) int64
        Work array: rows of the nearest vertices, the nearest first.
    gaps : (N_NEAREST,)
        Work array: their distances.
    work : (3, 3)
        Work arrays for poses and twists.
    progress : (2,)
        Length of the guide up to the farthest pose along it that each tree has reached.
    ahead : (2,)
        How far beyond that each tree tries to get along the guide [cells].

    """

    poses: Floats
    twists: Floats
    parents: NDArray[np.int64]
    owners: NDArray[np.int64]
    found: Connections
    nearest: NDArray[np.int64]
    gaps: Floats
    work: Floats
    progress: Floats
    ahead: Floats


@kernel
def grow(
    problem: PoseProblem,
    proposals: Proposals,
    trees: PoseTrees,
    size: int,
    turn: int,
    n_iterations: int,
    rng: Stream,
) -> tuple[int, int, int, int, int]:
    """
    Extend the trees by at most ``n_iterations`` transitions.

    ``size`` is the number of vertices, ``turn`` the number of transitions before. Returns (number
    of vertices, transitions, row of the start's tree, row of the goal's, index in ``trees.found``
    of the connection that joins them); the rows are ``NONE`` where the trees are not joined.
    """
    problem, trees, rng = borrowed(problem), borrowed(trees), borrowed(rng)
    if turn == 0:
        for row in range(size):
            if trees.owners[row] == 1:
                k = _join(problem, trees, 0, row)
                if k != NONE:
                    return size, 0, 0, row, k
    for i in range(n_iterations):
        tree = (turn + i) % proposals.n_trees
        before, draw = size, uniform(rng)
        if draw < proposals.guided and len(problem.guide) > 1:
            along = draw_along_guide(problem, trees, tree, rng)
            size, is_reached = _extend(problem, trees, tree, size, rng)
            if (along > trees.progress[tree]) == (tree == 0):
                if is_reached:
                    trees.progress[tree] = along
                    trees.ahead[tree] *= FARTHER
                else:
                    trees.ahead[tree] = max(trees.ahead[tree] / NEARER, problem.space.stride)
        elif draw < proposals.guided + proposals.uniform:
            for k in range(3):
                low, high = problem.lower[k], problem.upper[k]
                trees.work[0, k] = low + (high - low) * uniform(rng)
            size, _ = _extend(problem, trees, tree, size, rng)
        elif draw < proposals.guided + proposals.uniform + proposals.shuffle:
            size = shuffle(problem, trees, tree, size, rng)
        else:
            size = hit_and_run_step(problem, trees, tree, size, proposals.from_newest, rng)
        if size == before:
            continue
        newest, other = size - 1, 1 - tree
        for m in range(_find_nearest(problem, trees, other, size, trees.poses[newest])):
            if m > 0 and trees.gaps[m] > NEAR * problem.space.stride:
                break
            near = trees.nearest[m]
            first, last = (newest, near) if tree == 0 else (near, newest)
            k = _join(problem, trees, first, last)
            if k != NONE:
                return size, i + 1, first, last, k
    return size, n_iterations, NONE, NONE, NONE


@kernel
def _join(problem, trees, first, last):
    """Return the index of a free connection from row ``first`` to ``last``, or ``NONE``."""
    found = trees.found
    connect(problem.space, problem.prices, trees.poses[first], trees.poses[last], 1.0, found)
    for k in range(N_KEPT - 1):
        begin, twists, n = trees.poses[first], found.twists[k], found.sizes[k]
        if (
            found.costs[k] < math.inf
            and not is_seen_blocked(problem.space, begin, twists, n)
            and connection_is_free(problem.space, begin, twists, n)
        ):
            return k
    return NONE


@kernel
def _choose(n, rng):
    """Return an index below ``n``: 0 with probability 1/2, else a uniform one."""
    draw = uniform(rng)
    return 0 if draw < 0.5 else min(math.floor(n * (2.0 * draw - 1.0)), n - 1)


@kernel
def _find_nearest(problem, trees, tree, size, pose):
    """Write the rows of a tree that are nearest to ``pose`` (3,); return their number."""
    n, nearest, gaps = 0, trees.nearest, trees.gaps
    for row in range(size):
        if trees.owners[row] != tree:
            continue
        dx, dy = trees.poses[row, 0] - pose[0], trees.poses[row, 1] - pose[1]
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
def _extend(problem, trees, tree, size, rng):
    """
    Extend a tree towards the pose in ``trees.work[0]``.

    Return the number of vertices, and whether the pose is reached.
    """
    space, found, target = problem.space, trees.found, trees.work[0]
    # Mostly from the nearest vertex by the cheapest connection, which may be blocked for ever.
    row = trees.nearest[_choose(_find_nearest(problem, trees, tree, size, target), rng)]
    driven = 1.0 if tree == 0 else -1.0
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
            if uniform(rng) < BEFORE:
                share *= uniform(rng)
        at_x, at_y, at_yaw = moved(x, y, yaw, vx, vy, omega, share)
        pose = trees.poses[size]
        pose[0], pose[1], pose[2] = at_x, at_y, wrapped(at_yaw)
        if not contains(space, pose):
            return size, False
        twist = trees.twists[size]
        twist[0], twist[1], twist[2] = share * vx, share * vy, share * omega
        row = add_vertex(trees, tree, row, size)
        size += 1
        if reached <= 1.0:
            return size, False
    return size, True
