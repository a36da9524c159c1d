"""The health of the node, published once a second on ``/diagnostics`` for diagnostic viewers."""

from collections.abc import Callable

from diagnostic_msgs.msg import DiagnosticArray
from hnr_planner.core.kernels.compilation import status
from hnr_planner.ros.interfaces.publisher import NO_EVENTS
from hnr_planner.ros.interfaces.request_server import RequestServer
from hnr_planner.ros.map.map_input import MapInput
from hnr_planner.ros.messages.outcomes import health_message
from hnr_planner.server.requests.outcomes import Refusal
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.clock import Clock, ClockType
from rclpy.node import Node

#: Time [s] from one message to the next, by the steady clock: messages come even while simulated
#: time stands still.
PERIOD = 1.0


class Health:
    """
    Publishes whether the node can plan, or why not, with statistics of requests and kernels.

    Parameters
    ----------
    node : Node
        The node whose health is published.
    find_map_input : callable
        Returns the input of maps, or raises Refusal when the node is not configured.
    server : RequestServer
        The server that counts the requests, and knows whether they are admitted.

    """

    def __init__(
        self, node: Node, find_map_input: Callable[[], MapInput], server: RequestServer
    ) -> None:
        self._node = node
        self._find_map_input = find_map_input
        self._server = server
        self._publisher = node.create_publisher(
            DiagnosticArray, '/diagnostics', 10, event_callbacks=NO_EVENTS
        )
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
        values |= self._request_values() | self._roadmap_values() | _compilation_values()
        self._publisher.publish(health_message(ready, name, state, values, stamp))

    def _map_values(self) -> dict[str, str]:
        """Return a description of the map in use and its age [s], or raise Refusal without one."""
        map_input = self._find_map_input()
        return {'map': str(map_input.newest().occupancy), 'map_age': f'{map_input.age:.1f}'}

    def _request_values(self) -> dict[str, str]:
        """Return the numbers of all, running and ended requests, and the times [s] of searches."""
        summary = self._server.statistics.summary()
        return {
            'requests': str(summary.requests),
            'running': str(len(self._server.searches)),
            'time_median': f'{summary.median:.6f}',
            'time_p95': f'{summary.p95:.6f}',
        } | {outcome.name: str(count) for outcome, count in summary.outcomes.items()}

    def _roadmap_values(self) -> dict[str, str]:
        """Return the state, the times [s] and the memory [bytes] of the roadmap."""
        roadmap = self._server.roadmaps.state
        return {
            'roadmap': roadmap.state,
            'roadmap_build_time': f'{roadmap.build_time:.3f}',
            'roadmap_update_time': f'{roadmap.update_time:.3f}',
            'roadmap_memory': str(roadmap.n_bytes),
        }


def _compilation_values() -> dict[str, str]:
    """Return the tier (compiled or interpreted) of kernels, and the progress of compilation."""
    progress = status()
    return {
        'tier': progress.tier,
        'kernels_compiled': str(progress.compiled),
        'kernels_pending': str(progress.pending),
        'kernels_failed': str(progress.failed),
        'compilation_time': f'{progress.elapsed:.1f}',
    }
