"""`trajectory_msgs/MultiDOFJointTrajectory`: what a robot with inertia does over time."""

import itertools

from builtin_interfaces.msg import Duration
from geometry_msgs.msg import Quaternion, Transform, Twist, Vector3
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.systems import Trajectory
from hnr_planner.server.responses import PlanResponse
import numpy as np
from numpy.typing import NDArray
from std_msgs.msg import Header
from trajectory_msgs.msg import MultiDOFJointTrajectory, MultiDOFJointTrajectoryPoint

AT_REST = 1e-6
"""Speed [m/s] below which a robot has no direction, and keeps the one before."""
SAG = 0.1
"""How far the path as a polyline may be from the trajectory, in cells of the map."""
HALVINGS = 16
"""Of a step, at most, until what is straight between its points is free as well."""


def trajectory_message(report: PlanResponse, header: Header) -> MultiDOFJointTrajectory:
    """
    Return the trajectory of a report; it has no points where there is none.

    A point for each time at which the acceleration changes, with the acceleration from there on:
    in between positions are quadratic, so that a cubic through positions and velocities is exact.
    """
    message = MultiDOFJointTrajectory(header=header, joint_names=['base'])
    trajectory = getattr(report.result, 'trajectory', None)
    if not report.solved or trajectory is None:
        return message
    pulls = np.vstack([trajectory.controls, np.zeros(2)])
    yaw = 0.0
    for time, state, pull in zip(trajectory.times, trajectory.states, pulls, strict=True):
        velocity = state[2:]
        # At rest it points where it is about to go.
        way = velocity if np.hypot(*velocity) > AT_REST else pull
        yaw = float(np.arctan2(way[1], way[0])) if np.hypot(*way) > AT_REST else yaw
        message.points.append(_point(time, state[:2], yaw, velocity, pull))
    return message


def _point(
    time: float,
    position: NDArray[np.float64],
    yaw: float,
    velocity: NDArray[np.float64],
    acceleration: NDArray[np.float64],
) -> MultiDOFJointTrajectoryPoint:
    place = Transform(
        translation=_vector(position),
        rotation=Quaternion(z=float(np.sin(yaw / 2.0)), w=float(np.cos(yaw / 2.0))),
    )
    nanoseconds = round(time * 1e9)
    return MultiDOFJointTrajectoryPoint(
        transforms=[place],
        velocities=[Twist(linear=_vector(velocity))],
        accelerations=[Twist(linear=_vector(acceleration))],
        time_from_start=Duration(sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9),
    )


def _vector(xy: NDArray[np.float64]) -> Vector3:
    return Vector3(x=float(xy[0]), y=float(xy[1]))


def as_path(trajectory: Trajectory, space: Space) -> NDArray[np.float64]:
    """Return a free polyline (m, 2) [m] near a trajectory, from its first point to its last."""
    pulls = np.hypot(*trajectory.controls.T)
    points = [trajectory.positions[0]]
    for begin, end, pull in zip(trajectory.times[:-1], trajectory.times[1:], pulls, strict=True):
        # A chord of a parabola is at most a t^2 / 8 from it.
        longest = np.sqrt(8.0 * SAG * space.scale / pull) if pull > 0.0 else np.inf
        n_parts = int(np.ceil((end - begin) / longest)) or 1
        times = np.linspace(begin, end, n_parts + 1)
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
