"""
Motions of a pose along a constant twist: q exp(s u) and its inverse.

A pose is (x, y, yaw). A twist (vx, vy, omega) is a velocity in the robot's own frame; held for the
time s it moves the pose ``q`` to ``q exp(s u)``: along a straight line, on the spot, or along a
circular arc. The poses that a pose reaches, forwards and backwards, are its *orbit*.
"""

import math

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import inlined, kernel
import numpy as np
from numpy.typing import NDArray


@inlined
def wrapped(yaw):
    """Return the angle in [-pi, pi) equal to ``yaw`` up to whole turns [rad]; nan for none."""
    if -math.pi <= yaw < math.pi:
        return yaw
    turned = yaw - 2.0 * math.pi * np.floor((yaw + math.pi) / (2.0 * math.pi))
    return -math.pi if turned >= math.pi else turned


@inlined
def moved(x, y, yaw, vx, vy, omega, s):
    """
    Return the pose (x, y, yaw) after the twist (vx, vy, omega) was held for ``s``.

    The chord of the arc is used, which stays exact when the twist hardly turns. The yaw is not
    wrapped.
    """
    half = omega * s / 2.0
    length = s * (math.sin(half) / half) if half != 0.0 else s
    cos, sin = math.cos(yaw + half), math.sin(yaw + half)
    return (
        x + length * (cos * vx - sin * vy),
        y + length * (sin * vx + cos * vy),
        yaw + omega * s,
    )


@inlined
def carried(x, y, cos, sin, vx, vy, omega, s):
    """
    Return the pose (x, y, cos, sin) after a twist was held for ``s``, as ``moved`` does.

    The yaw is given by its cosine and sine, so that two functions of an angle are enough.
    """
    if omega == 0.0:
        return x + s * (cos * vx - sin * vy), y + s * (sin * vx + cos * vy), cos, sin
    half = omega * s / 2.0
    half_cos, half_sin = math.cos(half), math.sin(half)
    length = 2.0 * half_sin / omega
    mid_cos, mid_sin = cos * half_cos - sin * half_sin, sin * half_cos + cos * half_sin
    return (
        x + length * (mid_cos * vx - mid_sin * vy),
        y + length * (mid_sin * vx + mid_cos * vy),
        mid_cos * half_cos - mid_sin * half_sin,
        mid_sin * half_cos + mid_cos * half_sin,
    )


@kernel
def orbit_poses(pose, twist, times):
    """Return the poses (k, 3) that ``pose`` (3,) has on the orbit of ``twist`` at ``times``."""
    poses = np.empty((len(times), 3))
    for k in range(len(times)):
        x, y, yaw = moved(pose[0], pose[1], pose[2], twist[0], twist[1], twist[2], times[k])
        poses[k, 0], poses[k, 1], poses[k, 2] = x, y, wrapped(yaw)
    return poses


def wrap(yaws: Floats) -> NDArray[np.float64]:
    """Return angles in [-pi, pi), equal to ``yaws`` up to whole turns [rad], in a new array."""
    turned = np.asarray(yaws) - 2.0 * np.pi * np.floor((np.asarray(yaws) + np.pi) / (2.0 * np.pi))
    return np.where(turned >= np.pi, -np.pi, turned)
