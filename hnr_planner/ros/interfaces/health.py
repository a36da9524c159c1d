"""The node's health, as diagnostic viewers show it, once a second on ``/diagnostics``."""

from collections.abc import Callable

from diagnostic_msgs.msg import DiagnosticArray
from hnr_planner.core.kernels.compilation import status
from hnr_planner.ros.interfaces.request_server import RequestServer
from hnr_planner.ros.map.map_input import MapInput
from hnr_planner.ros.messages.outcomes import health_message
from hnr_planner.server.outcomes import Refusal
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.clock import Clock, ClockType
from rclpy.node import Node

#: Seconds from one message to the next, by the steady clock: a simulation that stands is seen.
PERIOD = 1.0


class Health:
    """
    Publishes whether the node can plan, or why not, and what it has done so far.

    Parameters
    ----------
    node : Node
        The node that the health is of.
    find_map_input : callable
        Returns the input of maps, or raises Refusal.
    server : RequestServer
        Counts the requests.

    """

    def __init__(
        self, node: Node, find_map_input: Callable[[], MapInput], server: RequestServer
    ) -> None:
        self._node = node
        self._find_map_input = find_map_input
        self._server = server
        self._publisher = node.create_publisher(DiagnosticArray, '/diagnostics', 10)
        node.create_timer(
            PERIOD,
            self._publish,
            callback_group=MutuallyExclusiveCallbackGroup(),
            clock=Clock(clock_type=ClockType.STEADY_TIME),
        )

    def _publish(self) -> None:
        try:
            self._server.searches.check_enabled()
            ready, state, values = True, 'ready', self._map_values()
        except Refusal as refusal:
            ready, state, values = False, f'{refusal.outcome.name}: {refusal.why}', {}
        name = f'{self._node.get_fully_qualified_name()}: planner'
        stamp = self._node.get_clock().now().to_msg()
        values |= self._request_values() | _compilation_values()
        self._publisher.publish(health_message(ready, name, state, values, stamp))

    def _map_values(self) -> dict[str, str]:
        """Return size, frame and age of the map in use, or raise Refusal."""
        map_input = self._find_map_input()
        return {'map': str(map_input.newest().occupancy), 'map_age': f'{map_input.age:.1f}'}

    def _request_values(self) -> dict[str, str]:
        """Return how many requests there were, how they ended, and how long they took."""
        summary = self._server.statistics.summary()
        return {
            'requests': str(summary.requests),
            'running': str(len(self._server.searches)),
            'time_median': f'{summary.median:.6f}',
            'time_p95': f'{summary.p95:.6f}',
        } | {outcome.name: str(count) for outcome, count in summary.outcomes.items()}


def _compilation_values() -> dict[str, str]:
    """Return which tier serves, and how far compilation in the background is."""
    progress = status()
    return {
        'tier': progress.tier,
        'kernels_compiled': str(progress.compiled),
        'kernels_pending': str(progress.pending),
        'kernels_failed': str(progress.failed),
        'compilation_time': f'{progress.elapsed:.1f}',
    }
