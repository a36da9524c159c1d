"""The last path is watched: `~/path_valid` says whether the newest map still leaves it free."""

from contextlib import suppress
from dataclasses import replace
import threading

from hnr_planner.ros.interfaces.publisher import latched, Publisher
from hnr_planner.server.map_store import MapSnapshot
from hnr_planner.server.outcomes import Outcome, Refusal
from hnr_planner.server.path_validity import first_blocked_pose, PlanarPose
from hnr_planner.server.respond import NewestMap
from hnr_planner.server.responses import PlanResponse
from rclpy.node import Node
from std_msgs.msg import Bool

TOPIC = 'path_valid'


class PathMonitor:
    """
    Holds the last path against every map that comes.

    What it finds is published, latched, at each answer and at each change; when a map blocks the
    path, an outcome says where.

    Parameters
    ----------
    node : Node
        Publishes.
    publications : Publications
        Where outcomes are published.
    newest_map : callable
        Returns the map in use, or raises Refusal.

    """

    def __init__(self, node: Node, publications: Publisher, newest_map: NewestMap) -> None:
        self._name = f'{node.get_fully_qualified_name()}/{TOPIC}'
        self._logger = node.get_logger()
        self._publications = publications
        self._newest_map = newest_map
        self._publisher = node.create_publisher(Bool, f'~/{TOPIC}', latched(1))
        self._one_at_a_time = threading.Lock()
        self._report: PlanResponse | None = None
        self._valid = False

    def follow(self, report: PlanResponse) -> None:
        """Watch the path of `report` from now on, none after a failure."""
        with self._one_at_a_time:
            self._report = report if report.solved else None
            self._publish(report.solved)
        if report.solved:
            self.look()  # a map may have come since the path was found

    def forget(self) -> None:
        """Watch no path any more."""
        with self._one_at_a_time:
            if self._report is not None:
                self._report = None
                self._publish(False)

    def look(self) -> None:
        """Hold the path against the newest map, if there is one."""
        with self._one_at_a_time:
            if self._report is not None:
                with suppress(Refusal):
                    self._compare(self._report, self._newest_map())

    def _compare(self, report: PlanResponse, newest: MapSnapshot) -> None:
        if newest is report.snapshot and self._valid:
            return
        blocked = first_blocked_pose(report.free_path, report.frame, newest)
        if self._valid == (blocked is None):
            return
        self._publish(blocked is None)
        if blocked is None:
            self._logger.info(f'{TOPIC}: a newer map leaves the last path free again')
        else:
            self._announce(report, blocked, newest)

    def _announce(self, report: PlanResponse, blocked: PlanarPose, newest: MapSnapshot) -> None:
        """Say where a map blocks the path."""
        why = f'a newer map blocks the last path at {blocked}'
        self._logger.warning(f'{TOPIC}: {why}')
        found = replace(
            report, outcome=Outcome.MAP_CHANGED, why=why, snapshot=newest, blocked=blocked
        )
        self._publications.announce(found, self._name)

    def _publish(self, valid: bool) -> None:
        self._valid = valid
        self._publisher.publish(Bool(data=valid))
