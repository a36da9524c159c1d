"""The frame of poses: between (x, y, yaw) in the map frame and the frame of a grid."""

import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.spaces.grid.frame import cell_of, GridFrame, point_of
from hnr_planner.core.spaces.poses.motion import wrapped
import numpy as np


class PoseFrame(NamedTuple):
    """
    The frame of a grid as kernels take it.

    Attributes
    ----------
    x, y, yaw : float
        Pose of the outer corner of cell [0, 0] in the map frame [m, m, rad].
    cos, sin : float
        Cosine and sine of the yaw.
    resolution : float
        Side of a cell [m].
    rim : float
        Width of the rim of blocked cells, at the corner of which the kernel frame begins [cells].

    """

    x: float
    y: float
    yaw: float
    cos: float
    sin: float
    resolution: float
    rim: float


def pose_frame(frame: GridFrame) -> PoseFrame:
    """Return the frame of a grid as kernels take it."""
    x, y, yaw = frame.origin
    return PoseFrame(x, y, yaw, math.cos(yaw), math.sin(yaw), frame.resolution, float(frame.RIM))


@kernel
def poses_to_cells(frame: PoseFrame, poses: Floats) -> Floats:
    """Return poses (k, 3) [m, m, rad] of the map frame in the kernel frame [cells, cells, rad]."""
    cells = np.empty_like(poses)
    for k in range(len(poses)):
        pose_to_cells(frame, poses[k], cells[k])
    return cells


@kernel
def poses_from_cells(frame: PoseFrame, cells: Floats) -> Floats:
    """Return poses (k, 3) of the kernel frame in the map frame: the inverse."""
    poses = np.empty_like(cells)
    for k in range(len(cells)):
        pose_from_cells(frame, cells[k], poses[k])
    return poses


@inlined
def pose_to_cells(frame, pose, cell):
    """Write a pose (3,) [m, m, rad] of the map frame into ``cell`` (3,), kernel frame."""
    cell[0], cell[1] = cell_of(
        pose[0], pose[1], frame.x, frame.y, frame.cos, frame.sin, frame.resolution, frame.rim
    )
    cell[2] = wrapped(pose[2] - frame.yaw)


@inlined
def pose_from_cells(frame, cell, pose):
    """Write a pose (3,) of the kernel frame into ``pose`` (3,), map frame: the inverse."""
    pose[0], pose[1] = point_of(
        cell[0], cell[1], frame.x, frame.y, frame.cos, frame.sin, frame.resolution, frame.rim
    )
    pose[2] = wrapped(cell[2] + frame.yaw)
