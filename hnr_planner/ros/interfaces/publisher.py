"""Everything that is told about a request once it is answered, by a thread of its own."""

from collections import deque
from itertools import chain
import queue
import threading

from builtin_interfaces.msg import Time as TimeMessage
from diagnostic_msgs.msg import DiagnosticArray
from hnr_planner.ros.interfaces.publications import Publication, TOPICS
from hnr_planner.ros.messages.outcomes import outcome_message
from hnr_planner.server.responses import PlanResponse
from rclpy.clock import Clock
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.time import Time

OUTCOMES_KEPT = 100
LONGEST_DELIVERY = Duration(seconds=0.2)
"""How long the last message of a topic is given to arrive when the node ends."""
LONGEST_HOLD = 0.1
"""How long [s] a result waits for its answer to be sent, while later ones are sent already."""
LONGEST_BACKLOG = 20
"""Results that may wait; with more, samples and markers (pictures for people) are left out."""


def latched(depth: int) -> QoSProfile:
    """Return the profile of a topic whose last `depth` messages reach late subscribers."""
    return QoSProfile(
        depth=depth,
        durability=DurabilityPolicy.TRANSIENT_LOCAL,
        reliability=ReliabilityPolicy.RELIABLE,
    )


class Publisher:
    """
    Logs and publishes how each request ended, in the order of the stamps.

    No answer waits for that: `hand_over` costs the caller nothing but a place in a queue, and the
    thread that works it off wakes when `answer_sent` says that an answer is on its way. Whoever
    hands over has to say so.
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
        self._answering = _Answering()
        self._waiting: deque[tuple[Publication, threading.Event]] = deque()
        self._wake: queue.SimpleQueue[bool] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._publish_all, name='publish', daemon=True)
        self._thread.start()

    def hand_over(self, result: Publication) -> None:
        """Stamp the header of a result, and tell all about it soon."""
        self._answering.sent = sent = threading.Event()
        with self._in_order:
            result.header.stamp = self._stamps.later()
            self._waiting.append((result, sent))

    def answer_sent(self) -> None:
        """Say that the answer has been sent whose result this thread has handed over."""
        if self._answering.sent is not None:
            self._answering.sent.set()
            self._answering.sent = None
            self._wake.put(True)

    def announce(self, report: PlanResponse, name: str) -> None:
        """Publish an outcome that no request asked for."""
        with self._in_order:
            self._outcome.publish(outcome_message(report, name, self._stamps.later()))

    def leave_out_pictures(self) -> None:
        """Publish no more samples and markers: the last answers must not queue behind them."""
        self._pictures = False

    def close(self) -> None:
        """Publish what still waits, and end the thread once subscribers have it."""
        self._wake.put(False)
        self._thread.join()
        for publisher in (self._outcome, *self._publishers.values()):
            publisher.wait_for_all_acked(LONGEST_DELIVERY)

    def _publish_all(self) -> None:
        while self._wake.get():
            self._tell_next()
        while self._waiting:
            self._tell_next()

    def _tell_next(self) -> None:
        result, sent = self._waiting.popleft()
        sent.wait(LONGEST_HOLD)
        try:
            self._log(result)
            self._publish(result)
        except Exception as error:  # must not stop those that follow
            self._logger.error(f'could not tell about a result: {error!r}')

    def _log(self, result: Publication) -> None:
        """Say in one line how a request ended."""
        caller, report = result.caller, result.report
        if result.remark:
            self._logger.info(f'{caller}: {result.remark}')
        text = f'{caller}: {report.outcome.name} after {report.elapsed:.3f} s: {report.why}'
        if report.outcome.is_success:
            self._logger.info(text)
        else:
            self._logger.warning(text)

    def _publish(self, result: Publication) -> None:
        header, name = result.header, f'{self._name}/{result.caller}'
        self._outcome.publish(outcome_message(result.report, name, header.stamp))
        messages = result.messages()
        if self._pictures and len(self._waiting) <= LONGEST_BACKLOG:
            messages = chain(messages, result.pictures())
        for topic, message in messages:
            self._publishers[topic].publish(message)


class _Answering(threading.local):
    """The event of the answer that a thread is about to send."""

    def __init__(self) -> None:
        self.sent: threading.Event | None = None


class _Stamps:
    """The time now, but never the same stamp twice and never an earlier one."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._last = 0

    def later(self) -> TimeMessage:
        """Return a stamp later than all before."""
        self._last = max(self._clock.now().nanoseconds, self._last + 1)
        return Time(nanoseconds=self._last).to_msg()
