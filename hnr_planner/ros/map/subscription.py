"""The subscription to ``map``, whose quality of service adapts to what publishers offer."""

from collections.abc import Callable
import threading

from nav_msgs.msg import OccupancyGrid
from rclpy.callback_groups import CallbackGroup
from rclpy.clock import Clock, ClockType
from rclpy.event_handler import QoSRequestedIncompatibleQoSInfo, SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import (
    DurabilityPolicy,
    qos_check_compatible,
    QoSCompatibility,
    QoSPolicyKind,
    QoSProfile,
    ReliabilityPolicy,
)
from rclpy.subscription import Subscription

#: The relative name of the topic of maps.
TOPIC = 'map'

#: Time [s], by the steady clock, between checks whether the preferred profile can be used again.
LOOK_EVERY = 1.0


class MapSubscription:
    """
    One subscription to the map, by preference reliable and, with ``transient_local``, latched.

    When a publisher offers less, a warning is logged, and a new subscription that accepts it takes
    the place of the old one; once every publisher offers the preferred profile, that is used
    again. All this happens in the callback group ``group``, whose callbacks must exclude each
    other. ``receive`` is called with each map.
    """

    def __init__(
        self,
        node: Node,
        receive: Callable[[OccupancyGrid], None],
        transient_local: bool,
        group: CallbackGroup,
    ) -> None:
        self._node = node
        self._receive = receive
        self._group = group
        durability = DurabilityPolicy.TRANSIENT_LOCAL if transient_local else _VOLATILE
        self._preferred = _profile(durability, ReliabilityPolicy.RELIABLE)
        self._one_at_a_time = threading.Lock()
        self._closed = False
        self._subscription = self._subscribe(self._preferred)
        self._timer = node.create_timer(
            LOOK_EVERY,
            self._go_back_if_possible,
            callback_group=self._group,
            clock=Clock(clock_type=ClockType.STEADY_TIME),
        )

    @property
    def topic(self) -> str:
        """Full name of the topic."""
        return str(self._subscription.topic_name)

    def close(self) -> None:
        """End the subscription for good."""
        with self._one_at_a_time:
            self._closed = True
            self._node.destroy_timer(self._timer)
            self._node.destroy_subscription(self._subscription)

    def _go_back_if_possible(self) -> None:
        """Use the preferred profile again if there are publishers, and all of them offer it."""
        if self._subscription.qos_profile.durability == self._preferred.durability and (
            self._subscription.qos_profile.reliability == self._preferred.reliability
        ):
            return
        publishers = self._node.get_publishers_info_by_topic(self.topic)
        if publishers and all(_serves(info.qos_profile, self._preferred) for info in publishers):
            self._node.get_logger().info(
                f'{self.topic}: every publisher offers {_in_words(self._preferred)} now; '
                'subscribed that way again'
            )
            self._replace(self._preferred)

    def _accept_less(self, event: QoSRequestedIncompatibleQoSInfo) -> None:
        """Subscribe with what an incompatible publisher offers, and warn of what that misses."""
        now = self._subscription.qos_profile
        durability, reliability = now.durability, now.reliability
        if event.last_policy_kind == QoSPolicyKind.DURABILITY:
            durability = _VOLATILE
        elif event.last_policy_kind == QoSPolicyKind.RELIABILITY:
            reliability = ReliabilityPolicy.BEST_EFFORT
        else:
            return
        lesser = _profile(durability, reliability)
        missing = (
            'a map that was published before this moment is not received'
            if durability == _VOLATILE
            else 'a map that gets lost on the way is not sent again'
        )
        self._node.get_logger().warning(
            f'{self.topic}: a publisher offers less than {_in_words(now)}, so nothing would come '
            f'from it; subscribed anew as {_in_words(lesser)}: {missing}'
        )
        self._replace(lesser)

    def _replace(self, profile: QoSProfile) -> None:
        with self._one_at_a_time:
            if not self._closed:
                old = self._subscription
                self._subscription = self._subscribe(profile)
                self._node.destroy_subscription(old)

    def _subscribe(self, profile: QoSProfile) -> Subscription:
        return self._node.create_subscription(
            OccupancyGrid,
            TOPIC,
            self._receive,
            profile,
            callback_group=self._group,
            event_callbacks=SubscriptionEventCallbacks(incompatible_qos=self._accept_less),
        )


_VOLATILE = DurabilityPolicy.VOLATILE


def _profile(durability: DurabilityPolicy, reliability: ReliabilityPolicy) -> QoSProfile:
    return QoSProfile(depth=1, durability=durability, reliability=reliability)


def _serves(offered: QoSProfile, requested: QoSProfile) -> bool:
    """Return whether a publisher with ``offered`` reaches a subscription with ``requested``."""
    compatibility, _ = qos_check_compatible(offered, requested)
    return compatibility != QoSCompatibility.ERROR


def _in_words(profile: QoSProfile) -> str:
    """Return the reliability and durability of ``profile`` as text."""
    return f'{profile.reliability.name} and {profile.durability.name}'.lower().replace('_', ' ')
