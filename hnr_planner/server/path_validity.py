"""Whether a path is free on a map, and where it is blocked."""

import math
from typing import NamedTuple

from hnr_planner.server.map_store import MapSnapshot
from hnr_planner.server.requests import Pose
import numpy as np
from numpy.typing import NDArray


class PlanarPose(NamedTuple):
    """A position [m] and a yaw [rad] in the frame of the map."""

    x: float
    y: float
    yaw: float

    def __str__(self) -> str:
        """Return the pose in words."""
        return f'({self.x:.4g}, {self.y:.4g}), yaw {self.yaw:.3g}'


class PathVerdict(NamedTuple):
    """The poses of a path that are blocked, and why it is not valid; empty when it is."""

    blocked: list[int]
    why: str


def first_blocked_pose(
    path: NDArray[np.float64], frame: str, snapshot: MapSnapshot
) -> PlanarPose | None:
    """
    Return the first pose of a path at which it is not free; None when all of it is.

    Parameters
    ----------
    path : (m, 2)
        Vertices [m], at least two.
    frame : str
        Their frame; on a map with another frame all of the path counts as blocked.
    snapshot : MapSnapshot
        The map to check it on.

    """
    segment = 0 if frame != snapshot.frame else snapshot.space.first_blocked_segment(path)
    if segment is None:
        return None
    begin, step = path[segment], path[segment + 1] - path[segment]
    # The chord along the segment ends where it is blocked; it is empty where it begins blocked.
    free = 0.0
    if frame == snapshot.frame and step.any():
        free = min(snapshot.space.chord(begin, step).upper, 1.0)
    x, y = (begin + free * step).tolist()
    return PlanarPose(x, y, math.atan2(step[1], step[0]))


def judge_path(
    points: NDArray[np.float64], frame: str, snapshot: MapSnapshot, robot: Pose | None
) -> PathVerdict:
    """
    Return whether a path is free from where the robot is, and if not, which poses are blocked.

    Parameters
    ----------
    points : (n, 2)
        Positions of its poses [m]; those that are not finite count as not free.
    frame : str
        Their frame; empty for the map's.
    snapshot : MapSnapshot
        The map to check it on.
    robot : Pose, optional
        The robot in the frame of the map: poses before the one nearest to it have been passed.
        None where it is not known: then all of the path counts.

    """
    if len(points) == 0:
        return PathVerdict([], 'the path has no poses')
    frame = frame or snapshot.frame
    blocked = blocked_poses(points, frame, snapshot)
    if robot is not None:
        passed = nearest_pose(points, robot)
        blocked = [number for number in blocked if number >= passed]
    if frame != snapshot.frame:
        return PathVerdict(
            blocked, f"the path is in frame '{frame}', the map in '{snapshot.frame}'"
        )
    if not blocked:
        return PathVerdict([], '')
    x, y = points[blocked[0]].tolist()
    return PathVerdict(
        blocked,
        f'pose {blocked[0]} of {len(points)}, at ({x:.4g}, {y:.4g}), is not free, or the segment '
        'that leads to it is not',
    )


def blocked_poses(points: NDArray[np.float64], frame: str, snapshot: MapSnapshot) -> list[int]:
    """
    Return which poses are not free, or not to be reached in a straight line from the one before.

    Parameters
    ----------
    points : (n, 2)
        Their positions [m]; those that are not finite count as not free.
    frame : str
        Their frame; on a map with another frame none is free.
    snapshot : MapSnapshot
        The map to check them on.

    """
    if frame != snapshot.frame:
        return list(range(len(points)))
    space = snapshot.space
    free = np.logical_and.reduce(np.isfinite(points), axis=1)
    free[free] = space.contains(points[free])
    reached = free.copy()
    for k in np.flatnonzero(free[:-1] & free[1:]).tolist():
        reached[k + 1] = space.is_motion_valid(points[k], points[k + 1])
    return np.flatnonzero(~reached).tolist()


def nearest_pose(points: NDArray[np.float64], robot: Pose) -> int:
    """Return the number of the pose nearest to the robot, at least one of ``points`` (n, 2)."""
    away = points - robot.point
    return int(np.argmin(np.nan_to_num(np.hypot(away[:, 0], away[:, 1]), nan=np.inf)))
