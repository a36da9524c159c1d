"""Clients that do nothing but ask: each with a participant and a thread of its own."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from test.ros.harness import MANY, result_of, SOON, until
import threading
import time
from typing import NamedTuple

from nav_msgs.msg import Path as PathMessage
from nav_msgs.srv import GetPlan
import rclpy
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.task import Future


class Answered(NamedTuple):
    """A request, its path, and when it was sent and answered (monotonic clock) [s]."""

    request: GetPlan.Request
    path: PathMessage
    sent: float
    answered: float


class Caller:
    """One client of one service."""

    def __init__(self, service: str = '/hnr_planner/plan') -> None:
        self.answered: list[Answered] = []
        self._context = Context()
        rclpy.init(context=self._context)
        node = Node('caller', context=self._context, enable_rosout=False)
        self._client = node.create_client(GetPlan, service, qos_profile=MANY)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(node)
        self._thread = threading.Thread(target=self._spin, daemon=True)
        self._thread.start()

    def send(self, request: GetPlan.Request) -> Future:
        """Send a request, once the service is there, and return the future of its answer."""
        assert self._client.wait_for_service(SOON), f'no service {self._client.srv_name}'
        return self._client.call_async(request)

    def ask(self, request: GetPlan.Request, timeout: float = SOON) -> Answered:
        """Send a request, wait for its answer, keep both and return them."""
        sent = time.monotonic()
        path = result_of(self.send(request), timeout).plan
        self.answered.append(Answered(request, path, sent, time.monotonic()))
        return self.answered[-1]

    def ask_again_until_answered(self, request: GetPlan.Request) -> PathMessage:
        """
        Send a request every second until one is answered, and return the first answer.

        What is sent to a node that was killed a moment ago is lost: for a while DDS takes it for
        alive.
        """
        sent: list[Future] = []

        def answered() -> Future | None:
            if time.monotonic() - began >= len(sent):
                sent.append(self.send(request))
            return next((future for future in sent if future.done()), None)

        began = time.monotonic()
        return until(answered, 'an answer').result().plan

    def ask_all(self, requests: Iterable[GetPlan.Request]) -> threading.Thread:
        """Ask one after the other, in a thread that is returned."""

        def work() -> None:
            for request in requests:
                self.ask(request, timeout=60.0)

        thread = threading.Thread(target=work, daemon=True)
        thread.start()
        return thread

    def close(self) -> None:
        """End the client."""
        rclpy.try_shutdown(context=self._context)
        self._thread.join(SOON)

    def _spin(self) -> None:
        try:
            self._executor.spin()
        except ExternalShutdownException:
            pass


@contextmanager
def callers(count: int, service: str = '/hnr_planner/plan') -> Iterator[list[Caller]]:
    """Run so many clients for the length of a ``with`` block."""
    made = [Caller(service) for _ in range(count)]
    try:
        yield made
    finally:
        for caller in made:
            caller.close()
