"""
Search for a path of poses by one or two trees of motions.

Before the first transition the trees are connected along the *guide*, a shortest path of the disc
inside the footprint, where that is easy (``first_attempt``). Every transition extends a tree by
one of four proposals: towards a pose along the guide, towards a uniform pose, by a step of
Hit-and-Run along a random twist, or by a *shuffle*, strokes back and forth that turn the robot
where there is little room. An extension towards a pose follows the cheapest connection from the
nearest vertex, up to the exact contact with an obstacle. Then the new vertex is connected with the
nearest vertices of the other tree. How often each proposal is made, and whether the goal has a
tree that grows, distinguishes the planners.
"""

from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream, uniform
from hnr_planner.core.planning.poses.attempt import first_attempt
from hnr_planner.core.planning.poses.connections import Connections, Prices
from hnr_planner.core.planning.poses.extensions import extend, find_nearest, join_rows
from hnr_planner.core.planning.poses.guide import draw_along_guide
from hnr_planner.core.planning.poses.steps import hit_and_run_step, shuffle
from hnr_planner.core.spaces.poses.data import PoseData
from hnr_planner.core.trees import NONE
import numpy as np
from numpy.typing import NDArray

#: Distance of vertices of the other tree, in strides, beyond which a new vertex is connected with
#: the nearest of them alone.
NEAR = 8.0
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
    lead : float
        How far [cells] ahead of the pose where a motion begins, and behind the pose where it ends,
        the places are whose distance makes a vertex the nearest. Above 0 it prefers vertices from
        which a car reaches the pose ahead without driving a loop.
    room : float
        How far [cells] the robot has to get on from a new vertex, ahead in the start's tree and
        back in the goal's; 0 where it may reverse and gets out of any place as it came.

    """

    space: PoseData
    prices: Prices
    lower: Floats
    upper: Floats
    guide: Floats
    disc: Floats
    weight: float
    margin: float
    lead: float
    room: float


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
        size, first, last, k = first_attempt(problem, trees, size, rng)
        if k != NONE:
            return size, 0, first, last, k
    for i in range(n_iterations):
        tree = (turn + i) % proposals.n_trees
        before, draw = size, uniform(rng)
        if draw < proposals.guided and len(problem.guide) > 1:
            along = draw_along_guide(problem, trees, tree, rng)
            size, is_reached = extend(problem, trees, tree, size, rng)
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
            size, _ = extend(problem, trees, tree, size, rng)
        elif draw < proposals.guided + proposals.uniform + proposals.shuffle:
            size = shuffle(problem, trees, tree, size, rng)
        else:
            size = hit_and_run_step(problem, trees, tree, size, proposals.from_newest, rng)
        if size == before:
            continue
        newest, other = size - 1, 1 - tree
        for m in range(find_nearest(problem, trees, other, size, trees.poses[newest])):
            if m > 0 and trees.gaps[m] > NEAR * problem.space.stride:
                break
            near = trees.nearest[m]
            first, last = (newest, near) if tree == 0 else (near, newest)
            k = join_rows(problem, trees, first, last)
            if k != NONE:
                return size, i + 1, first, last, k
    return size, n_iterations, NONE, NONE, NONE
