"""
Real nodes in processes of their own, and a client that talks to them over real DDS.

Every process gets a time limit, is killed at the end with all that it started, and runs with
rclpy's field checks on, so that no wrong number type goes out unseen.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
import os
from pathlib import Path
import signal
import subprocess
import sys
import threading
import time
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped
from hnr_planner.maps import OccupancyMap
from hnr_planner.ros.messages.maps import message_from_map
from hnr_planner.ros.messages.outcomes import read_outcome
from hnr_planner.server.requests.outcomes import Outcome
from nav_msgs.msg import OccupancyGrid
from nav_msgs.msg import Path as PathMessage
from nav_msgs.srv import GetPlan
import numpy as np
from rcl_interfaces.msg import Parameter, SetParametersResult
from rcl_interfaces.srv import GetParameters, SetParameters
import rclpy
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter as RclpyParameter
from rclpy.parameter import parameter_value_to_python
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import PointCloud2
from std_srvs.srv import Trigger
from visualization_msgs.msg import MarkerArray

LATCHED = QoSProfile(
    depth=100,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
    reliability=ReliabilityPolicy.RELIABLE,
)
MANY = QoSProfile(depth=1000)

#: Longest time [s] that anything here may take to happen.
SOON = 20.0


def until(
    condition: Callable[[], Any], what: str | Callable[[], str], timeout: float = SOON
) -> Any:
    """
    Return the first true value of ``condition``, or fail saying ``what`` did not happen.

    A callable is asked for its words when they are needed, so that they tell the end.
    """
    deadline = time.monotonic() + timeout
    while not (value := condition()):
        if time.monotonic() >= deadline:
            words = what if isinstance(what, str) else what()
            raise AssertionError(f'not within {timeout} s: {words}')
        time.sleep(0.01)
    return value


class NodeProcess:
    """A node in a process of its own; ``log`` is what it has printed so far, or since a moment."""

    def __init__(self, module: str, log: Path, parameters: dict[str, Any], *arguments: str):
        settings = [
            word
            for name, value in parameters.items()
            for word in ('-p', f'{name}:={_yaml(value)}')
        ]
        # A map that differs from the last in its cells only is told of quietly.
        settings += ['--log-level', 'hnr_planner:=debug']
        command = [sys.executable, '-m', f'hnr_planner.ros.node.{module}', '--ros-args', *settings]
        self._log, self._begin = log, 0
        with log.open('w') as output:
            self.popen = subprocess.Popen(
                [*command, *arguments],
                stdout=output,
                stderr=subprocess.STDOUT,
                stdin=subprocess.DEVNULL,
                start_new_session=True,
            )

    @property
    def log(self) -> str:
        """Return what the process has printed, since ``begin_log`` if that has been called."""
        begin = self._begin
        return self._log.read_bytes()[begin:].decode()

    def begin_log(self) -> None:
        """Leave what the process has printed so far out of ``log``."""
        self._begin = self._log.stat().st_size

    def wait_for(self, text: str, timeout: float = 120.0) -> None:
        """Wait until ``text`` is on the log."""
        until(
            lambda: text in self.log or self.popen.poll() is not None,
            lambda: f'"{text}" on the log:\n{self.log}',
            timeout,
        )
        assert text in self.log, f'ended before it said "{text}":\n{self.log}'

    def end(self, *signals: signal.Signals, timeout: float = SOON) -> int:
        """Send signals, wait for the end and return the exit code."""
        for number in signals:
            self.popen.send_signal(number)
        return self.popen.wait(timeout)

    def kill(self) -> None:
        """Leave nothing behind, neither a process nor, if it can still end itself, its memory."""
        try:
            self.end(signal.SIGTERM)
        except subprocess.TimeoutExpired:
            os.killpg(self.popen.pid, signal.SIGKILL)
            self.popen.wait(5.0)


def _yaml(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


@contextmanager
def node_process(
    module: str, log: Path, ready: str = 'ready', *arguments: str, **parameters: Any
) -> Iterator[NodeProcess]:
    """Run a node for the length of a ``with`` block, from when it says that it is ready."""
    process = NodeProcess(module, log, parameters, *arguments)
    try:
        process.wait_for(ready)
        yield process
    finally:
        process.kill()


def free_map(rows: int = 100, cols: int = 100) -> np.ndarray:
    """Return an empty map."""
    return np.zeros((rows, cols), dtype=np.int8)


def two_rooms(rows: int = 100, cols: int = 100, door: int = 6) -> np.ndarray:
    """Return two rooms side by side, with a door in the middle of the wall between them."""
    data = free_map(rows, cols)
    wall = cols // 2
    data[:, wall - 1] = data[:, wall] = 100
    first = (rows - door) // 2
    data[np.arange(first, first + door), :] = 0
    return data


def maze(rows: int = 401, cols: int = 401, gap: int = 1) -> np.ndarray:
    """Return a serpentine of narrow passages: a search that lasts longer than any test."""
    data = free_map(rows, cols)
    for number, row in enumerate(range(2, rows - 2, 2)):
        data[row, :] = 100
        data[row, :gap] = 0
        if number % 2:
            data[row, :gap], data[row, -gap:] = 100, 0
    return data


def from_corner(origin: tuple[float, float, float], x: float, y: float) -> tuple[float, float]:
    """Return the point that is ``x`` and ``y`` metres from a map's corner along its sides."""
    z = complex(x, y) * np.exp(1j * origin[2])
    return origin[0] + float(z.real), origin[1] + float(z.imag)


