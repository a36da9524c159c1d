"""Quaternions (x, y, z, w) and yaw angles [rad]."""

import math

Quaternion = tuple[float, float, float, float]
Vector = tuple[float, float, float]
LEVEL: Quaternion = (0.0, 0.0, 0.0, 1.0)


def normalised(quaternion: Quaternion) -> Quaternion | None:
    """Return `quaternion` with norm 1, or None when it has no direction: zero or not finite."""
    largest = max(abs(part) for part in quaternion)
    if not all(math.isfinite(part) for part in quaternion) or largest == 0.0:
        return None
    # Scaled first: squares of tiny or huge numbers would vanish or overflow.
    scaled = [part / largest for part in quaternion]
    norm = math.hypot(*scaled)
    x, y, z, w = (part / norm for part in scaled)
    return x, y, z, w


def yaw_of(quaternion: Quaternion) -> float:
    """Return the rotation about z of a normalised quaternion."""
    x, y, z, w = quaternion
    return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def tilt_of(quaternion: Quaternion) -> float:
    """Return the angle between the rotated and the upright z axis of a normalised quaternion."""
    x, y, _, _ = quaternion
    return 2.0 * math.asin(min(1.0, math.hypot(x, y)))


def quaternion_of(yaw: float) -> Quaternion:
    """Return the quaternion of a rotation by `yaw` about z."""
    return 0.0, 0.0, math.sin(yaw / 2.0), math.cos(yaw / 2.0)


def product(first: Quaternion, second: Quaternion) -> Quaternion:
    """Return the rotation by `second`, then by `first`."""
    (ax, ay, az, aw), (bx, by, bz, bw) = first, second
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def rotated(vector: Vector, rotation: Quaternion) -> Vector:
    """Return `vector` turned by a normalised quaternion."""
    x, y, z, w = rotation
    turned = product(product(rotation, (*vector, 0.0)), (-x, -y, -z, w))
    return turned[:3]
