"""Paths of poses that a search has found: out of its trees, and into the caller's frame."""

import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.copies import copy_into
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.planning.poses.connections import cost_of, first_blocked_motion, Prices
from hnr_planner.core.planning.poses.trees import PoseTrees
from hnr_planner.core.spaces.poses.data import PoseData
from hnr_planner.core.spaces.poses.frame import PoseFrame, poses_from_cells, poses_to_cells
from hnr_planner.core.spaces.poses.motion import moved, wrapped
from hnr_planner.core.spaces.primitives import contains
from hnr_planner.core.trees import rows_to
import numpy as np

#: Distance [cells, rad] of the last pose from the goal up to which the goal takes its place.
ROUNDING = 1e-9


class PosePath(NamedTuple):
    """
    A path in the caller's frame.

    Attributes
    ----------
    poses : (m + 1, 3)
        Poses [m, m, rad].
    twists : (m, 3)
        Twists that lead from each pose to the next in one unit of time.
    length : float
        Length of the way of the robot's origin [m].
    cost : float
        Length and prices [cells].

    """

    poses: Floats
    twists: Floats
    length: float
    cost: float


#: What stands for the path where none was found.
NO_PATH = PosePath(np.empty((0, 3)), np.empty((0, 3)), math.inf, math.inf)


@kernel
def joined_path(trees: PoseTrees, first: int, last: int, k: int) -> tuple[Floats, Floats]:
    """
    Return the path through both trees, kernel frame: poses (m + 1, 3) and twists (m, 3).

    It leads from the root of the start's tree to row ``first``, by connection ``k`` of
    ``trees.found`` to row ``last`` of the goal's tree, and on to its root. It has at least one
    motion, of the zero twist where the goal is the start.
    """
    ahead, back = rows_to(trees.parents, first), rows_to(trees.parents, last)
    joint = len(ahead) - 1 + trees.found.sizes[k]
    m = max(joint + len(back) - 1, 1)
    poses, twists = np.zeros((m + 1, 3)), np.zeros((m, 3))
    for i in range(len(ahead)):
        copy_into(poses[i], trees.poses[ahead[i]])
        if i > 0:
            copy_into(twists[i - 1], trees.twists[ahead[i]])
    for i in range(len(ahead) - 1, joint):
        twist = trees.found.twists[k, i - len(ahead) + 1]
        copy_into(twists[i], twist)
        x, y, yaw = moved(poses[i, 0], poses[i, 1], poses[i, 2], twist[0], twist[1], twist[2], 1.0)
        poses[i + 1, 0], poses[i + 1, 1], poses[i + 1, 2] = x, y, wrapped(yaw)
    for i in range(len(back)):
        row, at = back[len(back) - 1 - i], joint + i
        copy_into(poses[at], trees.poses[row])
        if i < len(back) - 1:
            for c in range(3):
                # The motions of the goal's tree lead away from the goal: they are driven back.
                twists[at, c] = -trees.twists[row, c]
    copy_into(poses[m], trees.poses[back[0]])
    return poses, twists


@kernel
def path_for_caller(
    space: PoseData,
    frame: PoseFrame,
    prices: Prices,
    poses: Floats,
    twists: Floats,
    start: Floats,
    goal: Floats,
) -> tuple[Floats, Floats, float, float, bool]:
    """
    Convert a path of the kernel frame to the caller's, and test that it is free there as well.

    Parameters
    ----------
    space, frame, prices
        The free poses, the frame of the grid, and what motions cost.
    poses, twists : (m + 1, 3), (m, 3)
        The path in the kernel frame.
    start, goal : (3,)
        The caller's poses, which take the place of the path's ends.

    Returns
    -------
    poses, twists, length, cost
        Those of a ``PosePath``.
    is_free : bool
        Whether the path is free after the rounding to the caller's coordinates.

    """
    space = borrowed(space)
    scale = frame.resolution
    outside, turned = poses_from_cells(frame, poses), np.empty_like(twists)
    copy_into(outside[0], start)
    end = outside[len(outside) - 1]
    gap = max(abs(end[0] - goal[0]), abs(end[1] - goal[1])) / scale
    if max(gap, abs(end[2] - goal[2])) < ROUNDING:
        copy_into(end, goal)
    inside, again, length = poses_to_cells(frame, outside), np.empty_like(twists), 0.0
    for k in range(len(twists)):
        for c in range(3):
            unit = scale if c < 2 else 1.0
            turned[k, c] = twists[k, c] * unit
            again[k, c] = turned[k, c] / unit
        length += math.hypot(turned[k, 0], turned[k, 1])
    is_free = first_blocked_motion(space, inside, again) < 0
    for k in range(len(inside)):
        is_free = is_free and contains(space, inside[k])
    return outside, turned, length, cost_of(prices, twists, len(twists), 1.0), is_free
