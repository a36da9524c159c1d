"""Checks whether a path is free on a map, and of which of its poses are blocked."""

import math
from typing import NamedTuple

from hnr_planner.server.geometry.planar_pose import PlanarPose
from hnr_planner.server.geometry.pose_motions import twists_between
from hnr_planner.server.map.map_store import MapSnapshot
from hnr_planner.server.requests.plan_request import Pose
import numpy as np
from numpy.typing import NDArray


class PathVerdict(NamedTuple):
    """
    Whether a path is valid on a map.

    Parameters
    ----------
    blocked : list of int
        Indices, in the poses of the path, of blocked poses: those that are not free themselves,
        or to which the segment or motion from the pose before is not free.
    why : str
        Why the path is not valid; empty when it is valid.

    """

    blocked: list[int]
    why: str


def first_blocked_pose(
    path: NDArray[np.float64], frame: str, snapshot: MapSnapshot
) -> PlanarPose | None:
    """
    Return the first place on a path that is not free; None when all of the path is free.

    The pose lies on the first segment that is not free, not in general at a vertex; its yaw is
    the direction of that segment.

    Parameters
    ----------
    path : (m, 2)
        Vertices in ``frame`` [m], at least two.
    frame : str
        Frame of the path; on a map with another frame the path counts as blocked at its start.
    snapshot : MapSnapshot
        The map to check the path on.

    """
    segment = 0 if frame != snapshot.frame else snapshot.space.first_blocked_segment(path)
    if segment is None:
        return None
    begin, step = path[segment], path[segment + 1] - path[segment]
    # The chord is the free part of the line from ``begin``: it ends where the segment is blocked.
    free = 0.0
    if frame == snapshot.frame and step.any():
        free = min(snapshot.space.chord(begin, step).upper, 1.0)
    x, y = (begin + free * step).tolist()
    return PlanarPose(x, y, math.atan2(step[1], step[0]))


def judge_path(
    poses: NDArray[np.float64],
    frame: str,
    snapshot: MapSnapshot,
    robot: Pose | None,
    lookahead: float = math.inf,
) -> PathVerdict:
    """
    Return which poses of a path are blocked from the robot on, and why the path is not valid.

    A path without poses, or in another frame than the map's, is not valid.

    Parameters
    ----------
    poses : (n, 3)
        Poses in ``frame`` [m, m, rad]; those that are not finite count as not free. For a robot
        without a footprint positions (n, 2) do.
    frame : str
        Frame of the path; empty for the map's.
    snapshot : MapSnapshot
        The map to check the path on.
    robot : Pose, optional
        Pose of the robot in the frame of the map: poses before the pose nearest to the robot are
        not judged. None where it is not known: then all poses are judged.
    lookahead : float
        Length of the path [m], from the first pose that is judged, after which poses are not
        judged.

    """
    if len(poses) == 0:
        return PathVerdict([], 'the path has no poses')
    frame, points = frame or snapshot.frame, poses[:, :2]
    blocked = blocked_poses(poses, frame, snapshot)
    passed = 0 if robot is None else nearest_pose(points, robot)
    along = np.append(0.0, np.cumsum(np.hypot(*np.diff(points[passed:], axis=0).T)))
    last = passed + np.count_nonzero(~(along > lookahead)) - 1
    blocked = [number for number in blocked if passed <= number <= last]
    if frame != snapshot.frame:
        return PathVerdict(
            blocked, f"the path is in frame '{frame}', the map in '{snapshot.frame}'"
        )
    if not blocked:
        return PathVerdict([], '')
    x, y = points[blocked[0]].tolist()
    way = 'segment' if snapshot.pose_space is None else 'motion of the footprint'
    return PathVerdict(
        blocked,
        f'pose {blocked[0]} of {len(points)}, at ({x:.4g}, {y:.4g}), is not free, or the {way} '
        'that leads to it is not',
    )


def blocked_poses(poses: NDArray[np.float64], frame: str, snapshot: MapSnapshot) -> list[int]:
    """
    Return the indices in ``poses`` of blocked poses, ascending.

    A pose is blocked when it is not free, or the way to it from a free pose before it is not: the
    segment, or with a footprint the motion by the twist that turns by less than half a turn.

    Parameters
    ----------
    poses : (n, 3)
        Poses in ``frame`` [m, m, rad]; those that are not finite count as not free. For a robot
        without a footprint positions (n, 2) do.
    frame : str
        Frame of the poses; on a map with another frame all poses are blocked.
    snapshot : MapSnapshot
        The map to check the poses on.

    """
    if frame != snapshot.frame:
        return list(range(len(poses)))
    space = snapshot.pose_space or snapshot.space
    places = poses[:, : space.dim]
    free = np.logical_and.reduce(np.isfinite(places), axis=1)
    free[free] = space.contains(places[free])
    pairs = np.flatnonzero(free[:-1] & free[1:])
    # What leads from each pose to the next: a point, or the twist of a footprint.
    ends = places[1:] if space.dim == 2 else twists_between(places)
    reached = free.copy()
    for k in pairs.tolist():
        reached[k + 1] = space.is_motion_valid(places[k], ends[k])
    return np.flatnonzero(~reached).tolist()


def nearest_pose(points: NDArray[np.float64], robot: Pose) -> int:
    """
    Return the index in ``points`` of the position nearest to the robot.

    Parameters
    ----------
    points : (n, 2)
        Positions in the frame of ``robot`` [m], at least one; those that are not finite are
        infinitely far away.
    robot : Pose
        Pose of the robot.

    """
    away = points - robot.point
    return int(np.argmin(np.nan_to_num(np.hypot(away[:, 0], away[:, 1]), nan=np.inf)))
