"""Whether a path that was found on one map is a path on another, and where it is blocked."""

import math
from typing import NamedTuple

from hnr_planner.server.map_store import MapSnapshot
import numpy as np
from numpy.typing import NDArray


class PlanarPose(NamedTuple):
    """A place [m] and a direction [rad] in the frame of the map."""

    x: float
    y: float
    yaw: float

    def __str__(self) -> str:
        """Return the pose in words."""
        return f'({self.x:.4g}, {self.y:.4g}), yaw {self.yaw:.3g}'


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
        The frame of their numbers; in a map with another frame all of the path counts as blocked.
    snapshot : MapSnapshot
        The map to hold it against.

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


def blocked_poses(points: NDArray[np.float64], frame: str, snapshot: MapSnapshot) -> list[int]:
    """
    Return which poses are not free, or not to be reached in a straight line from the one before.

    Parameters
    ----------
    points : (n, 2)
        Where they are [m]; those that are not finite count as not free.
    frame : str
        The frame of their numbers; in a map with another frame none is free.
    snapshot : MapSnapshot
        The map to hold them against.

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