def grid_message(
    data: np.ndarray,
    resolution: float = 0.05,
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0),
    frame: str = 'map',
) -> OccupancyGrid:
    """Return a map message."""
    stamp = rclpy.clock.Clock().now().to_msg()
    return message_from_map(OccupancyMap(data, resolution, origin, frame), stamp)


def set_field(message: Any, field: str, value: object) -> None:
    """Set a field of a message; dots lead to one inside others."""
    *parents, name = field.split('.')
    for parent in parents:
        message = getattr(message, parent)
    setattr(message, name, value)


def pose(x: float, y: float, frame: str = 'map', yaw: float = 0.0) -> PoseStamped:
    """Return a pose message."""
    message = PoseStamped()
    message.header.frame_id = frame
    message.pose.position.x, message.pose.position.y = float(x), float(y)
    message.pose.orientation.z = float(np.sin(yaw / 2.0))
    message.pose.orientation.w = float(np.cos(yaw / 2.0))
    return message


def points_of(path: PathMessage) -> np.ndarray:
    """Return the positions (n, 2) of the poses of a path."""
    return np.array([(p.pose.position.x, p.pose.position.y) for p in path.poses]).reshape(-1, 2)


def yaws_of(path: PathMessage) -> np.ndarray:
    """Return the yaw (n,) of the poses of a path, from the z and w of their quaternions."""
    return np.array(
        [2.0 * np.arctan2(p.pose.orientation.z, p.pose.orientation.w) for p in path.poses]
    )


def points_in(cloud: PointCloud2) -> np.ndarray:
    """Return the points of a cloud by the description that it brings along."""
    types = {5: 'i4', 6: 'u4', 7: 'f4'}  # the numbers that sensor_msgs/PointField defines
    layout = np.dtype(
        {
            'names': [field.name for field in cloud.fields],
            'formats': [types[field.datatype] for field in cloud.fields],
            'offsets': [field.offset for field in cloud.fields],
            'itemsize': cloud.point_step,
        }
    )
    return np.frombuffer(cloud.data.tobytes(), dtype=layout)


#: What a request was answered with: a path, or that there are draws.
Answer = PathMessage | Trigger.Response


