"""The click tools of RViz: "2D Pose Estimate" keeps a start, "2D Goal Pose" plans from it."""

from collections.abc import Callable

from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
from hnr_planner.ros.interfaces.request_server import RequestServer
from hnr_planner.ros.messages.paths import pose_from_message
from hnr_planner.server.parameters.settings import Settings
from hnr_planner.server.requests.plan_request import NOWHERE, PlanRequest
from rclpy.callback_groups import CallbackGroup
from rclpy.node import Node
from rclpy.subscription import Subscription

#: Topics of the two tools.
START, GOAL = 'initialpose', 'goal_pose'


class RvizTools:
    """
    Plans from the last start that was clicked to each goal that is clicked.

    Parameters
    ----------
    node : Node
        The node that subscribes to the tools.
    server : RequestServer
        The server that plans.
    settings : callable
        Returns the parameters in force.
    searches : CallbackGroup
        The callback group of all callbacks that search.

    """

    def __init__(
        self,
        node: Node,
        server: RequestServer,
        settings: Callable[[], Settings],
        searches: CallbackGroup,
    ) -> None:
        self._node = node
        self._server = server
        self._settings = settings
        self._searches = searches
        self._start = NOWHERE
        self._subscriptions: list[Subscription] = []

    def listen(self, wanted: bool) -> None:
        """Subscribe to the tools if ``wanted``; else unsubscribe and forget the start."""
        if wanted and not self._subscriptions:
            self._subscriptions = [
                self._node.create_subscription(
                    PoseWithCovarianceStamped, START, self._keep_start, 10
                ),
                self._node.create_subscription(
                    PoseStamped, GOAL, self._plan, 10, callback_group=self._searches
                ),
            ]
        elif not wanted:
            self._start = NOWHERE
            while self._subscriptions:
                self._node.destroy_subscription(self._subscriptions.pop())

    def _keep_start(self, message: PoseWithCovarianceStamped) -> None:
        pose = PoseStamped(header=message.header, pose=message.pose.pose)
        self._start = pose_from_message(pose)
        x, y = self._start.point
        self._node.get_logger().info(f'{START}: the start is ({x:.4g}, {y:.4g}) from now on')

    def _plan(self, message: PoseStamped) -> None:
        settings = self._settings()
        request = PlanRequest(
            self._start,
            pose_from_message(message),
            settings.default_tolerance,
            settings.algorithm,
        )
        self._server.plan(GOAL, request)
