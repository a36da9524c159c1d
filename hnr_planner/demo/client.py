"""
Request paths from a running planning node and receive what it publishes.

``python -m hnr_planner.demo.client --start X Y --goal X Y`` requests a path by each algorithm and
prints the results; with ``--out DIR`` it also writes what it received into files.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
import sys
import time
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import PoseStamped
from hnr_planner.demo.answer import ALGORITHMS, Answer
from hnr_planner.ros.interfaces.profiles import latched
from hnr_planner.ros.messages.outcomes import read_outcome
from nav_msgs.msg import Path as PathMessage
from nav_msgs.srv import GetPlan
import numpy as np
from numpy.typing import NDArray
import rclpy
from rclpy.node import Node
from sensor_msgs.msg import PointCloud2

PLANNER = 'hnr_planner'
#: Time for a published message to arrive, or a service to be discovered [s].
ARRIVE_WITHIN = 10.0
#: NumPy types of sensor_msgs/PointField.
POINT_FIELDS = {5: '<i4', 6: '<u4', 7: '<f4', 8: '<f8'}


class LateError(Exception):
    """Error that a message, a response or a service, named in the text, did not come in time."""


class Client(Node):
    """
    Node that requests paths and keeps the messages that the planner publishes.

    Messages are kept by topic and stamp: those of a request have the stamp of its response.
    """

    def __init__(self) -> None:
        super().__init__('hnr_planner_client')
        self._received: dict[str, dict[tuple[int, int], Any]] = {}
        self._listen('outcome', DiagnosticArray)
        self._listen('path', PathMessage)
        self._listen('samples', PointCloud2)
        self._ready = False
        self.create_subscription(DiagnosticArray, '/diagnostics', self._note_health, 10)

    def _listen(self, topic: str, kind: type) -> None:
        """Subscribe to a topic of the planner, and keep the messages on it by their stamps."""
        received = self._received[topic] = {}

        def keep(message: Any) -> None:
            received[_stamp(message)] = message

        self.create_subscription(kind, f'{PLANNER}/{topic}', keep, latched(100))

    def wait_until_ready(self, within: float) -> None:
        """
        Wait until the planner reports that it has a map and can plan.

        LateError is raised where it has not reported so after ``within`` seconds.
        """
        self._wait(lambda: self._ready, within, 'a planner that is up and has a map')

    def ask(
        self,
        algorithm: str,
        start: tuple[float, float],
        goal: tuple[float, float],
        frame: str,
        within: float,
    ) -> Answer:
        """
        Request a path by an algorithm, and return the response and the messages of the request.

        Path and samples are awaited only where the outcome is SOLVED, and are empty otherwise.

        Parameters
        ----------
        algorithm : str
            A name of ``ALGORITHMS``.
        start, goal : (x, y)
            Ends of the path [m].
        frame : str
            The frame they are in.
        within : float
            Time limit for the response [s].

        Raises
        ------
        LateError
            When the response or a message of the request does not arrive in time.

        """
        name = f'{PLANNER}/plan_{algorithm}'
        service = self.create_client(GetPlan, name)
        self._wait(service.service_is_ready, ARRIVE_WITHIN, f'the service {name}')
        request = GetPlan.Request(start=_pose(start, frame), goal=_pose(goal, frame))
        asked = time.monotonic()
        future = service.call_async(request)
        self._wait(future.done, within, f'an answer of {name}')
        round_trip = time.monotonic() - asked
        response = future.result().plan
        stamp = _stamp(response)
        self._wait_for('outcome', stamp)
        outcome, values = read_outcome(self._received['outcome'][stamp])
        path, samples, parents = np.empty((0, 2)), np.empty((0, 2)), np.empty(0, dtype=int)
        if outcome.name == 'SOLVED':
            self._wait_for('path', stamp)
            self._wait_for('samples', stamp)
            path = _points(self._received['path'][stamp])
            samples, parents = _samples(self._received['samples'][stamp])
        return Answer(outcome.name, values, _points(response), path, samples, parents, round_trip)

    def _wait_for(self, topic: str, stamp: tuple[int, int]) -> None:
        """Wait for the message of a stamp on a topic; raise LateError after ``ARRIVE_WITHIN``."""
        received = self._received[topic]
        self._wait(lambda: stamp in received, ARRIVE_WITHIN, f'a message on {PLANNER}/{topic}')

    def _wait(self, condition: Callable[[], bool], within: float, what: str) -> None:
        """
        Spin the node until the condition holds.

        LateError is raised where it does not hold after ``within`` seconds; ``what`` names in the
        message what was awaited.
        """
        deadline = time.monotonic() + within
        while not condition():
            if time.monotonic() > deadline:
                raise LateError(f'{what} did not come within {within:g} s')
            rclpy.spin_once(self, timeout_sec=0.1)

    def _note_health(self, message: DiagnosticArray) -> None:
        """Record that the planner is ready, where a status of the message says so."""
        for status in message.status:
            if status.name.startswith(f'/{PLANNER}:') and status.level == DiagnosticStatus.OK:
                self._ready = True


def main(argv: list[str] | None = None) -> int:
    """
    Request a path by each algorithm, and return the exit code.

    It is 0 when all requests were answered, with a path or without, 1 when something did not
    arrive in time, and 130 when interrupted.
    """
    parser = argparse.ArgumentParser(prog='python -m hnr_planner.demo.client', description=__doc__)
    for name in ('start', 'goal'):
        parser.add_argument(f'--{name}', type=float, nargs=2, required=True, metavar=('X', 'Y'))
    parser.add_argument('--frame', default='map', help='frame of both; default map')
    parser.add_argument(
        '--out', type=Path, metavar='DIR', help='write the received messages there'
    )
    parser.add_argument('--ready-within', type=float, default=10.0, metavar='S')
    parser.add_argument('--answer-within', type=float, default=30.0, metavar='S')
    arguments = parser.parse_args(argv)
    rclpy.init(args=[])
    try:
        client = Client()
        client.wait_until_ready(arguments.ready_within)
        for algorithm in ALGORITHMS:
            answer = client.ask(
                algorithm,
                arguments.start,
                arguments.goal,
                arguments.frame,
                arguments.answer_within,
            )
            if arguments.out:
                answer.write(arguments.out, algorithm)
            print(
                f'{algorithm}: {answer.outcome} in {answer.round_trip * 1e3:.1f} ms, '
                f'{len(answer.path)} poses and {len(answer.samples)} samples received'
            )
    except LateError as error:
        print(error, file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    except Exception:
        if rclpy.ok():
            raise
        return 130  # a signal came, and the call of rclpy that it interrupted failed
    finally:
        rclpy.try_shutdown()
    return 0


def _pose(point: tuple[float, float], frame: str) -> PoseStamped:
    """Return a pose without rotation at a point (x, y) [m] of a frame."""
    pose = PoseStamped()
    pose.header.frame_id = frame
    pose.pose.position.x, pose.pose.position.y = (float(value) for value in point)
    pose.pose.orientation.w = 1.0
    return pose


def _stamp(message: Any) -> tuple[int, int]:
    """Return the stamp (seconds, nanoseconds) of a message."""
    return message.header.stamp.sec, message.header.stamp.nanosec


def _points(path: PathMessage) -> NDArray[np.float64]:
    """Return the positions (m, 2) [m] of the poses of a path."""
    positions = (pose.pose.position for pose in path.poses)
    return np.array([(p.x, p.y) for p in positions]).reshape(-1, 2)


def _samples(cloud: PointCloud2) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """
    Return the samples (k, 2) [m] of a cloud, and the row of each sample's parent (k,).

    Samples are in the order in which they were drawn, by the cloud's field ``index``.
    """
    layout = np.dtype(
        {
            'names': [field.name for field in cloud.fields],
            'formats': [POINT_FIELDS[field.datatype] for field in cloud.fields],
            'offsets': [field.offset for field in cloud.fields],
            'itemsize': cloud.point_step,
        }
    )
    rows = np.sort(np.frombuffer(cloud.data, layout), order='index')
    samples = np.stack((rows['x'], rows['y']), axis=1).astype(float)
    return samples, rows['parent'].astype(int)


if __name__ == '__main__':
    sys.exit(main())
