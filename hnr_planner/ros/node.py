"""The planning node: its topics, services and parameters, wired to what answers requests."""

import functools
import time
import traceback

from diagnostic_msgs.msg import DiagnosticArray
from hnr_planner.ros.callback_group import BoundedCallbackGroup
from hnr_planner.ros.map_messages import grid_from_message
from hnr_planner.ros.map_store import MapError, MapSnapshot, MapStore
from hnr_planner.ros.map_subscription import MapSubscription
from hnr_planner.ros.outcome_messages import health_message
from hnr_planner.ros.outcomes import Outcome, Refusal
from hnr_planner.ros.parameters import Parameters
from hnr_planner.ros.path_messages import path_message, pose_rows, request_from_message
from hnr_planner.ros.publications import Publications, Result
from hnr_planner.ros.requests import answer, Report, Request
from hnr_planner.ros.searches import RunningSearches
from hnr_planner.ros.settings import Settings
from hnr_planner.ros.statistics import Statistics
from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetPlan
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import Header
from std_srvs.srv import Trigger

MOST_SEARCHES = 32
"""Requests answered at once; more wait for their turn."""
THREADS = MOST_SEARCHES + 4
"""Threads for callbacks: searches never take the last ones, those of ~/cancel and diagnostics."""
WAITING_REQUESTS = QoSProfile(depth=1000)
SERVICES = {'plan': None, 'plan_hit_and_run': 'hit_and_run', 'plan_rrt': 'rrt'}
"""Services that plan, and the algorithm of each; None is the one of the parameter."""


class PlannerNode(Node):
    """Answers requests for a path on the newest map, and shows how each path was found."""

    def __init__(self) -> None:
        super().__init__('hnr_planner')
        self._declared = Parameters(self, self._use_settings)
        self._maps = MapStore(self._declared.settings)
        self._map_came = time.monotonic()
        self._searches = RunningSearches()
        self._statistics = Statistics()
        self._publications = Publications(self)
        self._map_subscription = MapSubscription(
            self, self._receive_map, self._declared.settings.map_subscribe_transient_local
        )
        self._health = self.create_publisher(DiagnosticArray, '/diagnostics', 10)
        self.create_timer(
            1.0,
            self._once_a_second,
            callback_group=MutuallyExclusiveCallbackGroup(),
            clock=Clock(clock_type=ClockType.STEADY_TIME),
        )
        searches = BoundedCallbackGroup(MOST_SEARCHES, self._publications.answer_sent)
        for name, algorithm in SERVICES.items():
            self.create_service(
                GetPlan,
                f'~/{name}',
                functools.partial(self._answer, name, algorithm),
                qos_profile=WAITING_REQUESTS,
                callback_group=searches,
            )
        self.create_service(
            Trigger, '~/cancel', self._cancel, callback_group=ReentrantCallbackGroup()
        )

    @property
    def map_topic(self) -> str:
        """Return the full name of the topic that maps come from."""
        return self._map_subscription.topic

    def end_searches(self) -> None:
        """Tell running searches, and those that may still come, to end."""
        self._publications.leave_out_pictures()
        self._searches.close()

    def destroy_node(self) -> None:
        """Publish the last results, then take the node down."""
        self._publications.close()
        super().destroy_node()

    def _answer(
        self,
        service: str,
        algorithm: str | None,
        message: GetPlan.Request,
        response: GetPlan.Response,
    ) -> GetPlan.Response:
        """Answer one request for a path."""
        settings = self._declared.settings
        request = request_from_message(message, algorithm or settings.algorithm)
        report = self._report(request, settings)
        self._statistics.count(report)
        poses, header = pose_rows(report, settings.pose_spacing), Header(frame_id=report.frame)
        response.plan = path_message(poses, header)
        result = Result(report, poses, header, service, settings.samples_max)
        self._publications.hand_over(result)
        return response

    def _report(self, request: Request, settings: Settings) -> Report:
        """Return the answer to `request`, even if the planner has a defect."""
        try:
            with self._searches.one() as cancel:
                return answer(request, settings, self._maps.newest, cancel)
        except Exception as error:  # without an answer the caller would wait for ever
            self.get_logger().error(f'a defect of the planner:\n{traceback.format_exc()}')
            why = f'a defect of the planner, please report it: {error!r}'
            return Report(Outcome.INTERNAL_ERROR, why, request, elapsed=0.0)

    def _cancel(self, _request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """End all running searches."""
        told = self._searches.cancel()
        response.success = True
        response.message = f'{told} running search{"" if told == 1 else "es"} told to end'
        self.get_logger().info(f'cancel: {response.message}')
        return response

    def _receive_map(self, message: OccupancyGrid) -> None:
        """Put a new map to use; a bad one is refused and the last good one stays."""
        began = time.monotonic()
        try:
            snapshot = self._maps.receive(lambda: grid_from_message(message))
        except MapError as error:
            rest = 'the last good map stays in use' if self._maps.in_use else 'no map is in use'
            self.get_logger().error(f'map refused, {rest}: {error}')
            return
        self._map_came = began
        self._log_map('received and prepared', snapshot, began)

    def _use_settings(self, settings: Settings) -> None:
        """Put changed parameters to use."""
        began = time.monotonic()
        try:
            snapshot = self._maps.use(settings)
        except MapError as error:
            self.get_logger().error(str(error))
            return
        if snapshot is not None:
            self._log_map('prepared again for changed parameters', snapshot, began)

    def _log_map(self, done: str, snapshot: MapSnapshot, began: float) -> None:
        taken = time.monotonic() - began
        self.get_logger().info(f'map {done} in {taken:.3f} s: {snapshot.grid}')

    def _once_a_second(self) -> None:
        """Publish the node's health, and look after the map subscription."""
        self._map_subscription.go_back_if_possible()
        summary = self._statistics.summary()
        try:
            snapshot = self._maps.newest()
            ready, state = True, 'ready'
            values = {
                'map': str(snapshot.grid),
                'map_age': f'{time.monotonic() - self._map_came:.1f}',
            }
        except Refusal as refusal:
            ready, state, values = False, f'{refusal.outcome.name}: {refusal.why}', {}
        values |= {
            'requests': str(summary.requests),
            'running': str(len(self._searches)),
            'time_median': f'{summary.median:.6f}',
            'time_p95': f'{summary.p95:.6f}',
        }
        values |= {outcome.name: str(count) for outcome, count in summary.outcomes.items()}
        name = f'{self.get_fully_qualified_name()}: planner'
        stamp = self.get_clock().now().to_msg()
        self._health.publish(health_message(ready, name, state, values, stamp))
