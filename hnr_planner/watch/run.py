"""The process that serves the page: ROS in one thread, the server in another."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from contextlib import suppress
import os
import signal
import socket
import threading
from typing import NamedTuple

from hnr_planner.watch.access import check_access, is_loopback, WatchError
from hnr_planner.watch.hub import Hub
from hnr_planner.watch.node import Put, SLOTS, WatchNode
from hnr_planner.watch.server import application, Planning, Point
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.signals import SignalHandlerOptions
from tornado.httpserver import HTTPServer
from tornado.netutil import bind_sockets


class Served(NamedTuple):
    """
    What is served, where, and to whom.

    Attributes
    ----------
    planner : str
        Name of the planning node, with its namespace.
    map_topic : str
        Topic of its maps, relative to its namespace or absolute.
    host : str
        Address or name to serve on.
    port : int
        Port to serve on; 0 for any that is free.
    token : str, optional
        What a browser has to know; None for no token.
    requests : bool
        Whether a page may make the node plan.
    parent : int, optional
        Process with which this one ends; None for none.

    """

    planner: str
    map_topic: str
    host: str
    port: int
    token: str | None = None
    requests: bool = False
    parent: int | None = None


def watch(served: Served) -> None:
    """
    Serve the page until SIGINT, SIGTERM or the end of the parent process.

    Raises
    ------
    WatchError
        When the page would be open to whoever can reach it, the address cannot be served, or ROS
        refuses the name of the node or of the topic.

    """
    check_access(served.host, served.token)
    asyncio.run(_serve(served))


async def _serve(served: Served) -> None:
    loop = asyncio.get_running_loop()
    ended = asyncio.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, ended.set)
    if served.parent is not None:
        _call_at_end(served.parent, ended.set)
    planner = f'/{served.planner.lstrip("/")}'

    def put(slot: str, message: bytes) -> None:
        loop.call_soon_threadsafe(hub.put, slot, message)

    def watch_or_not(wanted: bool) -> None:
        ros.do(lambda: _watch(ros.node, wanted, lambda: hub.forget(*SLOTS), loop))

    hub = Hub(watch_or_not)
    ros = _Ros(planner, served.map_topic, put, lambda: loop.call_soon_threadsafe(ended.set))
    try:
        sockets = _bind(served)
        plan = _planning(ros, loop) if served.requests else None
        server = HTTPServer(application(hub, planner, served.token, plan))
        server.add_sockets(sockets)
        print(f'{_address(served, sockets)} shows {planner}', flush=True)
        await ended.wait()
        server.stop()
        await server.close_all_connections()
    finally:
        ros.close()
    if ros.failure is not None:
        raise ros.failure


def _watch(
    node: WatchNode, wanted: bool, forget: Callable[[], None], loop: asyncio.AbstractEventLoop
) -> None:
    """Subscribe the node; or unsubscribe it, and ``forget`` its messages in the event loop."""
    node.watch(wanted)
    if not wanted:
        loop.call_soon_threadsafe(forget)


def _bind(served: Served) -> list[socket.socket]:
    try:
        return bind_sockets(served.port, served.host)
    except (OSError, OverflowError) as error:
        raise WatchError(
            f'port {served.port} of {served.host} cannot be served: {error}'
        ) from error


def _address(served: Served, sockets: list[socket.socket]) -> str:
    """Return the address that people open."""
    host = served.host
    if not is_loopback(host) and host in ('', '0.0.0.0', '::'):
        host = socket.gethostname()
    host = f'[{host}]' if ':' in host else host
    query = '' if served.token is None else '?token=...'
    return f'http://{host}:{sockets[0].getsockname()[1]}/{query}'


def _call_at_end(process: int, end: Callable[[], None]) -> None:
    """Call ``end`` when a process ends, or at once if it has ended already."""
    try:
        descriptor = os.pidfd_open(process)
    except OSError:
        end()
        return
    asyncio.get_running_loop().add_reader(descriptor, end)


def _planning(ros: _Ros, loop: asyncio.AbstractEventLoop) -> Planning:
    """Return a function that plans in the thread of ROS and calls back in the event loop."""

    def plan(start: Point, goal: Point, end: Callable[[str], None]) -> None:
        def end_in_loop(why: str) -> None:
            loop.call_soon_threadsafe(end, why)

        ros.do(lambda: ros.node.plan(start, goal, end_in_loop))

    return plan


class _Ros:
    """
    The node and the thread that runs its callbacks, from construction to ``close``.

    ``failed`` is called when a callback raises; ``failure`` is what it raised.
    """

    def __init__(
        self, planner: str, map_topic: str, put: Put, failed: Callable[[], object]
    ) -> None:
        self._context = Context()
        rclpy.init(args=[], context=self._context, signal_handler_options=SignalHandlerOptions.NO)
        try:
            self.node = WatchNode(planner, map_topic, put, self._context)
        except RuntimeError as error:
            rclpy.try_shutdown(context=self._context)
            raise WatchError(' '.join(str(error).split())) from error
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._is_ending = False
        self._failed = failed
        self.failure: Exception | None = None
        self._thread = threading.Thread(target=self._spin, name='ros', daemon=True)
        self._thread.start()

    def do(self, work: Callable[[], None]) -> None:
        """Run ``work`` in the thread of the callbacks, unless that is ending."""
        if not self._is_ending:
            self._executor.create_task(work)

    def close(self) -> None:
        """End the thread and the node."""
        self._is_ending = True
        self._executor.wake()
        self._thread.join()
        self._executor.shutdown()
        self.node.destroy_node()
        rclpy.try_shutdown(context=self._context)

    def _spin(self) -> None:
        try:
            while not self._is_ending:
                # What a callback destroys may be gone when the executor looks at it.
                with suppress(rclpy_implementation.InvalidHandle):
                    self._executor.spin_once(timeout_sec=1.0)
        except Exception as error:
            self.failure = error
            self._failed()