class Client:
    """Talks to the nodes of one namespace, and keeps everything that they publish."""

    def __init__(self, planner: str = '/hnr_planner') -> None:
        self._planner = planner
        self._context = Context()
        rclpy.init(context=self._context)
        self.node = Node('test_client', context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._clients: dict[str, Any] = {}
        self.outcomes = self.listen(DiagnosticArray, f'{planner}/outcome')
        self.paths = self.listen(PathMessage, f'{planner}/path')
        self.clouds = self.listen(PointCloud2, f'{planner}/samples')
        self.markers = self.listen(MarkerArray, f'{planner}/markers')
        self._health = self.listen(DiagnosticArray, '/diagnostics', QoSProfile(depth=10))
        self._map_publisher = self.node.create_publisher(OccupancyGrid, '/map', LATCHED)
        self._thread = threading.Thread(target=self._spin, daemon=True)
        self._thread.start()

    def _spin(self) -> None:
        with suppress(ExternalShutdownException):
            self._executor.spin()

    def close(self) -> None:
        """End the client."""
        rclpy.try_shutdown(context=self._context)
        self._thread.join(SOON)
        self.node.destroy_node()

    def listen(self, kind: type, topic: str, qos: QoSProfile = LATCHED) -> list:
        """Return a list that every message of a topic is added to."""
        received: list = []
        self.node.create_subscription(kind, topic, received.append, qos)
        return received

    def send(self, kind: type, name: str, request: Any) -> Any:
        """Send a request and return the future of its answer."""
        if name not in self._clients:
            # More answers may come at once than the ten that a client keeps by default.
            self._clients[name] = self.node.create_client(kind, name, qos_profile=MANY)
            assert self._clients[name].wait_for_service(SOON), f'no service {name}'
        return self._clients[name].call_async(request)

    def call(self, kind: type, name: str, request: Any, timeout: float = SOON) -> Any:
        """Send a request and return its answer."""
        return result_of(self.send(kind, name, request), timeout)

    def send_plan(
        self,
        start: PoseStamped,
        goal: PoseStamped,
        service: str = 'plan',
        tolerance: float = 0.0,
    ) -> Any:
        """Ask for a path and return the future of the answer."""
        request = GetPlan.Request(start=start, goal=goal, tolerance=float(tolerance))
        return self.send(GetPlan, f'{self._planner}/{service}', request)

    def plan(self, *arguments: Any, **keywords: Any) -> PathMessage:
        """Ask for a path and return it."""
        return result_of(self.send_plan(*arguments, **keywords)).plan

    def send_sample(self) -> Any:
        """Ask for draws of the free space and return the future of the answer."""
        return self.send(Trigger, f'{self._planner}/sample', Trigger.Request())

    def sample(self) -> Trigger.Response:
        """Ask for draws of the free space and return the answer."""
        return result_of(self.send_sample())

    def outcome_of(self, answer: Answer) -> tuple[Outcome, dict[str, str]]:
        """Return the outcome with the stamp of an answer."""
        return read_outcome(self.stamped(self.outcomes, answer))

    def stamped(self, received: list, answer: Answer) -> Any:
        """Return the one message with the stamp of an answer."""
        stamp = stamp_of(answer)
        return until(
            lambda: next((m for m in list(received) if stamp_of(m) == stamp), None),
            'a message with the stamp of the answer',
        )

    def publish_map(self, message: OccupancyGrid) -> None:
        """Publish a map."""
        self._map_publisher.publish(message)

    def wait_for_running(self, searches: int) -> None:
        """Wait until the node says that so many searches run, from now on."""
        self.wait_for_health(
            lambda values: values['running'] == str(searches), f'{searches} running searches'
        )

    def wait_for_health(
        self,
        condition: Callable[[dict[str, str]], bool],
        what: str,
        timeout: float = SOON,
    ) -> dict[str, str]:
        """Return the values of the first report of the node's health, from now on, that fits."""
        self._health.clear()
        return until(
            lambda: next(filter(condition, self._reports_of_health()), None), what, timeout
        )

    def _reports_of_health(self) -> list[dict[str, str]]:
        own = [m.status[0] for m in list(self._health) if self._planner in m.status[0].name]
        return [{item.key: item.value for item in status.values} for status in own]

    def cancel(self) -> Trigger.Response:
        """Cancel all running searches."""
        return self.call(Trigger, f'{self._planner}/cancel', Trigger.Request())

    def set_parameters(self, node: str | None = None, **values: Any) -> list[SetParametersResult]:
        """Set parameters and return the answers."""
        request = SetParameters.Request(
            parameters=[
                Parameter(name=name, value=RclpyParameter(name, value=value).get_parameter_value())
                for name, value in values.items()
            ]
        )
        return self.call(SetParameters, f'{node or self._planner}/set_parameters', request).results

    def get_parameters(self, *names: str) -> list:
        """Return the values of parameters."""
        answer = self.call(
            GetParameters, f'{self._planner}/get_parameters', GetParameters.Request(names=names)
        )
        return [parameter_value_to_python(value) for value in answer.values]


def stamp_of(message: Any) -> tuple[int, int]:
    """Return the stamp of a message; markers have it in each, draws in the words of the answer."""
    if isinstance(message, Trigger.Response):
        sec, nanosec = message.message.rpartition('(stamp ')[2].removesuffix(')').split('.')
        return int(sec), int(nanosec)
    header = message.markers[0].header if isinstance(message, MarkerArray) else message.header
    return header.stamp.sec, header.stamp.nanosec


def result_of(future: Any, timeout: float = SOON) -> Any:
    """Wait for a future and return its result."""
    until(future.done, 'an answer', timeout)
    return future.result()
