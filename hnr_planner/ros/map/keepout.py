"""
The subscriptions to keepout masks: the topic ``keepout``, and what Nav2's filters announce.

Nav2 announces a mask with ``nav2_msgs/CostmapFilterInfo``, which names the topic of the mask.
"""

from collections.abc import Callable
from typing import Any

from nav_msgs.msg import OccupancyGrid
from rclpy.callback_groups import CallbackGroup
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.subscription import Subscription

try:
    from nav2_msgs.msg import CostmapFilterInfo
except ImportError:  # a ROS from wheels has none
    HAVE_FILTERS = False
else:
    HAVE_FILTERS = True

#: The relative names of the topics of masks, and of Nav2's announcements.
TOPIC, ANNOUNCEMENTS = 'keepout', 'costmap_filter_info'

#: The type of a filter that Nav2 announces as keepout zones.
KEEPOUT_FILTER = 0

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class KeepoutMasks:
    """
    Subscribes to masks from construction to ``close``.

    Parameters
    ----------
    node : Node
        The node that subscribes and logs.
    receive : callable
        Called with the source of a mask, a topic, and the mask; with None for the mask where it
        is withdrawn.
    group : CallbackGroup
        The callback group of the subscription to maps.

    """

    def __init__(
        self,
        node: Node,
        receive: Callable[[str, OccupancyGrid | None], None],
        group: CallbackGroup,
    ) -> None:
        self._node = node
        self._receive = receive
        self._group = group
        self._subscriptions = [self._subscribe(TOPIC)]
        self._announced: Subscription | None = None
        if HAVE_FILTERS:
            self._subscriptions.append(
                node.create_subscription(
                    CostmapFilterInfo,
                    ANNOUNCEMENTS,
                    self._follow,
                    LATCHED,
                    callback_group=group,
                )
            )

    def close(self) -> None:
        """End the subscriptions."""
        for subscription in (*self._subscriptions, self._announced):
            if subscription is not None:
                self._node.destroy_subscription(subscription)

    def _subscribe(self, topic: str) -> Subscription:
        return self._node.create_subscription(
            OccupancyGrid,
            topic,
            lambda mask: self._receive(topic, mask),
            LATCHED,
            callback_group=self._group,
        )

    def _follow(self, filter_info: Any) -> None:
        """Subscribe to the mask of a keepout filter, in the place of the one before."""
        topic = filter_info.filter_mask_topic
        why = ''
        if filter_info.type != KEEPOUT_FILTER:
            why = f'it has type {filter_info.type}, and only keepout filters (0) are used'
        elif (filter_info.base, filter_info.multiplier) != (0.0, 1.0):
            why = (
                'base and multiplier must be 0 and 1 for a keepout filter, got '
                f'{filter_info.base:g} and {filter_info.multiplier:g}'
            )
        if why:
            self._node.get_logger().warning(f'{ANNOUNCEMENTS}: the filter is left out: {why}')
            return
        if self._announced is not None:
            before = self._announced.topic_name
            if before == self._node.resolve_topic_name(topic):
                return
            self._node.destroy_subscription(self._announced)
            self._receive(before, None)
        self._node.get_logger().info(f'{ANNOUNCEMENTS}: keepout zones come from {topic}')
        self._announced = self._subscribe(self._node.resolve_topic_name(topic))
