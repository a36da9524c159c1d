"""
An independent checker of robots that are not round: many poses along every motion, with shapely.

It shares no code with the planner: a footprint is a shapely polygon, placed by a rotation matrix,
and its distance to the blocked squares is shapely's.
"""

from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray
import shapely

TOUCHES = 1e-8
"""Distance, in cells, up to which a footprint counts as touching a square."""
HARDLY = 1e-5
"""Turn [rad] below which a position is a series in the turn, up to its first power."""
WALL = 3
"""Number of cells of the wall that is built around the map, for the outside is blocked."""


class PoseChecker:
    """
    A map and a footprint.

    Parameters
    ----------
    blocked : (rows, cols) bool
        Cells that the footprint may not touch; row 0 is nearest the origin.
    resolution : float
        Side of a cell [m].
    origin : (x, y, yaw)
        Pose of the outer corner of cell [0, 0] in the map frame [m, m, rad].
    footprint : (k, 2)
        Vertices [m] in the robot's frame.

    """

    def __init__(self, blocked, resolution, origin, footprint):
        ringed = np.pad(np.asarray(blocked, dtype=bool), WALL, constant_values=True)
        rows, cols = np.nonzero(ringed)
        left, bottom = (cols - WALL) * resolution, (rows - WALL) * resolution
        squares = shapely.box(left, bottom, left + resolution, bottom + resolution)
        x, y, yaw = origin
        self._squares = shapely.STRtree(shapely.transform(squares, lambda p: turned(p, yaw, x, y)))
        self._map = shapely.transform(
            shapely.box(0, 0, np.shape(blocked)[1] * resolution, len(blocked) * resolution),
            lambda p: turned(p, yaw, x, y),
        )
        self._footprint = np.asarray(footprint, dtype=float)
        self.resolution = resolution

    def polygons(self, poses: ArrayLike) -> NDArray:
        """Return the footprint at poses (k, 3) as shapely polygons."""
        return shapely.polygons(
            np.stack([turned(self._footprint, yaw, x, y) for x, y, yaw in np.asarray(poses)])
        )

    def distances(self, poses: ArrayLike) -> NDArray[np.float64]:
        """Return how far (k,) [cells] the blocked squares are; 0 outside the map."""
        polygons = self.polygons(poses)
        (k, _), nearest = self._squares.query_nearest(
            polygons, all_matches=False, return_distance=True
        )
        distances = np.zeros(len(polygons))
        distances[k] = nearest / self.resolution
        return np.where(shapely.covers(self._map, polygons), distances, 0.0)

    def is_free(self, poses: ArrayLike) -> NDArray[np.bool_]:
        """Return at which poses (k, 3) the footprint touches nothing."""
        return self.distances(poses) > TOUCHES

    def collisions(self, path: ArrayLike, twists: ArrayLike, step: float = 0.05) -> list[str]:
        """
        Return what is wrong with a path, in words; an empty list is a free path.

        Parameters
        ----------
        path : (m, 3)
            Poses. Each has to follow from the one before by its twist.
        twists : (m - 1, 3)
            Twists that are held for one unit of time.
        step : float
            Distance [cells] that a point of the footprint moves between two poses looked at.

        """
        poses, velocities = np.asarray(path, dtype=float), np.asarray(twists, dtype=float)
        if poses.ndim != 2 or poses.shape[1] != 3 or velocities.shape != (len(poses) - 1, 3):
            return [f'path and twists have the shapes {poses.shape} and {velocities.shape}']
        found = [] if self.is_free(poses).all() else ['a vertex is not free']
        reach = np.hypot(*self._footprint.T).max()
        for k, (a, b) in enumerate(pairwise(poses)):
            vx, vy, omega = velocities[k]
            travel = (np.hypot(vx, vy) + abs(omega) * reach) / self.resolution
            passed = orbit(a, velocities[k], np.linspace(0.0, 1.0, 2 + int(travel / step)))
            error = passed[-1] - b
            error[2] = (error[2] + np.pi) % (2 * np.pi) - np.pi
            if np.abs(error).max() > 1e-8:
                found.append(f'motion {k} ends {error} away from the next pose')
            hit = self.distances(passed) <= 0.0
            if hit.any():
                found.append(f'{np.count_nonzero(hit)} of {len(hit)} poses of motion {k} are hit')
        return found


def turned(points: NDArray, yaw: float, x: float, y: float) -> NDArray[np.float64]:
    """Return points (k, 2) turned by ``yaw`` about the origin, then moved by (x, y)."""
    cos, sin = np.cos(yaw), np.sin(yaw)
    return np.asarray(points) @ np.array([[cos, sin], [-sin, cos]]) + (x, y)


def orbit(pose: ArrayLike, twist: ArrayLike, times: ArrayLike) -> NDArray[np.float64]:
    """
    Return the poses (k, 3) at ``times`` of a robot that holds a twist.

    A twist that turns goes round a fixed centre. Where that is so far away that its rounding
    counts, the position is a series in the turn.
    """
    x, y, yaw = np.asarray(pose, dtype=float)
    vx, vy, omega = np.asarray(twist, dtype=float)
    times = np.asarray(times, dtype=float)
    if abs(omega) < HARDLY:
        ahead = np.outer(times, [vx, vy]) + np.outer(omega * times**2 / 2.0, [-vy, vx])
        return np.column_stack([turned(ahead, yaw, x, y), yaw + omega * times])
    # The centre is where the velocity is zero, at (-vy, vx) / omega in the robot's frame.
    (centre,) = turned(np.array([[-vy, vx]]) / omega, yaw, x, y)
    (away,) = np.array([[x, y]]) - centre
    positions = [turned(away[np.newaxis], omega * t, *centre)[0] for t in times]
    return np.column_stack([np.array(positions).reshape(-1, 2), yaw + omega * times])
