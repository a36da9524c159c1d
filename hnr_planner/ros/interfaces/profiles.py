"""QoS profiles; this module is for nodes that plan nothing, too, and imports nothing large."""

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy


def latched(depth: int) -> QoSProfile:
    """Return the profile of a topic whose last ``depth`` messages reach late subscribers."""
    return QoSProfile(
        depth=depth,
        durability=DurabilityPolicy.TRANSIENT_LOCAL,
        reliability=ReliabilityPolicy.RELIABLE,
    )
