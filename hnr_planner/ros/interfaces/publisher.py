"""The publisher, whose own thread logs and publishes how each request ended."""

from collections import deque
from collections.abc import Callable
import enum
import math
import queue
import threading
import time

from builtin_interfaces.msg import Time as TimeMessage
from diagnostic_msgs.msg import DiagnosticArray
from hnr_planner.ros.interfaces.pictures import PicturePublisher
from hnr_planner.ros.interfaces.profiles import latched
from hnr_planner.ros.interfaces.publications import Publication, TOPICS
from hnr_planner.ros.messages.outcomes import outcome_message
from hnr_planner.server.parameters.settings import MOST_ALTERNATIVES
from hnr_planner.server.responses.plan_response import PlanResponse
from hnr_planner.server.responses.request_log import LogEntry
from hnr_planner.server.responses.response import Response
from rclpy.clock import Clock
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.node import Node
from rclpy.time import Time

#: Number of the latest outcomes, and of paths of the latest request, that late subscribers get.
OUTCOMES_KEPT, PATHS_KEPT = 100, MOST_ALTERNATIVES

#: Longest wait, for each topic, until subscribers have its last message when the node ends.
LONGEST_DELIVERY = Duration(seconds=0.2)

#: Longest time [s] that a publication waits for its response to be sent; the publications after
#: it wait for it too.
LONGEST_HOLD = 0.1

#: Events of a publisher of the node: none. Those of rclpy warn of subscribers that ask for more
#: than is offered, which latched topics rule out, and each costs time at every request.
NO_EVENTS = PublisherEventCallbacks(use_default_callbacks=False)

#: Topics with pictures for people, of those of publications.
PICTURES = ('samples', 'markers')

#: With more publications waiting, samples and markers (pictures for people) are left out.
LONGEST_BACKLOG = 20


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
        self._wake: queue.SimpleQueue[_Wake] = queue.SimpleQueue()
        self._outcome = node.create_publisher(
            DiagnosticArray, '~/outcome', latched(OUTCOMES_KEPT), event_callbacks=NO_EVENTS
        )
        self._publishers = {
            topic: node.create_publisher(
                kind,
                f'~/{topic}',
                latched(PATHS_KEPT if topic == 'paths' else 1),
                event_callbacks=self._on_match(topic),
            )
            for topic, kind in TOPICS.items()
        }
        self._pictures = PicturePublisher({name: self._publishers[name] for name in PICTURES})
        self._showing = True
        self._in_order = threading.Lock()
        self._responding = _Responding()
        self._waiting: deque[tuple[Publication, _Sending]] = deque()
        self._thread = threading.Thread(target=self._publish_all, name='publish', daemon=True)
        self._thread.start()

    def hand_over(self, publication: Publication) -> None:
        """
        Stamp the header of a publication and queue it.

        It is logged and published once this thread has called ``response_sent``.
        """
        self._responding.now = sending = _Sending()
        with self._in_order:
            publication.header.stamp = self._stamps.later()
            self._waiting.append((publication, sending))

    def response_sent(self) -> None:
        """Release the publication that this thread handed over last; do nothing without one."""
        if self._responding.now is not None:
            self._responding.now.end()
            self._responding.now = None
            self._wake.put(_Wake.RESPONSE)

    def announce(self, response: PlanResponse, caller: str) -> None:
        """Publish an outcome that belongs to no request, at once, under the name ``caller``."""
        name = f'{self._name}/{caller}'
        with self._in_order:
            self._outcome.publish(outcome_message(response, name, self._stamps.later()))

    def leave_out_pictures(self) -> None:
        """Publish no more pictures (samples and markers), so that the node can end soon."""
        self._showing = False

    def close(self) -> None:
        """Publish what still waits, end the thread, and wait a short time for subscribers."""
        self._wake.put(_Wake.END)
        self._thread.join()
        for publisher in (self._outcome, *self._publishers.values()):
            publisher.wait_for_all_acked(LONGEST_DELIVERY)

    def _publish_all(self) -> None:
        while (reason := self._wake.get()) is not _Wake.END:
            self._safely(
                self._publish_next if reason is _Wake.RESPONSE else self._pictures.catch_up
            )
        while self._waiting:
            self._safely(self._publish_next)

    def _safely(self, work: Callable[[], None]) -> None:
        """Do ``work``, and log a failure, which must not stop what follows."""
        try:
            work()
        except Exception as error:
            self._logger.error(f'a publication failed: {error!r}')

    def _publish_next(self) -> None:
        publication, sending = self._waiting.popleft()
        response = publication.response.sent_after(sending.wait(LONGEST_HOLD))
        self._log(publication.log)
        self._publish(publication, response)

    def _on_match(self, topic: str) -> PublisherEventCallbacks:
        """Return what makes the picture of a topic once a subscriber is there."""
        if topic not in PICTURES:
            return NO_EVENTS
        return PublisherEventCallbacks(
            matched=lambda _: self._wake.put(_Wake.SUBSCRIBER), use_default_callbacks=False
        )

    def _log(self, entry: LogEntry) -> None:
        # A line of source for each level: rclpy refuses to log at two levels from one.
        if entry.level == 'warning':
            self._logger.warning(entry.text)
        elif entry.level == 'info':
            self._logger.info(entry.text)
        else:
            self._logger.debug(entry.text)

    def _publish(self, publication: Publication, response: Response) -> None:
        """Publish all about a request; ``response`` is how it ended, sending included."""
        header, name = publication.header, f'{self._name}/{publication.caller}'
        self._outcome.publish(outcome_message(response, name, header.stamp))
        for topic, message in publication.messages():
            self._pictures.forget(topic)
            self._publishers[topic].publish(message)
        if self._showing and len(self._waiting) <= LONGEST_BACKLOG:
            self._pictures.show(publication.pictures())


class _Wake(enum.Enum):
    """
    Reasons to wake the publishing thread.

    RESPONSE: a response was sent. SUBSCRIBER: a topic of a picture may have a new subscriber. END:
    the node ends.
    """

    RESPONSE = enum.auto()
    SUBSCRIBER = enum.auto()
    END = enum.auto()


class _Sending:
    """The sending of a response, from construction to ``end``."""

    def __init__(self) -> None:
        self._began = time.monotonic()
        self._sent = threading.Event()
        self._ended = math.nan

    def end(self) -> None:
        """Mark the response as sent."""
        self._ended = time.monotonic()
        self._sent.set()

    def wait(self, patience: float) -> float:
        """Wait ``patience`` [s] at most for the end; return the time [s] that the sending took."""
        if self._sent.wait(patience):
            return self._ended - self._began
        return time.monotonic() - self._began


class _Responding(threading.local):
    """For each thread, the sending of the response to its last request."""

    def __init__(self) -> None:
        self.now: _Sending | None = None


class _Stamps:
    """Stamps of the time now, in strictly increasing order even if the clock is set back."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._last = 0

    def later(self) -> TimeMessage:
        """Return the time now, or the last stamp plus 1 ns where that is later."""
        self._last = max(self._clock.now().nanoseconds, self._last + 1)
        return Time(nanoseconds=self._last).to_msg()
