"""The node's health, as diagnostic viewers show it, once a second on `/diagnostics`."""

from collections.abc import Callable

from diagnostic_msgs.msg import DiagnosticArray
from hnr_planner.ros.interfaces.request_server import RequestServer
from hnr_planner.ros.map.map_input import MapInput
from hnr_planner.ros.messages.outcomes import health_message
from hnr_planner.server.outcomes import Refusal
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.clock import Clock, ClockType
from rclpy.node import Node

PERIOD = 1.0
"""Seconds from one report to the next, by the steady clock: a simulation that stands is seen."""


class Health:
    """
    Reports whether the node can plan, or why not, and what it has done so far.

    Parameters
    ----------
    node : Node
        Whose health it is.
    find_map_input : callable
        Returns where maps come from now, or raises Refusal.
    server : RequestServer
        Whose requests are counted.

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
            self._report,
            callback_group=MutuallyExclusiveCallbackGroup(),
            clock=Clock(clock_type=ClockType.STEADY_TIME),
        )

    def _report(self) -> None:
        try:
            self._server.searches.check_enabled()
            values, state = self._map_values(), 'ready'
            ready = True
        except Refusal as refusal:
            ready, state, values = False, f'{refusal.outcome.name}: {refusal.why}', {}
        name = f'{self._node.get_fully_qualified_name()}: planner'
        stamp = self._node.get_clock().now().to_msg()
        values |= self._request_values()
        self._publisher.publish(health_message(ready, name, state, values, stamp))

    def _map_values(self) -> dict[str, str]:
        """Return what is to be known about the map in use, or raise Refusal."""
        map_input = self._find_map_input()
        return {'map': str(map_input.newest().grid), 'map_age': f'{map_input.age:.1f}'}

    def _request_values(self) -> dict[str, str]:
        """Return how many requests there were, how they ended, and how long they took."""
        summary = self._server.statistics.summary()
        return {
            'requests': str(summary.requests),
            'running': str(len(self._server.searches)),
            'time_median': f'{summary.median:.6f}',
            'time_p95': f'{summary.p95:.6f}',
        } | {outcome.name: str(count) for outcome, count in summary.outcomes.items()}
