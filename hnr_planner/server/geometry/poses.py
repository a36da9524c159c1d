"""Poses along a path, as arrays: positions on it and the directions of its segments."""

from hnr_planner.server.geometry.orientations import Quaternion, yaw_of
import numpy as np
from numpy.typing import NDArray

#: Most poses that spacing adds between the vertices of a path; also the most vertices of a path:
#: one with more is refused.
MOST_POSES = 10_000


def pose_rows(
    path: NDArray[np.float64], spacing: float, goal_orientation: Quaternion
) -> NDArray[np.float64]:
    """
    Return poses along a path as rows (n, 7): x, y, z and the quaternion x, y, z, w.

    They are at most ``spacing`` apart, and each is directed to the next one. Every vertex is a
    pose and each segment is cut into equal pieces, so the line through the poses is the path
    itself. An empty path gives no poses.

    Parameters
    ----------
    path : (m, 2)
        Vertices [m]; none or at least two.
    spacing : float
        Largest distance between consecutive poses [m]; 0 for the vertices only. It is widened
        to the length of the path divided by ``MOST_POSES`` where it is less than that.
    goal_orientation : Quaternion
        Orientation of the last pose, with norm 1; its roll and pitch are kept. All other poses
        are level; where the path has the length 0, they have its yaw.

    """
    if len(path) == 0:
        return np.zeros((0, 7))
    points, segment = _spaced(path, spacing)
    halves = _yaws(path, yaw_of(goal_orientation)) / 2.0
    rows = np.zeros((len(points), 7))
    rows[:, :2] = points
    rows[:-1, 5], rows[:-1, 6] = np.sin(halves)[segment], np.cos(halves)[segment]
    rows[-1, 3:] = goal_orientation
    return rows


def _spaced(
    path: NDArray[np.float64], spacing: float
) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """Return points (n, 2) on a path, and the index (n - 1,) of the segment that each begins."""
    steps = np.diff(path, axis=0)
    pieces = _pieces(np.hypot(steps[:, 0], steps[:, 1]), spacing)
    segment = np.repeat(np.arange(len(steps)), pieces)
    # Number of the piece within its segment, from 0.
    piece = np.arange(len(segment)) - (np.cumsum(pieces) - pieces)[segment]
    points = np.empty((len(segment) + 1, 2))
    points[:-1] = path[segment] + (piece / pieces[segment])[:, np.newaxis] * steps[segment]
    points[-1] = path[-1]
    return points, segment


def _pieces(lengths: NDArray[np.float64], spacing: float) -> NDArray[np.int64]:
    """Return into how many pieces (k,), at least 1, to cut segments of lengths (k,) [m]."""
    if spacing <= 0.0:
        return np.ones(len(lengths), dtype=np.int64)
    widened = max(spacing, float(lengths.sum()) / MOST_POSES)
    # A length of 3 * spacing that rounding made a little longer still gives three pieces.
    return np.maximum(1, np.ceil(lengths / widened - 1e-9)).astype(np.int64)


def _yaws(path: NDArray[np.float64], final_yaw: float) -> NDArray[np.float64]:
    """
    Return the yaw (k,) [rad] of each segment of a path (k + 1, 2).

    A segment of length 0 takes the yaw of the last segment before it that has a length, or of the
    first one after it; ``final_yaw`` where no segment has a length.
    """
    steps = np.diff(path, axis=0)
    yaws = np.arctan2(steps[:, 1], steps[:, 0])
    moving = np.flatnonzero((steps != 0.0).any(axis=1))
    if len(moving) == 0:
        return np.full(len(steps), final_yaw)
    before = np.searchsorted(moving, np.arange(len(steps)), side='right') - 1
    return yaws[moving[np.maximum(before, 0)]]
