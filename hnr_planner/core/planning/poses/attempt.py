"""
The first attempt of a search for a path of poses: the longest free connections along the guide.

Most requests need no more. A connection from the start to the goal is tried first; then a tree is
extended to poses along the guide, the farthest first, until one of its vertices is connected with
the other tree. What is found on the way stays in the trees. Poses that do not see each other are
left to the search: a connection between them has to lead round an obstacle, which few do.
"""

from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import uniform
from hnr_planner.core.planning.poses.connections import N_MOTIONS
from hnr_planner.core.planning.poses.extensions import free_connection
from hnr_planner.core.planning.poses.guide import write_pose_along
from hnr_planner.core.planning.poses.steps import add_vertex, driving_sign
from hnr_planner.core.spaces.grid.traversal import traverse
from hnr_planner.core.spaces.poses.motion import moved, wrapped
from hnr_planner.core.spaces.primitives import contains
from hnr_planner.core.trees import NONE

#: Bounds on the part of the guide between the trees that an extension tries to get along, as a
#: fraction of what was tried before: other seeds try other parts.
LEAST_PART, LARGEST_PART = 0.4, 0.6
#: Most extensions of a tree, and most vertices that they add to both trees.
N_EXTENSIONS = 16
ADDED_AT_FIRST = 2 * N_EXTENSIONS * N_MOTIONS


@kernel
def first_attempt(problem, trees, size, rng):
    """
    Join the trees by connections along the guide.

    ``size`` is the number of vertices, all of them roots, the start in row 0. Return (number of
    vertices, row of the start's tree, row of the goal's, index of the connection that joins them
    in ``trees.found``, which is ``NONE`` where the trees are not joined).
    """
    for goal in range(1, size):
        k = _connection(problem, trees, trees.poses[0], trees.poses[goal], 1.0)
        if k != NONE:
            return size, 0, goal, k
    first, last = 0, 1
    if len(problem.guide) < 2:
        return size, first, last, NONE
    for tree in range(2):
        for _ in range(N_EXTENSIONS):
            before = size
            size = _extend_along(problem, trees, tree, last if tree else first, size, rng)
            if size == before:
                break
            if tree == 0:
                first = size - 1
            else:
                last = size - 1
            k = _connection(problem, trees, trees.poses[first], trees.poses[last], 1.0)
            if k != NONE:
                return size, first, last, k
    return size, first, last, NONE


@kernel
def _extend_along(problem, trees, tree, row, size, rng):
    """
    Extend a tree from ``row`` to a pose along the guide; return the number of vertices.

    The parts of the guide that are tried become shorter, down to a stride.
    """
    pose, part = trees.work[0], trees.progress[1] - trees.progress[0]
    driven = driving_sign(tree)
    while part > problem.space.stride:
        part *= LEAST_PART + (LARGEST_PART - LEAST_PART) * uniform(rng)
        along = trees.progress[tree] + driven * part
        write_pose_along(problem, along, pose)
        if not contains(problem.space, pose):
            continue
        k = _connection(problem, trees, trees.poses[row], pose, driven)
        if k != NONE:
            trees.progress[tree] = along
            return _add_motions(trees, tree, row, k, size)
    return size


@kernel
def _connection(problem, trees, begin, end, driven):
    """Return the index of a free connection between poses that see each other, else ``NONE``."""
    dx, dy = end[0] - begin[0], end[1] - begin[1]
    distance = problem.space.free_distance
    if (dx != 0.0 or dy != 0.0) and traverse(
        distance, begin[0], begin[1], dx, dy, 0.0, 1.0
    ) <= 1.0:
        return NONE
    return free_connection(problem, begin, end, driven, trees.found)


@kernel
def _add_motions(trees, tree, row, k, size):
    """Add the ends of the motions of connection ``k`` from ``row``; return the new size."""
    for m in range(trees.found.sizes[k]):
        begin, twist = trees.poses[row], trees.found.twists[k, m]
        x, y, yaw = moved(begin[0], begin[1], begin[2], twist[0], twist[1], twist[2], 1.0)
        end = trees.poses[size]
        end[0], end[1], end[2] = x, y, wrapped(yaw)
        for i in range(3):
            trees.twists[size, i] = twist[i]
        row = add_vertex(trees, tree, row, size)
        size += 1
    return size
