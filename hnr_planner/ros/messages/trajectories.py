"""Trajectories of robots with inertia as ``trajectory_msgs/MultiDOFJointTrajectory``."""

from typing import Any, NamedTuple

from builtin_interfaces.msg import Duration
from geometry_msgs.msg import Quaternion, Transform, Twist, Vector3
from hnr_planner.core.systems import Trajectory
from hnr_planner.ros.messages.cdr import with_elements
from hnr_planner.server.geometry.trajectories import yaws_along
import numpy as np
from numpy.typing import NDArray
from rclpy.serialization import serialize_message
from std_msgs.msg import Header
from trajectory_msgs.msg import MultiDOFJointTrajectory, MultiDOFJointTrajectoryPoint

Floats = NDArray[np.float64]

#: The name of the only joint of a trajectory: the robot's base.
JOINT = 'base'


class _Columns(NamedTuple):
    """
    The n points of a trajectory, as arrays in the order of the message's fields.

    Parameters
    ----------
    transforms : (n, 7)
        Position x, y, z [m] and quaternion x, y, z, w.
    velocities, accelerations : (n, 6)
        Linear x, y, z [m/s, m/s^2], then angular x, y, z, which are 0.
    times : (n, 2)
        Time from the start: whole seconds, and nanoseconds.

    """

    transforms: Floats
    velocities: Floats
    accelerations: Floats
    times: NDArray[np.int32]


def serialised_trajectory(trajectory: Trajectory | None, header: Header) -> bytes:
    """
    Return a trajectory as a serialised message; without a trajectory it has no points.

    The message has a point for each time at which the acceleration changes, with the acceleration
    that begins there, and one for the end, with 0. Between points, positions are quadratic in
    time, so that a cubic through positions and velocities is exact.
    """
    if trajectory is None:
        none = MultiDOFJointTrajectory(header=header, joint_names=[JOINT])
        return bytes(serialize_message(none))
    columns = _columns(trajectory)
    short = [serialize_message(_message(columns, n, header)) for n in range(3)]
    # A point is three sequences of one element, each after its length, and then the time.
    fields: list[tuple[int, NDArray[Any]]] = [
        (176, columns.transforms),
        (112, columns.velocities),
        (56, columns.accelerations),
        (8, columns.times),
    ]
    return with_elements(short, fields)


def _columns(trajectory: Trajectory) -> _Columns:
    """Return the points of a trajectory as arrays."""
    n_points = len(trajectory.times)
    transforms, velocities, accelerations = (np.zeros((n_points, n)) for n in (7, 6, 6))
    times = np.zeros((n_points, 2), dtype=np.int32)
    yaws = yaws_along(trajectory)
    transforms[:, :2] = trajectory.states[:, :2]
    transforms[:, 5], transforms[:, 6] = np.sin(yaws / 2.0), np.cos(yaws / 2.0)
    velocities[:, :2] = trajectory.states[:, 2:]
    accelerations[:-1, :2] = trajectory.controls
    nanoseconds = np.rint(trajectory.times * 1e9).astype(np.int64)
    times[:, 0], times[:, 1] = np.divmod(nanoseconds, 10**9)
    return _Columns(transforms, velocities, accelerations, times)


def _message(columns: _Columns, n_points: int, header: Header) -> MultiDOFJointTrajectory:
    """Return the message object with the first ``n_points`` points, or all if there are fewer."""
    rows = zip(*(column[:n_points].tolist() for column in columns), strict=True)
    return MultiDOFJointTrajectory(
        header=header, joint_names=[JOINT], points=[_point(*row) for row in rows]
    )


def _point(
    transform: list[float], velocity: list[float], acceleration: list[float], time: list[int]
) -> MultiDOFJointTrajectoryPoint:
    x, y, z, *rotation = transform
    pose = Transform(
        translation=Vector3(x=x, y=y, z=z),
        rotation=Quaternion(**dict(zip('xyzw', rotation, strict=True))),
    )
    return MultiDOFJointTrajectoryPoint(
        transforms=[pose],
        velocities=[_twist(velocity)],
        accelerations=[_twist(acceleration)],
        time_from_start=Duration(sec=time[0], nanosec=time[1]),
    )


def _twist(numbers: list[float]) -> Twist:
    linear, angular = numbers[:3], numbers[3:]
    return Twist(
        linear=Vector3(**dict(zip('xyz', linear, strict=True))),
        angular=Vector3(**dict(zip('xyz', angular, strict=True))),
    )
