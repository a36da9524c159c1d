"""The subscription to updates of parts of the map, where ``map_msgs`` is installed."""

from collections.abc import Callable
from typing import Any

from rclpy.callback_groups import CallbackGroup
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.qos import QoSProfile

try:
    from map_msgs.msg import OccupancyGridUpdate
except ImportError:  # a ROS from wheels has none
    HAVE_MAP_MSGS = False
else:
    HAVE_MAP_MSGS = True

#: Reliable and volatile: a latched last update would be no use without the updates before it.
PROFILE = QoSProfile(depth=10)

#: Time [s], by the steady clock, between checks whether updates are sent that cannot be read.
LOOK_EVERY = 1.0


class MapUpdates:
    """
    Subscribes to updates of parts of the map, as Nav2's costmaps send them, until ``close``.

    Without ``map_msgs`` it only logs one warning, once the topic has a publisher.

    Parameters
    ----------
    node : Node
        The node that subscribes and logs.
    topic : str
        Full name of the topic of updates.
    receive : callable
        Called with each ``map_msgs/OccupancyGridUpdate``.
    group : CallbackGroup
        The callback group of the subscription to maps.

    """

    def __init__(
        self, node: Node, topic: str, receive: Callable[[Any], None], group: CallbackGroup
    ) -> None:
        self._node = node
        self._topic = topic
        if HAVE_MAP_MSGS:
            self._subscription = node.create_subscription(
                OccupancyGridUpdate, topic, receive, PROFILE, callback_group=group
            )
        else:
            self._timer = node.create_timer(
                LOOK_EVERY,
                self._warn_once,
                callback_group=group,
                clock=Clock(clock_type=ClockType.STEADY_TIME),
            )

    def close(self) -> None:
        """End the subscription, or the checks for updates that cannot be read."""
        if HAVE_MAP_MSGS:
            self._node.destroy_subscription(self._subscription)
        else:
            self._node.destroy_timer(self._timer)

    def _warn_once(self) -> None:
        if self._node.count_publishers(self._topic):
            self._node.get_logger().warning(
                f'{self._topic}: somebody sends updates of parts of the map, and they cannot be '
                'read without the package map_msgs: install it, or set always_send_full_costmap '
                'to true at the costmap'
            )
            self._timer.cancel()
