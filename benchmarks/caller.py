"""The client that times answers of the planning node and of the ready-made one."""

from contextlib import suppress
from test.ros.harness import LATCHED, pose, SOON, stamp_of
import time
from typing import NamedTuple

from benchmarks.ready_made import NAME as READY_MADE
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped
from hnr_planner.ros.messages.outcomes import read_outcome
from nav_msgs.msg import OccupancyGrid
from nav_msgs.msg import Path as PathMessage
from nav_msgs.srv import GetPlan
import rclpy
from rclpy.client import Client
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import PointCloud2
from visualization_msgs.msg import MarkerArray

#: Where paths begin [m], if the caller names no other point.
START = (0.25, 0.25)
#: Time [s] for the planning node to publish everything about a request.
PAUSE = 0.02

#: Namespace of a node that sends a ready-made path of one pose: what rclpy alone costs.
BARE = '/bare'


class Pair(NamedTuple):
    """Times [s] of an answer of the planning node, of its search, and of the ready-made answer."""

    answer: float
    search: float
    ready_made: float


class Caller:
    """Client of both nodes; while it waits for an answer it does nothing that could delay it."""

    def __init__(self) -> None:
        self._context = Context()
        rclpy.init(context=self._context)
        self._node = Node('caller', context=self._context)
        self._executor = _executor(self._node)
        self._reader = Node('reader', context=self._context)
        self._reading = _executor(self._reader)
        self._maps = self._reader.create_publisher(OccupancyGrid, '/map', LATCHED)
        self._search_times: dict[tuple[int, int], float] = {}
        self._reader.create_subscription(
            DiagnosticArray, '/hnr_planner/outcome', self._read, LATCHED
        )
        self.planner = self._node.create_client(GetPlan, '/hnr_planner/plan')
        self.ready_made = self._node.create_client(GetPlan, f'/{READY_MADE}/plan')
        self.bare = self._node.create_client(GetPlan, f'{BARE}/{READY_MADE}/plan')

    def close(self) -> None:
        """End the client, so that nobody gets its map any more."""
        for node in (self._node, self._reader):
            node.destroy_node()
        rclpy.try_shutdown(context=self._context)

    def publish(self, message: OccupancyGrid) -> None:
        """Publish the map."""
        self._maps.publish(message)

    def listener(self) -> Node:
        """Return a node that subscribes to samples and markers, and ignores them."""
        node = Node('listener', context=self._context)
        for kind, topic in ((PointCloud2, 'samples'), (MarkerArray, 'markers')):
            node.create_subscription(kind, f'/hnr_planner/{topic}', _ignore, LATCHED, raw=True)
        return node

    def meet_ready_made(self, client: Client, goal: PoseStamped) -> None:
        """Request a ready-made path until it comes: before discovery ends, answers get lost."""
        deadline = time.monotonic() + SOON
        while True:
            with suppress(TimeoutError):
                self.ask(client, goal, patience=1.0)
                return
            if time.monotonic() > deadline:
                raise TimeoutError('the ready-made path does not come')

    def pair(self, goal: PoseStamped) -> Pair:
        """Measure both nodes, one after the other."""
        path, answer = self.ask(self.planner, goal)
        search = self._search_time(stamp_of(path))
        time.sleep(PAUSE)
        _, ready_made = self.ask(self.ready_made, goal)
        return Pair(answer, search, ready_made)

    def ask(
        self,
        client: Client,
        goal: PoseStamped,
        patience: float = SOON,
        start: tuple[float, float] = START,
    ) -> tuple[PathMessage, float]:
        """Request a path; return it and the round-trip time [s]."""
        client.wait_for_service(SOON)
        request = GetPlan.Request(start=pose(*start), goal=goal)
        began = time.perf_counter()
        future = client.call_async(request)
        # spin_until_future_complete would keep the tasks of all earlier calls.
        while not future.done() and time.perf_counter() - began < patience:
            self._executor.spin_once(patience)
        elapsed = time.perf_counter() - began
        if not future.done():
            raise TimeoutError(f'no answer from {client.srv_name}')
        return future.result().plan, elapsed

    def _search_time(self, stamp: tuple[int, int]) -> float:
        """Return the time of the search for an answer [s]."""
        deadline = time.monotonic() + SOON
        while stamp not in self._search_times:
            assert time.monotonic() < deadline, 'no outcome for an answer'
            self._reading.spin_once(SOON)
        return self._search_times.pop(stamp)

    def _read(self, message: DiagnosticArray) -> None:
        _, values = read_outcome(message)
        self._search_times[stamp_of(message)] = float(values['search_time']) + float(
            values['shortening_time']
        )


def _executor(node: Node) -> SingleThreadedExecutor:
    executor = SingleThreadedExecutor(context=node.context)
    executor.add_node(node)
    return executor


def _ignore(_message: bytes) -> None:
    """Ignore a message."""
