"""The way of a request through the node, whoever sends it: gate, work, count, tell, publish."""

from collections.abc import Callable
import threading
import traceback
from typing import NamedTuple, TypeVar

from builtin_interfaces.msg import Time
from hnr_planner.ros.interfaces.path_monitor import PathMonitor
from hnr_planner.ros.interfaces.publications import PlanPublication, SamplePublication
from hnr_planner.ros.interfaces.publisher import Publisher
from hnr_planner.ros.interfaces.sampling import draw
from hnr_planner.ros.messages.paths import path_message, pose_rows
from hnr_planner.server.outcomes import Outcome, Refusal
from hnr_planner.server.requests import PlanRequest
from hnr_planner.server.respond import NewestMap, respond, ToFrame
from hnr_planner.server.responses import PlanResponse, Response, SampleResponse
from hnr_planner.server.searches import RunningSearches
from hnr_planner.server.settings import Settings
from hnr_planner.server.statistics import Statistics
from nav_msgs.msg import Path
from rclpy.node import Node
from std_msgs.msg import Header

Some = TypeVar('Some', bound=Response)


class Answer(NamedTuple):
    """What came of a request, and its path as a message: stamped, empty after a failure."""

    report: PlanResponse
    path: Path


class Drawn(NamedTuple):
    """What came of a request for draws, and the stamp of all that is published about it."""

    report: SampleResponse
    stamp: Time


class RequestServer:
    """
    Answers requests for paths and for draws; any number of threads may ask at once.

    Parameters
    ----------
    node : Node
        Whose log and topics are used.
    settings : callable
        Returns the parameters in force.
    newest_map : callable
        Returns the map in use, or raises Refusal.
    to_frame : callable
        Brings a pose into the frame of the map, or raises Refusal.

    """

    def __init__(
        self,
        node: Node,
        settings: Callable[[], Settings],
        newest_map: NewestMap,
        to_frame: ToFrame,
    ) -> None:
        self._node = node
        self._settings = settings
        self._newest_map = newest_map
        self._to_frame = to_frame
        self._publications = Publisher(node)
        self._in_order = threading.Lock()
        self.watch = PathMonitor(node, self._publications, newest_map)
        self.searches = RunningSearches()
        self.statistics = Statistics()

    def plan(
        self, caller: str, request: PlanRequest, cancel: threading.Event | None = None
    ) -> Answer:
        """
        Return the answer to `request`; all about it is published soon.

        Parameters
        ----------
        caller : str
            Service, action or topic that the request came by.
        request : Request
            What is asked for.
        cancel : threading.Event, optional
            Ends this search when it is set.

        """
        settings, cancel = self._settings(), cancel or threading.Event()
        report = self._counted(
            cancel,
            lambda: respond(request, settings, self._newest_map, cancel, self._to_frame),
            lambda refusal: PlanResponse(refusal.outcome, refusal.why, request),
        )
        poses, header = pose_rows(report, settings.pose_spacing), Header(frame_id=report.frame)
        path = path_message(poses, header)
        result = PlanPublication(caller, report, header, request, poses, settings.samples_max)
        with self._in_order:
            self._publications.hand_over(result)
            self.watch.follow(report)
        return Answer(report, path)

    def sample(self, caller: str) -> Drawn:
        """Return the answer to a request for draws, which came by `caller`; likewise."""
        settings, cancel = self._settings(), threading.Event()
        report = self._counted(
            cancel,
            lambda: draw(settings, self._newest_map, cancel),
            lambda refusal: SampleResponse(refusal.outcome, refusal.why, settings),
        )
        header = Header(frame_id=report.frame)
        self._publications.hand_over(SamplePublication(caller, report, header))
        return Drawn(report, header.stamp)

    def answer_sent(self) -> None:
        """Say that the answer that this thread got last is on its way to whoever asked."""
        self._publications.answer_sent()

    def end(self) -> None:
        """Let no more searches in, end those that run, and publish no more pictures."""
        self._publications.leave_out_pictures()
        self.searches.disable()

    def close(self) -> None:
        """Publish the last results."""
        self._publications.close()

    def _counted(
        self,
        cancel: threading.Event,
        work: Callable[[], Some],
        refused: Callable[[Refusal], Some],
    ) -> Some:
        """Return the report of `work`, or one about why there is none, even for a defect in it."""
        try:
            with self.searches.one(cancel):
                report = work()
        except Refusal as refusal:
            report = refused(refusal)
        except Exception as error:  # without an answer the caller would wait for ever
            self._node.get_logger().error(f'a defect of the planner:\n{traceback.format_exc()}')
            why = f'a defect of the planner, please report it: {error!r}'
            report = refused(Refusal(Outcome.INTERNAL_ERROR, why))
        self.statistics.count(report)
        return report
