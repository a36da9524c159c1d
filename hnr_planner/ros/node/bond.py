"""
The bond: a heartbeat by which Nav2's lifecycle manager sees that a node lives.

It needs the package ``bondpy``; without it there is no bond.
"""

import threading

from rclpy.duration import Duration
from rclpy.node import Node

try:
    from bondpy.bondpy import Bond
except ImportError:  # a ROS from wheels has none
    HAVE_BOND = False
else:
    HAVE_BOND = True

#: The relative name of the topic of heartbeats.
TOPIC = 'bond'

#: Times [s] between heartbeats, and without one until the bond counts as broken: the defaults of
#: the lifecycle manager.
HEARTBEAT_PERIOD, HEARTBEAT_TIMEOUT = 0.1, 4.0

#: Longest wait for the other side to confirm that the bond is broken.
LONGEST_FAREWELL = Duration(seconds=0.2)


class NodeBond:
    """
    A bond under the name of a node, from construction to ``close``; none without bondpy.

    ``was_formed`` is set once the other side has confirmed it.
    """

    def __init__(self, node: Node) -> None:
        self.was_formed = threading.Event()
        if not HAVE_BOND:
            node.get_logger().info(
                'no bond: the package bondpy is not installed; with the lifecycle manager of '
                'Nav2 set its bond_timeout to 0.0'
            )
            return
        self._node = node
        self._bond = Bond(node, TOPIC, node.get_name(), on_formed=self.was_formed.set)
        self._bond.heartbeat_period = HEARTBEAT_PERIOD
        self._bond.heartbeat_timeout = HEARTBEAT_TIMEOUT
        self._bond.start()

    def leave(self) -> None:
        """Break the bond, inform the other side, and wait ``LONGEST_FAREWELL`` at most for it."""
        if HAVE_BOND:
            self._bond.break_bond()
            self._bond.wait_until_broken(LONGEST_FAREWELL)

    def close(self) -> None:
        """
        Leave the bond, and end its subscription.

        To be called by a callback of its group, or when no callback runs any more.
        """
        if HAVE_BOND:
            self.leave()
            # ``shutdown`` alone would leave an unusable subscription in the node.
            self._node.destroy_subscription(self._bond.sub)
            self._bond.shutdown()
            self._node.destroy_publisher(self._bond.pub)
