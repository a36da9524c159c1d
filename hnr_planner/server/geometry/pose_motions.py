"""
Motions of a robot with a footprint: poses along them, twists between poses, and what is blocked.

A motion holds a constant twist for one unit of time. Poses alone, as messages have them, do not
say how the robot gets from one to the next: it is taken to hold the one twist that leads there and
turns by less than half a turn.
"""

import math

from hnr_planner.core import PoseSpace
from hnr_planner.core.checks import Floats
from hnr_planner.core.spaces.poses.data import motion_is_free
from hnr_planner.core.spaces.poses.motion import orbit_poses, wrap
from hnr_planner.server.geometry.orientations import normalised, yaw_of
from hnr_planner.server.geometry.poses import MOST_POSES
import numpy as np
from numpy.typing import NDArray

#: Largest turn [rad] between two poses of a path, so that the twist between them is known.
LARGEST_TURN = math.pi / 4.0


def poses_on(path: Floats, twists: Floats, spacing: float) -> Floats:
    """
    Return poses (n, 3) along motions: all vertices, and poses between them.

    Parameters
    ----------
    path : (m, 3)
        Poses [m, m, rad]; none or at least two.
    twists : (m - 1, 3)
        The twist from each pose to the next.
    spacing : float
        Largest distance [m] between consecutive positions, and largest turn [rad] where that is
        below ``LARGEST_TURN``; 0 for no limit but that. It is widened where it would give more
        than ``MOST_POSES`` poses besides the vertices.

    """
    lengths, turns = np.hypot(twists[:, 0], twists[:, 1]), np.abs(twists[:, 2])
    pieces = np.maximum(1.0, np.ceil(turns / LARGEST_TURN))
    if spacing > 0.0:
        extents = np.maximum(lengths, turns)
        widened = max(spacing, float(extents.sum()) / MOST_POSES)
        pieces = np.maximum(pieces, np.ceil(extents / widened - 1e-9))
    passed = [path[:1]]
    for k, n_pieces in enumerate(pieces.astype(int).tolist()):
        times, end = np.arange(1, n_pieces) / n_pieces, path[k + 1]
        passed += [orbit_poses(path[k], twists[k], times), end[np.newaxis]]
    return np.concatenate(passed)


def rows_of(poses: Floats) -> Floats:
    """Return poses (n, 3) as rows (n, 7): x, y, z and the quaternion x, y, z, w."""
    rows = np.zeros((len(poses), 7))
    rows[:, :2] = poses[:, :2]
    rows[:, 5], rows[:, 6] = np.sin(poses[:, 2] / 2.0), np.cos(poses[:, 2] / 2.0)
    return rows


def poses_of(rows: Floats) -> Floats:
    """
    Return rows (n, 7) as poses (n, 3); the yaw is NaN where a quaternion is no rotation.

    A quaternion may have any norm above 0.
    """
    rotations = (normalised((x, y, z, w)) for x, y, z, w in rows[:, 3:].tolist())
    yaws = [math.nan if rotation is None else yaw_of(rotation) for rotation in rotations]
    return np.column_stack([rows[:, :2], np.array(yaws)])


def twists_between(poses: Floats) -> Floats:
    """
    Return the twists (n - 1, 3) that lead from each pose of (n, 3) to the next.

    Each turns by less than half a turn, or by exactly half a turn to the right.
    """
    turns = wrap(np.diff(poses[:, 2]))
    steps, middle = np.diff(poses[:, :2], axis=0), poses[:-1, 2] + turns / 2.0
    # The chord of the arc points along the yaw in its middle, and is shorter than the arc.
    stretch = 1.0 / np.sinc(turns / (2.0 * math.pi))
    cos, sin = np.cos(middle), np.sin(middle)
    return np.column_stack(
        [
            stretch * (cos * steps[:, 0] + sin * steps[:, 1]),
            stretch * (cos * steps[:, 1] - sin * steps[:, 0]),
            turns,
        ]
    )


def free_motions(space: PoseSpace, poses: Floats, twists: Floats) -> NDArray[np.bool_]:
    """
    Return which motions (m,) are free: the whole footprint, from pose to pose.

    Parameters
    ----------
    space : PoseSpace
        The space of poses.
    poses : (m + 1, 3)
        Poses in the map frame, finite.
    twists : (m, 3)
        The twist from each pose to the next.

    """
    begins, velocities = space.to_kernel(poses), space.twists_to_kernel(twists)
    return np.array(
        [
            motion_is_free(space.data, begin, velocity)
            for begin, velocity in zip(begins, velocities, strict=False)
        ],
        dtype=bool,
    )


def first_contact_pose(space: PoseSpace, poses: Floats, twists: Floats) -> Floats | None:
    """
    Return the first pose (3,) on motions at which the footprint is not free; None for none.

    ``poses`` (m + 1, 3) and ``twists`` (m, 3) are as for ``free_motions``.
    """
    blocked = np.flatnonzero(~free_motions(space, poses, twists))
    if len(blocked) == 0:
        return None
    pose, twist = poses[blocked[0]], twists[blocked[0]]
    free = space.chord(pose, twist).upper if twist.any() else 0.0
    reached: Floats = orbit_poses(pose, twist, np.array([min(free, 1.0)]))[0]
    return reached
