"""The planning node: its topics, services and parameters, connected to the planning server."""

from functools import partial
import time

from hnr_planner.core import compile_in_background, KINODYNAMIC_PLANNERS
from hnr_planner.ros.interfaces.health import Health
from hnr_planner.ros.interfaces.nav2_server import HAVE_NAV2, Nav2Server
from hnr_planner.ros.interfaces.request_server import RequestServer
from hnr_planner.ros.interfaces.rviz_tools import RvizTools
from hnr_planner.ros.map.map_input import MapInput
from hnr_planner.ros.messages.paths import request_from_message
from hnr_planner.ros.messages.plan_responses import PlanResponses
from hnr_planner.ros.node.bond import NodeBond
from hnr_planner.ros.node.callback_group import BoundedCallbackGroup
from hnr_planner.ros.node.managed_node import ManagedNode
from hnr_planner.ros.node.parameters import Parameters
from hnr_planner.ros.node.transforms import Transforms
from hnr_planner.ros.node.unknown_parameters import warn_of_unknown_parameters
from hnr_planner.ros.node.watch_process import WatchProcess
from hnr_planner.server.map.map_store import MapSnapshot
from hnr_planner.server.parameters.settings import Settings
from hnr_planner.server.planning.respond import only_same_frame
from hnr_planner.server.requests.outcomes import Outcome, Refusal
from hnr_planner.server.requests.plan_request import Pose
from nav_msgs.srv import GetPlan
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.qos import QoSProfile
from std_srvs.srv import Trigger

#: Most requests that run at once; others wait for their turn.
MOST_SEARCHES = 32

#: Threads for callbacks: four more than searches can take, for ~/cancel, diagnostics and maps.
THREADS = MOST_SEARCHES + 4

#: Longest time [s] for which the end of the process waits for Nav2's manager to reset the node.
LONGEST_RESET = 3.0

#: The QoS profile of services: so many requests to one may wait.
WAITING_REQUESTS = QoSProfile(depth=1000)

#: Services that plan, and the algorithm of each; None for that of the parameter ``algorithm``.
SERVICES = {
    'plan': None,
    'plan_hit_and_run': 'hit_and_run',
    'plan_rrt': 'rrt',
    **{f'plan_{name}': name for name in KINODYNAMIC_PLANNERS},
}


