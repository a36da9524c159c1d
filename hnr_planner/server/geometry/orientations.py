"""Rotations in space as quaternions (x, y, z, w), and their yaw angles about z [rad]."""

import math

Quaternion = tuple[float, float, float, float]
Vector = tuple[float, float, float]

#: The quaternion of no rotation.
LEVEL: Quaternion = (0.0, 0.0, 0.0, 1.0)


def normalised(quaternion: Quaternion) -> Quaternion | None:
    """Return ``quaternion`` scaled to norm 1; None when it is all zeros or not finite."""
    largest = max(abs(number) for number in quaternion)
    if not all(math.isfinite(number) for number in quaternion) or largest == 0.0:
        return None
    # Scaled first: squares of tiny or huge numbers would vanish or overflow.
    scaled = [number / largest for number in quaternion]
    norm = math.hypot(*scaled)
    x, y, z, w = (number / norm for number in scaled)
    return x, y, z, w


def yaw_of(quaternion: Quaternion) -> float:
    """Return the yaw (angle about z) [rad], in -pi..pi, of a quaternion of norm 1."""
    x, y, z, w = quaternion
    return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def tilt_of(quaternion: Quaternion) -> float:
    """Return the angle [rad] by which a quaternion of norm 1 tilts the z axis, yaw left out."""
    x, y, _, _ = quaternion
    return 2.0 * math.asin(min(1.0, math.hypot(x, y)))


def quaternion_of(yaw: float) -> Quaternion:
    """Return the quaternion of a rotation by ``yaw`` [rad] about z."""
    return 0.0, 0.0, math.sin(yaw / 2.0), math.cos(yaw / 2.0)


def product(first: Quaternion, second: Quaternion) -> Quaternion:
    """Return the quaternion of the rotation by ``second``, followed by that by ``first``."""
    (ax, ay, az, aw), (bx, by, bz, bw) = first, second
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def rotated(vector: Vector, rotation: Quaternion) -> Vector:
    """Return ``vector`` rotated by a normalised quaternion."""
    x, y, z, w = rotation
    turned = product(product(rotation, (*vector, 0.0)), (-x, -y, -z, w))
    return turned[:3]
