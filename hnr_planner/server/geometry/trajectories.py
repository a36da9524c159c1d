"""Trajectories of a robot with inertia: free polylines near them, and yaws along them."""

from collections.abc import Callable

from hnr_planner.core import GridSpace
from hnr_planner.core.systems import Trajectory
from hnr_planner.server.geometry.poses import MOST_POSES
import numpy as np
from numpy.typing import NDArray

#: Speed [m/s], or acceleration [m/s^2], up to which it gives the robot no direction.
AT_REST = 1e-6

#: Largest distance of the polyline from the trajectory, in sides of a cell of the map.
SAG = 0.1

#: Most times that a piece is halved to get segments that are free.
HALVINGS = 16


def yaws_along(trajectory: Trajectory) -> NDArray[np.float64]:
    """
    Return the yaw (m,) [rad] at each of the m times of a trajectory.

    It is the direction of the velocity; where the robot is at rest, of the acceleration that
    begins there; without acceleration, the yaw at the time before. It is 0 until there is one.
    """
    velocities = trajectory.states[:, 2:]
    accelerations = np.vstack([trajectory.controls, np.zeros(2)])
    moving = np.hypot(*velocities.T) > AT_REST
    directions = np.where(moving[:, np.newaxis], velocities, accelerations)
    known = np.hypot(*directions.T) > AT_REST
    # The last row at which a direction is known, up to each row; -1 before the first.
    latest = np.maximum.accumulate(np.where(known, np.arange(len(known)), -1))
    yaws = np.arctan2(directions[:, 1], directions[:, 0])
    return np.where(latest >= 0, yaws[latest], 0.0)


def trajectory_path(
    trajectory: Trajectory, space: GridSpace, check: Callable[[], None]
) -> NDArray[np.float64]:
    """
    Return a free polyline (m, 2) [m] near a trajectory, from its first point to its last.

    Its vertices lie on the trajectory, one at the end of each step of constant acceleration and
    more between, so that the polyline is within ``SAG`` cells of the trajectory; where that would
    need more than ``MOST_POSES`` vertices, it may be further away. A piece whose segment is not
    free is halved, ``HALVINGS`` times at most: a segment that is not free even then stays.
    Vertices at the place of the vertex before them are left out.

    Parameters
    ----------
    trajectory : Trajectory
        States of the robot over time.
    space : GridSpace
        Space in which the polyline has to be free.
    check : callable
        Called for each blocked piece; an exception that it raises ends the work.

    """
    times, shortest = _vertex_times(trajectory, space)
    points = trajectory.at(times)[:, :2]
    first = 0
    while (blocked := space.first_blocked_segment(points[first:])) is not None:
        check()
        k = first + blocked
        begin, end = times[k], times[k + 1]
        if end - begin <= shortest[k]:
            first = k + 1  # halved often enough: the segment stays as it is
        else:
            middle = (begin + end) / 2.0
            times = np.insert(times, k + 1, middle)
            shortest = np.insert(shortest, k + 1, shortest[k])
            points = np.insert(points, k + 1, trajectory.at([middle])[:, :2], axis=0)
            first = k
        if first >= len(points) - 1:
            break
    points[-1] = trajectory.positions[-1]
    moved = np.hypot(*np.diff(points, axis=0).T) > 0.0
    kept = points[np.append(True, moved)]
    return kept if len(kept) > 1 else points[[0, -1]]


def _vertex_times(
    trajectory: Trajectory, space: GridSpace
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """
    Return the times (n,) [s] of the vertices, and the shortest durations (n - 1,) [s] of pieces.

    Each step of the trajectory is cut into pieces of equal duration, at least one. A piece is not
    halved any more once it is as short as the shortest duration given for it. Times count from
    the same zero as those of the trajectory.
    """
    durations = np.diff(trajectory.times)
    accelerations = np.hypot(*trajectory.controls.T)
    # A parabola of acceleration a is at most a t^2 / 8 away from its chord over a time t.
    pieces = durations * np.sqrt(accelerations / (8.0 * SAG * space.scale))
    if np.maximum(1.0, np.ceil(pieces)).sum() > MOST_POSES:
        # Rounding up adds one piece to each step at most.
        pieces *= max(MOST_POSES - 1 - len(pieces), 0) / pieces.sum()
    n_pieces = np.maximum(1, np.ceil(pieces)).astype(np.int64)
    step = np.repeat(np.arange(len(durations)), n_pieces)
    # Number of the piece within its step, from 0.
    piece = np.arange(len(step)) - np.repeat(np.cumsum(n_pieces) - n_pieces, n_pieces)
    length = (durations / n_pieces)[step]
    begins = trajectory.times[step] + piece * length
    return np.append(begins, trajectory.times[-1]), length / 2.0**HALVINGS
