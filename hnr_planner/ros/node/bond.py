"""The bond by which Nav2's lifecycle manager sees that a node lives; it needs ``bondpy``."""

from rclpy.duration import Duration
from rclpy.node import Node

try:
    from bondpy.bondpy import Bond
except ImportError:  # a ROS from wheels has none
    HAVE_BOND = False
else:
    HAVE_BOND = True

#: The relative name of the topic.
TOPIC = 'bond'

#: Seconds, as the manager has them by default.
HEARTBEAT_PERIOD, HEARTBEAT_TIMEOUT = 0.1, 4.0

#: How long the end of the bond is published again and again.
LONGEST_FAREWELL = Duration(seconds=0.2)


class NodeBond:
    """A bond under the name of the node, kept from when it is made until ``close``."""

    def __init__(self, node: Node) -> None:
        if not HAVE_BOND:
            node.get_logger().info(
                'no bond: the package bondpy is not installed; with the lifecycle manager of '
                'Nav2 set its bond_timeout to 0.0'
            )
            return
        self._node = node
        self._bond = Bond(node, TOPIC, node.get_name())
        self._bond.heartbeat_period = HEARTBEAT_PERIOD
        self._bond.heartbeat_timeout = HEARTBEAT_TIMEOUT
        self._bond.start()

    def close(self) -> None:
        """Break the bond, and inform the other side."""
        if HAVE_BOND:
            self._bond.break_bond()
            self._bond.wait_until_broken(LONGEST_FAREWELL)
            # By itself it would leave the node with a subscription that is no more.
            self._node.destroy_subscription(self._bond.sub)
            self._bond.shutdown()
            self._node.destroy_publisher(self._bond.pub)
