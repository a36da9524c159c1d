"""Poses along a path, as arrays: positions on it and the yaw angles of its segments."""

from typing import NamedTuple

from hnr_planner.server.orientations import Quaternion, yaw_of
import numpy as np
from numpy.typing import NDArray

#: Most poses that spacing adds between the vertices of a path; also the most vertices of a path:
#: one with more is refused.
MOST_POSES = 10_000


class Poses(NamedTuple):
    """Poses in the frame of their path: points (n, 2) [m] and yaw angles (n,) [rad]."""

    points: NDArray[np.float64]
    yaws: NDArray[np.float64]


def poses_along(path: NDArray[np.float64], spacing: float, final_yaw: float) -> Poses:
    """
    Return poses on a path, at most ``spacing`` apart, each directed to the next one.

    Every vertex is a pose and each segment is cut into equal pieces, so the line through the
    poses is the path itself. The last pose has ``final_yaw``. An empty path gives no poses.

    Parameters
    ----------
    path : (m, 2)
        Vertices [m]; none or at least two.
    spacing : float
        Largest distance between consecutive poses [m]; 0 for the vertices only. It is widened
        to the length of the path divided by ``MOST_POSES`` where it is less than that.
    final_yaw : float
        Yaw [rad] of the last pose, and of all poses when the path has the length 0.

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
        Largest distance between consecutive poses [m]; 0 for the vertices only. It is widened
        as by ``poses_along``.
    goal_orientation : Quaternion
        Orientation of the last pose, with norm 1; its roll and pitch are kept. All other poses
        are level.

    """
    points, yaws = poses_along(path, spacing, yaw_of(goal_orientation))
    rows = np.zeros((len(points), 7))
    rows[:, :2] = points
    rows[:, 5], rows[:, 6] = np.sin(yaws / 2.0), np.cos(yaws / 2.0)
    rows[-1:, 3:] = goal_orientation
    return rows


def _pieces(lengths: NDArray[np.float64], spacing: float) -> NDArray[np.int64]:
    """Return into how many pieces (k,), at least 1, to cut segments of lengths (k,) [m]."""
    if spacing <= 0.0:
        return np.ones(len(lengths), dtype=np.int64)
    widened = max(spacing, float(lengths.sum()) / MOST_POSES)
    # A length of 3 * spacing that rounding made a little longer still gives three pieces.
    return np.maximum(1, np.ceil(lengths / widened - 1e-9)).astype(np.int64)


def _yaws(
    steps: NDArray[np.float64], lengths: NDArray[np.float64], final_yaw: float
) -> NDArray[np.float64]:
    """
    Return the yaw (k,) [rad] of each segment, given its step (k, 2) and length (k,) [m].

    A segment of length 0 takes the yaw of the last segment before it that has a length, or of the
    first one after it; ``final_yaw`` where no segment has a length.
    """
    yaws = np.arctan2(steps[:, 1], steps[:, 0])
    moving = np.flatnonzero(lengths > 0.0)
    if len(moving) == 0:
        return np.full(len(steps), final_yaw)
    before = np.searchsorted(moving, np.arange(len(steps)), side='right') - 1
    return yaws[moving[np.maximum(before, 0)]]
