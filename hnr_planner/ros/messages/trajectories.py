"""``trajectory_msgs/MultiDOFJointTrajectory``: what a robot with inertia does over time."""

from builtin_interfaces.msg import Duration
from geometry_msgs.msg import Quaternion, Transform, Twist, Vector3
from hnr_planner.server.orientations import quaternion_of
from hnr_planner.server.responses import PlanResponse
from hnr_planner.server.trajectories import yaws_along
import numpy as np
from numpy.typing import NDArray
from std_msgs.msg import Header
from trajectory_msgs.msg import MultiDOFJointTrajectory, MultiDOFJointTrajectoryPoint


def trajectory_message(response: PlanResponse, header: Header) -> MultiDOFJointTrajectory:
    """
    Return the trajectory of a response; it has no points where there is none.

    It has a point for each time at which the acceleration changes, with the acceleration from
    there on: in between positions are quadratic, so that a cubic through positions and velocities
    is exact.
    """
    message = MultiDOFJointTrajectory(header=header, joint_names=['base'])
    trajectory = response.trajectory
    if not response.solved or trajectory is None:
        return message
    accelerations = np.vstack([trajectory.controls, np.zeros(2)])
    columns = trajectory.times, trajectory.states, yaws_along(trajectory), accelerations
    for time, state, yaw, acceleration in zip(*columns, strict=True):
        message.points.append(_point(time, state[:2], yaw, state[2:], acceleration))
    return message


def _point(
    time: float,
    position: NDArray[np.float64],
    yaw: float,
    velocity: NDArray[np.float64],
    acceleration: NDArray[np.float64],
) -> MultiDOFJointTrajectoryPoint:
    x, y, z, w = quaternion_of(float(yaw))
    pose = Transform(
        translation=_vector(position),
        rotation=Quaternion(x=x, y=y, z=z, w=w),
    )
    nanoseconds = round(time * 1e9)
    return MultiDOFJointTrajectoryPoint(
        transforms=[pose],
        velocities=[Twist(linear=_vector(velocity))],
        accelerations=[Twist(linear=_vector(acceleration))],
        time_from_start=Duration(sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9),
    )


def _vector(xy: NDArray[np.float64]) -> Vector3:
    return Vector3(x=float(xy[0]), y=float(xy[1]))