class PlannerNode(ManagedNode):
    """
    Plans paths and draws points of the free space on request, on the newest map.

    It publishes each outcome, path and set of samples, with ``samples_max`` samples of a search at
    most. Its services and topics are there in every state, so that each caller gets a response:
    while the node is not active, requests end as NOT_ACTIVE. Maps are received from ``configure``
    to ``cleanup``.
    """

    def __init__(self) -> None:
        super().__init__('hnr_planner')
        self._parameters_in_force = Parameters(self, self._use_settings)
        warn_of_unknown_parameters(self)
        self._has_footprint = False
        self._follow_footprint(self.settings)
        self._map_input: MapInput | None = None
        self._transforms: Transforms | None = None
        self._bond: NodeBond | None = None
        self._server = RequestServer(
            self, lambda: self.settings, self._newest_map, self._to_frame_of_map
        )
        self._responses = PlanResponses()
        if self._responses.why_slow:
            why = self._responses.why_slow
            self.get_logger().warning(f'responses are built pose by pose, which is slow: {why}')
        self._health = Health(self, self._find_map_input, self._server)
        searches = BoundedCallbackGroup(MOST_SEARCHES, self._server.response_sent)
        for name, algorithm in SERVICES.items():
            self.create_service(
                GetPlan,
                f'~/{name}',
                partial(self._plan, name, algorithm),
                qos_profile=WAITING_REQUESTS,
                callback_group=searches,
            )
        self.create_service(
            Trigger,
            '~/sample',
            self._sample,
            qos_profile=WAITING_REQUESTS,
            callback_group=searches,
        )
        self.create_service(
            Trigger, '~/cancel', self._cancel, callback_group=ReentrantCallbackGroup()
        )
        if HAVE_NAV2:
            Nav2Server(
                self,
                self._server,
                lambda: self.settings,
                self._newest_map,
                self._to_frame_of_map,
            )
        self._rviz_tools = RvizTools(self, self._server, lambda: self.settings, searches)
        self._rviz_tools.listen(self.settings.rviz_clicks)
        port = self.settings.watch_port
        self._watch = WatchProcess(self, port) if port else None

    @property
    def settings(self) -> Settings:
        """The parameters in force."""
        return self._parameters_in_force.settings

    def configure(self) -> None:
        """Begin to subscribe to maps and transforms."""
        self._transforms = Transforms(self)
        self._map_input = MapInput(self, lambda: self.settings, self._server.follow_map)
        self.get_logger().info(f'maps come from {self._map_input.topic}')

    def activate(self) -> None:
        """Admit requests; begin a bond with Nav2's manager unless ``autostart`` is set."""
        self._server.start()
        if not self.settings.autostart:
            self._bond = NodeBond(self)

    def deactivate(self) -> None:
        """End all running searches, refuse requests as NOT_ACTIVE afterwards, and end the bond."""
        self._server.searches.disable()
        bond, self._bond = self._bond, None
        if bond is not None:
            bond.close()

    def cleanup(self) -> None:
        """End the subscriptions to maps and transforms, and forget the map and the last path."""
        for source in (self._map_input, self._transforms):
            if source is not None:
                source.close()
        self._map_input, self._transforms = None, None
        self._server.forget_map()

    def end(self) -> None:
        """
        End running searches, and let go of Nav2's manager, before the process ends.

        Where the bond breaks, the manager asks all its nodes to deactivate and to clean up, and
        waits for each response without a limit. So these are given until it is done or
        ``LONGEST_RESET`` has passed, and then the service is gone before the node is.
        """
        self._server.end()
        bond = self._bond
        if bond is not None:
            bond.leave()
            deadline = time.monotonic() + LONGEST_RESET
            while (
                bond.was_formed.is_set()
                and self.state not in ('unconfigured', 'finalized')
                and time.monotonic() < deadline
            ):
                time.sleep(0.01)
        self.end_transitions()

    def destroy_node(self) -> None:
        """Publish what still waits to be published, then destroy the node."""
        if self._watch is not None:
            self._watch.close()
        self._server.close()
        super().destroy_node()

    def _find_map_input(self) -> MapInput:
        """Return the input of maps, or raise Refusal (NOT_ACTIVE) when there is none."""
        map_input = self._map_input
        if map_input is None:
            raise Refusal(Outcome.NOT_ACTIVE, 'the node is not configured')
        return map_input

    def _newest_map(self) -> MapSnapshot:
        """Return the map in use, or raise Refusal (NOT_ACTIVE, NO_MAP, MAP_NOT_READY)."""
        return self._find_map_input().newest()

    def _to_frame_of_map(self, pose: Pose, frame: str) -> Pose:
        """Return ``pose`` transformed to the map's ``frame``, or raise Refusal (BAD_FRAME)."""
        transforms, settings = self._transforms, self.settings
        if transforms is None:
            return only_same_frame(pose, frame)
        patience = min(settings.transform_tolerance, settings.time_limit)
        return transforms.transform(pose, frame, patience)

    def _use_settings(self, settings: Settings) -> None:
        """Put changed parameters into use: click tools, the space of the map, the roadmap."""
        self._rviz_tools.listen(settings.rviz_clicks)
        self._follow_footprint(settings)
        if self._map_input is not None:
            self._map_input.use(settings)
            self._server.follow_map()

    def _follow_footprint(self, settings: Settings) -> None:
        """Compile what a footprint needs once one is set, and log what it makes unused."""
        if settings.vertices and not self._has_footprint:
            compile_in_background('poses')
            if settings.robot_radius > 0.0:
                self.get_logger().warning('robot_radius is not used: the robot has a footprint')
        self._has_footprint = bool(settings.vertices)

    def _plan(
        self,
        service: str,
        algorithm: str | None,
        message: GetPlan.Request,
        _response: GetPlan.Response,
    ) -> GetPlan.Response:
        """Return the response to a request for a path; ``algorithm`` None is the parameter's."""
        request = request_from_message(message, algorithm or self.settings.algorithm)
        publication = self._server.plan(service, request)
        poses, header = publication.response.poses, publication.header
        return self._responses.make(poses, header, publication.path)

    def _sample(self, _request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Draw points of the free space; return the outcome, and the stamp of their message."""
        sampled, stamp = self._server.sample('sample')
        response.success = sampled.outcome.is_success
        response.message = (
            f'{sampled.outcome.name}: {sampled.why} (stamp {stamp.sec}.{stamp.nanosec:09d})'
        )
        return response

    def _cancel(self, _request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Cancel all running searches, and return how many there were."""
        count = self._server.searches.cancel()
        response.success = True
        response.message = f'{count} running search{"" if count == 1 else "es"} cancelled'
        self.get_logger().info(f'cancel: {response.message}')
        return response
