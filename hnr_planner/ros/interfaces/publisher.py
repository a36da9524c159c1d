"""The publisher, whose own thread logs and publishes how each request ended."""

from collections import deque
from itertools import chain
import queue
import threading

from builtin_interfaces.msg import Time as TimeMessage
from diagnostic_msgs.msg import DiagnosticArray
from hnr_planner.ros.interfaces.publications import Publication, TOPICS
from hnr_planner.ros.messages.outcomes import outcome_message
from hnr_planner.server.request_log import LogEntry
from hnr_planner.server.responses import PlanResponse
from rclpy.clock import Clock
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.time import Time

#: Number of the latest outcomes that late subscribers get.
OUTCOMES_KEPT = 100

#: Longest wait, for each topic, until subscribers have its last message when the node ends.
LONGEST_DELIVERY = Duration(seconds=0.2)

#: Longest time [s] that a publication waits for its response to be sent; the publications after
#: it wait for it too.
LONGEST_HOLD = 0.1

#: With more publications waiting, samples and markers (pictures for people) are left out.
LONGEST_BACKLOG = 20


def latched(depth: int) -> QoSProfile:
    """Return the profile of a topic whose last ``depth`` messages reach late subscribers."""
    return QoSProfile(
        depth=depth,
        durability=DurabilityPolicy.TRANSIENT_LOCAL,
        reliability=ReliabilityPolicy.RELIABLE,
    )


class Publisher:
    """
    Logs and publishes how each request ended, in the order of the stamps of the messages.

    Responses do not wait for that: ``hand_over`` only puts a publication into a queue. The thread
    that handed it over has to call ``response_sent`` once its response has been sent; that wakes
    the publishing thread.
    """

    def __init__(self, node: Node) -> None:
        self._name = node.get_fully_qualified_name()
        self._logger = node.get_logger()
        self._stamps = _Stamps(node.get_clock())
        self._outcome = node.create_publisher(DiagnosticArray, '~/outcome', latched(OUTCOMES_KEPT))
        self._publishers = {
            topic: node.create_publisher(kind, f'~/{topic}', latched(1))
            for topic, kind in TOPICS.items()
        }
        self._pictures = True
        self._in_order = threading.Lock()
        self._responding = _Responding()
        self._waiting: deque[tuple[Publication, threading.Event]] = deque()
        self._wake: queue.SimpleQueue[bool] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._publish_all, name='publish', daemon=True)
        self._thread.start()

    def hand_over(self, publication: Publication) -> None:
        """
        Stamp the header of a publication and queue it.

        It is logged and published once this thread has called ``response_sent``.
        """
        self._responding.sent = sent = threading.Event()
        with self._in_order:
            publication.header.stamp = self._stamps.later()
            self._waiting.append((publication, sent))

    def response_sent(self) -> None:
        """Release the publication that this thread handed over last; do nothing without one."""
        if self._responding.sent is not None:
            self._responding.sent.set()
            self._responding.sent = None
            self._wake.put(True)

    def announce(self, response: PlanResponse, caller: str) -> None:
        """Publish an outcome that belongs to no request, at once, under the name ``caller``."""
        name = f'{self._name}/{caller}'
        with self._in_order:
            self._outcome.publish(outcome_message(response, name, self._stamps.later()))

    def leave_out_pictures(self) -> None:
        """Publish no more pictures (samples and markers), so that the node can end soon."""
        self._pictures = False

    def close(self) -> None:
        """Publish what still waits, end the thread, and wait a short time for subscribers."""
        self._wake.put(False)
        self._thread.join()
        for publisher in (self._outcome, *self._publishers.values()):
            publisher.wait_for_all_acked(LONGEST_DELIVERY)

    def _publish_all(self) -> None:
        while self._wake.get():
            self._publish_next()
        while self._waiting:
            self._publish_next()

    def _publish_next(self) -> None:
        publication, sent = self._waiting.popleft()
        sent.wait(LONGEST_HOLD)
        try:
            self._log(publication.log)
            self._publish(publication)
        except Exception as error:  # must not stop those that follow
            self._logger.error(f'a publication failed: {error!r}')

    def _log(self, entry: LogEntry) -> None:
        # A line of source for each level: rclpy refuses to log at two levels from one.
        if entry.level == 'warning':
            self._logger.warning(entry.text)
        elif entry.level == 'info':
            self._logger.info(entry.text)
        else:
            self._logger.debug(entry.text)

    def _publish(self, publication: Publication) -> None:
        header, name = publication.header, f'{self._name}/{publication.caller}'
        self._outcome.publish(outcome_message(publication.response, name, header.stamp))
        messages = publication.messages()
        if self._pictures and len(self._waiting) <= LONGEST_BACKLOG:
            messages = chain(messages, publication.pictures())
        for topic, message in messages:
            self._publishers[topic].publish(message)


class _Responding(threading.local):
    """For each thread, the event to set when the response to its last request has been sent."""

    def __init__(self) -> None:
        self.sent: threading.Event | None = None


class _Stamps:
    """Stamps of the time now, in strictly increasing order even if the clock is set back."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._last = 0

    def later(self) -> TimeMessage:
        """Return the time now, or the last stamp plus 1 ns where that is later."""
        self._last = max(self._clock.now().nanoseconds, self._last + 1)
        return Time(nanoseconds=self._last).to_msg()
