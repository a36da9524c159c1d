"""Poses along a path, as arrays."""

from typing import NamedTuple

from hnr_planner.server.orientations import Quaternion, yaw_of
import numpy as np
from numpy.typing import NDArray

#: Most poses of a path. Spacing adds no more than that, and a path with more vertices is refused.
MOST_POSES = 10_000


class Poses(NamedTuple):
    """Poses along a path: points (n, 2) [m] and yaw angles (n,) [rad]."""

    points: NDArray[np.float64]
    yaws: NDArray[np.float64]


def poses_along(path: NDArray[np.float64], spacing: float, final_yaw: float) -> Poses:
    """
    Return poses at most ``spacing`` apart that look along the path.

    Every vertex is a pose and each segment is cut into equal pieces, so the line through the
    poses is the path itself. Each pose looks to the next one; the last has ``final_yaw``.

    Parameters
    ----------
    path : (m, 2)
        Vertices [m]; none or at least two.
    spacing : float
        Largest distance between poses [m]; 0 for the vertices only. It is widened where it
        would give more than ``MOST_POSES`` besides the vertices.
    final_yaw : float
        Yaw of the last pose, and of all when the path goes nowhere [rad].

    """
    if len(path) == 0:
        return Poses(np.empty((0, 2)), np.empty(0))
    steps = np.diff(path, axis=0)
    lengths = np.hypot(steps[:, 0], steps[:, 1])
    pieces = _pieces(lengths, spacing)

    segment = np.repeat(np.arange(len(steps)), pieces)
    # Number of the piece within its segment, from 0.
    piece = np.arange(len(segment)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    fraction = (piece / pieces[segment])[:, np.newaxis]
    points = path[segment] + fraction * steps[segment]
    yaws = _yaws(steps, lengths, final_yaw)[segment]
    return Poses(np.vstack([points, path[-1]]), np.append(yaws, final_yaw))


def pose_rows(
    path: NDArray[np.float64], spacing: float, goal_orientation: Quaternion
) -> NDArray[np.float64]:
    """
    Return poses along a path as rows (n, 7): x, y, z and the quaternion x, y, z, w.

    Parameters
    ----------
    path : (m, 2)
        Vertices [m]; none or at least two.
    spacing : float
        Largest distance between poses [m]; 0 for the vertices only.
    goal_orientation : Quaternion
        Of the last pose, with norm 1; roll and pitch are kept.

    """
    points, yaws = poses_along(path, spacing, yaw_of(goal_orientation))
    rows = np.zeros((len(points), 7))
    rows[:, :2] = points
    rows[:, 5], rows[:, 6] = np.sin(yaws / 2.0), np.cos(yaws / 2.0)
    rows[-1:, 3:] = goal_orientation
    return rows


def _pieces(lengths: NDArray[np.float64], spacing: float) -> NDArray[np.int64]:
    """Return into how many equal pieces each segment is cut, at least one."""
    if spacing <= 0.0:
        return np.ones(len(lengths), dtype=np.int64)
    widened = max(spacing, float(lengths.sum()) / MOST_POSES)
    # A length of 3 * spacing, rounded up in its last digit, is three pieces all the same.
    return np.maximum(1, np.ceil(lengths / widened - 1e-9)).astype(np.int64)


def _yaws(
    steps: NDArray[np.float64], lengths: NDArray[np.float64], final_yaw: float
) -> NDArray[np.float64]:
    """Return the yaw of each segment; one without length takes that of the segment before it."""
    yaws = np.arctan2(steps[:, 1], steps[:, 0])
    moving = np.flatnonzero(lengths > 0.0)
    if len(moving) == 0:
        return np.full(len(steps), final_yaw)
    before = np.searchsorted(moving, np.arange(len(steps)), side='right') - 1
    return yaws[moving[np.maximum(before, 0)]]
