"""The planning server with ROS topics: each response is logged and published."""

from collections.abc import Callable
import threading
from typing import NamedTuple

from builtin_interfaces.msg import Time
from hnr_planner.ros.interfaces.profiles import latched
from hnr_planner.ros.interfaces.publications import PlanPublication, SamplePublication
from hnr_planner.ros.interfaces.publisher import NO_EVENTS, Publisher
from hnr_planner.server.map.waiting import NewestMap
from hnr_planner.server.parameters.settings import Settings
from hnr_planner.server.planning.respond import ToFrame
from hnr_planner.server.planning_server import PlanningServer
from hnr_planner.server.requests.plan_request import PlanRequest
from hnr_planner.server.responses.plan_response import PlanResponse
from hnr_planner.server.responses.request_log import RequestLog
from hnr_planner.server.responses.sample_response import SampleResponse
from hnr_planner.server.validity.path_monitor import PathMonitor
from rclpy.node import Node
from std_msgs.msg import Bool, Header

#: The topic on which it is published whether the last path is still free.
PATH_VALID = 'path_valid'


class Sampled(NamedTuple):
    """A response to a request for draws, and the stamp of all messages about it."""

    response: SampleResponse
    stamp: Time


class RequestServer:
    """
    Responds to requests for paths and for draws; any number of threads may ask at once.

    Parameters
    ----------
    node : Node
        The node that logs and publishes.
    settings : callable
        Returns the parameters in force.
    newest_map : callable
        Returns the map in use, or raises Refusal.
    to_frame : callable
        Transforms a pose into the frame whose name it is given, or raises Refusal (BAD_FRAME).

    """

    def __init__(
        self,
        node: Node,
        settings: Callable[[], Settings],
        newest_map: NewestMap,
        to_frame: ToFrame,
    ) -> None:
        self._logger = node.get_logger()
        self._settings = settings
        self._server = PlanningServer(settings, newest_map, to_frame, self._log_defect)
        self._publisher = Publisher(node)
        self._log = RequestLog()
        self._path_valid = node.create_publisher(
            Bool, f'~/{PATH_VALID}', latched(1), event_callbacks=NO_EVENTS
        )
        self._in_order = threading.Lock()
        self.path_monitor = PathMonitor(newest_map, self._report_path)
        self.searches = self._server.searches
        self.statistics = self._server.statistics
        self.roadmaps = self._server.roadmaps

    def plan(
        self,
        caller: str,
        request: PlanRequest,
        cancel: threading.Event | None = None,
        arrived: float | None = None,
    ) -> PlanPublication:
        """
        Plan for ``request``, and return the publication of its response, with its stamp.

        It is published once this thread has called ``response_sent``.

        Parameters
        ----------
        caller : str
            Service, action or topic that the request came by.
        request : PlanRequest
            The request as it arrived, not checked yet.
        cancel : threading.Event, optional
            Ends the search when it is set.
        arrived : float, optional
            When the request arrived, by ``time.monotonic`` [s]; now when left out.

        """
        settings = self._settings()
        response = self._server.plan(request, cancel, arrived)
        header = Header(frame_id=response.frame)
        remark = ''
        if request.omits_start:
            remark = 'the start is (0, 0) in no frame, as if left out: taken literally'
        log = self._log.entry(caller, response, settings.time_limit, remark)
        with self._in_order:
            publication = PlanPublication(caller, response, header, log, settings.samples_max)
            self._publisher.hand_over(publication)
            self.path_monitor.follow(response)
        return publication

    def sample(self, caller: str) -> Sampled:
        """
        Draw points of the free space, and return the response and the stamp of its messages.

        They are published once this thread has called ``response_sent``.

        Parameters
        ----------
        caller : str
            Service that the request came by.

        """
        response = self._server.sample()
        header = Header(frame_id=response.frame)
        log = self._log.entry(caller, response, self._settings().time_limit)
        self._publisher.hand_over(SamplePublication(caller, response, header, log))
        return Sampled(response, header.stamp)

    def follow_map(self) -> None:
        """Check the last path on the newest map, and keep its roadmap, where one is wanted."""
        self.path_monitor.check()
        self._server.follow_map()

    def forget_map(self) -> None:
        """Forget the last path and the roadmap."""
        self.path_monitor.forget()
        self._server.forget_map()

    def response_sent(self) -> None:
        """Release the messages about the response that this thread got last from this server."""
        self._publisher.response_sent()

    def start(self) -> None:
        """Admit searches, and log the next success at INFO."""
        self._log.start()
        self.searches.enable()

    def end(self) -> None:
        """Admit no more searches, end those that run, and publish no more pictures."""
        self._publisher.leave_out_pictures()
        self.searches.disable()

    def close(self) -> None:
        """Publish what still waits to be published, and end the publishing thread."""
        self._publisher.close()

    def _log_defect(self, traceback: str) -> None:
        self._logger.error(f'a defect of the planner:\n{traceback}')

    def _report_path(self, valid: bool, why: str, changed: PlanResponse | None) -> None:
        """Publish whether the last path is free, and MAP_CHANGED where a newer map blocks it."""
        self._path_valid.publish(Bool(data=valid))
        if changed is not None:
            self._logger.warning(f'{PATH_VALID}: {why}')
            self._publisher.announce(changed, PATH_VALID)
        elif why:
            self._logger.info(f'{PATH_VALID}: {why}')
