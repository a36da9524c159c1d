"""Everything that is published about a request, by a thread of its own."""

from dataclasses import dataclass
import queue
import threading

from builtin_interfaces.msg import Time as TimeMessage
from diagnostic_msgs.msg import DiagnosticArray
from hnr_planner.ros.marker_messages import markers_message
from hnr_planner.ros.outcome_messages import outcome_message
from hnr_planner.ros.requests import Report
from hnr_planner.ros.sample_messages import samples_message
from nav_msgs.msg import Path
from rclpy.clock import Clock
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.time import Time
from sensor_msgs.msg import PointCloud2
from visualization_msgs.msg import MarkerArray

OUTCOMES_KEPT = 100
LONGEST_DELIVERY = Duration(seconds=0.2)
"""How long the last message of a topic is given to arrive when the node ends."""
LONGEST_BACKLOG = 20
"""Results that may wait; with more, samples and markers (pictures for people) are left out."""


def latched(depth: int) -> QoSProfile:
    """Return the profile of a topic whose last `depth` messages reach late subscribers."""
    return QoSProfile(
        depth=depth,
        durability=DurabilityPolicy.TRANSIENT_LOCAL,
        reliability=ReliabilityPolicy.RELIABLE,
    )


@dataclass(frozen=True, eq=False)
class _Result:
    """What is to be published about one request; `name` says who answered it."""

    report: Report
    path: Path
    name: str
    samples_max: int


class Publications:
    """
    Publishes outcome, path, samples and markers of each request, in the order of their stamps.

    `hand_over` costs the caller nothing but a place in a queue, so no answer waits for a picture.
    """

    def __init__(self, node: Node) -> None:
        self._logger = node.get_logger()
        self._stamps = _Stamps(node.get_clock())
        self._outcome = node.create_publisher(DiagnosticArray, '~/outcome', latched(OUTCOMES_KEPT))
        self._path = node.create_publisher(Path, '~/path', latched(1))
        self._samples = node.create_publisher(PointCloud2, '~/samples', latched(1))
        self._markers = node.create_publisher(MarkerArray, '~/markers', latched(1))
        self._pictures = True
        self._in_order = threading.Lock()
        self._waiting: queue.SimpleQueue[_Result | None] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._publish_all, name='publish', daemon=True)
        self._thread.start()

    def hand_over(self, report: Report, path: Path, name: str, samples_max: int) -> None:
        """Stamp `path`, the answer to a request, and publish all about it soon."""
        with self._in_order:
            # The poses share this header.
            path.header.stamp = self._stamps.later()
            self._waiting.put(_Result(report, path, name, samples_max))

    def announce(self, report: Report, name: str) -> None:
        """Publish an outcome that no request asked for."""
        with self._in_order:
            self._outcome.publish(outcome_message(report, name, self._stamps.later()))

    def leave_out_pictures(self) -> None:
        """Publish no more samples and markers: the last answers must not queue behind them."""
        self._pictures = False

    def close(self) -> None:
        """Publish what still waits, and end the thread once subscribers have it."""
        self._waiting.put(None)
        self._thread.join()
        for publisher in (self._outcome, self._path, self._samples, self._markers):
            publisher.wait_for_all_acked(LONGEST_DELIVERY)

    def _publish_all(self) -> None:
        while (result := self._waiting.get()) is not None:
            try:
                self._publish(result)
            except Exception as error:  # a lost picture must not stop those that follow
                self._logger.error(f'could not publish a result: {error!r}')

    def _publish(self, result: _Result) -> None:
        report, stamp = result.report, result.path.header.stamp
        self._outcome.publish(outcome_message(report, result.name, stamp))
        self._path.publish(result.path)
        if self._pictures and self._waiting.qsize() <= LONGEST_BACKLOG:
            cloud = samples_message(report.result, result.samples_max, report.frame, stamp)
            self._samples.publish(cloud)
            self._markers.publish(markers_message(report, stamp))


class _Stamps:
    """The time now, but never the same stamp twice and never an earlier one."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._last = 0

    def later(self) -> TimeMessage:
        """Return a stamp later than all before."""
        self._last = max(self._clock.now().nanoseconds, self._last + 1)
        return Time(nanoseconds=self._last).to_msg()
