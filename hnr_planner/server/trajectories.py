"""Trajectories of a robot with inertia as paths, and the yaw angles along them."""

from collections.abc import Callable
import itertools

from hnr_planner.core.spaces.space import Space
from hnr_planner.core.systems import Trajectory
import numpy as np
from numpy.typing import NDArray

#: Speed [m/s] below which a robot has no direction, and keeps the one before.
AT_REST = 1e-6

#: How far the path as a polyline may be from the trajectory, in cells of the map.
SAG = 0.1

#: How often a step is halved, at most, until the segment between its ends is free as well.
HALVINGS = 16


def yaws_along(trajectory: Trajectory) -> NDArray[np.float64]:
    """
    Return the yaw (m,) [rad] at each time of a trajectory.

    It is the direction of the velocity; at rest that of the acceleration from there on, or else
    the one before.
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
    trajectory: Trajectory, space: Space, check: Callable[[], None]
) -> NDArray[np.float64]:
    """
    Return a free polyline (m, 2) [m] near a trajectory, from its first point to its last.

    Parameters
    ----------
    trajectory : Trajectory
        What the robot does.
    space : Space
        Where the polyline has to be free.
    check : callable
        Called again and again; what it raises ends the work.

    """
    accelerations = np.hypot(*trajectory.controls.T)
    points = [trajectory.positions[0]]
    steps = zip(trajectory.times[:-1], trajectory.times[1:], accelerations, strict=True)
    for begin, end, acceleration in steps:
        check()
        # A chord of a parabola is at most a t^2 / 8 from it.
        longest = np.sqrt(8.0 * SAG * space.scale / acceleration) if acceleration > 0.0 else np.inf
        n_pieces = int(np.ceil((end - begin) / longest)) or 1
        times = np.linspace(begin, end, n_pieces + 1)
        for first, last in itertools.pairwise(times):
            points += _chords(trajectory, space, first, last, HALVINGS)
    path = np.array(points)
    path[-1] = trajectory.positions[-1]
    moved = np.hypot(*np.diff(path, axis=0).T) > 0.0
    kept = path[np.append(True, moved)]
    return kept if len(kept) > 1 else path[[0, -1]]


def _chords(
    trajectory: Trajectory, space: Space, first: float, last: float, halvings: int
) -> list[NDArray[np.float64]]:
    """Return the points after ``first`` up to ``last``, so many that all chords are free."""
    begin, end = trajectory.at([first, last])[:, :2]
    if halvings == 0 or space.is_motion_valid(begin, end):
        return [end]
    middle = (first + last) / 2.0
    return [
        *_chords(trajectory, space, first, middle, halvings - 1),
        *_chords(trajectory, space, middle, last, halvings - 1),
    ]
