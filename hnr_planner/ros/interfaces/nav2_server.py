"""
Two actions and a service of Nav2's planner server, where ``nav2_msgs`` is installed.

Each action has one goal at a time, as in Nav2: a new goal ends the search for the goal before.
"""

from collections.abc import Callable, Sequence
import threading
import time
from typing import Any

from builtin_interfaces.msg import Duration
from geometry_msgs.msg import PoseStamped
from hnr_planner.ros.interfaces.request_server import RequestServer
from hnr_planner.ros.messages.action_results import PathResults
from hnr_planner.ros.messages.paths import pose_from_message, poses_from_path
from hnr_planner.server.map.waiting import NewestMap
from hnr_planner.server.nav2 import error_name, goal_request, robot_pose
from hnr_planner.server.parameters.settings import Settings
from hnr_planner.server.planning.respond import ToFrame
from hnr_planner.server.requests.outcomes import Refusal
from hnr_planner.server.requests.plan_request import PlanRequest, Pose
from hnr_planner.server.responses.plan_response import PlanResponse
from hnr_planner.server.responses.request_log import shortened
from hnr_planner.server.validity.check_options import CheckOptions
from hnr_planner.server.validity.path_validity import judge_path
from rclpy.action import ActionServer, CancelResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.duration import Duration as RclpyDuration
from rclpy.node import Node
from std_msgs.msg import Header

try:
    from nav2_msgs.action import ComputePathThroughPoses, ComputePathToPose
    from nav2_msgs.srv import IsPathValid
except ImportError:  # a ROS from wheels has none
    HAVE_NAV2 = False
else:
    HAVE_NAV2 = True

#: Time [s] for which a result is kept for its client, as in Nav2; no longer, as paths are large.
RESULTS_KEPT = 10

#: Longest wait [s] for rclpy to mark a goal as cancelled after our callback has accepted that.
LONGEST_CHANGE = 1.0


class Nav2Server:
    """
    Serves ``compute_path_to_pose``, ``compute_path_through_poses`` and ``is_path_valid``.

    Parameters
    ----------
    node : Node
        The node that offers the actions and the service.
    server : RequestServer
        The server that plans for the goals.
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
        server: RequestServer,
        settings: Callable[[], Settings],
        newest_map: NewestMap,
        to_frame: ToFrame,
    ) -> None:
        self._settings = settings
        self._newest_map = newest_map
        self._to_frame = to_frame
        self._logger = node.get_logger()
        for kind, name, poses_of in (
            (ComputePathToPose, 'compute_path_to_pose', _poses_to_one),
            (ComputePathThroughPoses, 'compute_path_through_poses', _poses_through),
        ):
            _Action(node, kind, name, poses_of, server, settings)
        node.create_service(
            IsPathValid, 'is_path_valid', self._judge, callback_group=ReentrantCallbackGroup()
        )

    def _judge(
        self, request: 'IsPathValid.Request', response: 'IsPathValid.Response'
    ) -> 'IsPathValid.Response':
        """
        Judge a path on the newest map, from the pose nearest to the robot on.

        Without a map the path is not valid, nor is it where the request wants what this node does
        not have. Why a path is not valid is logged as a warning.
        """
        response.is_valid = False
        options = CheckOptions.of(request)
        try:
            options.check(self._settings())
            snapshot = self._newest_map()
            _ = snapshot.pose_space  # refused where the robot does not fit into the map
        except Refusal as refusal:
            why = f'{refusal.outcome.name}: {refusal.why}'
        else:
            poses, frame = poses_from_path(request.path), request.path.header.frame_id
            robot = self._find_robot(snapshot.frame)
            verdict = judge_path(poses, frame, snapshot, robot, options.lookahead)
            response.is_valid = not verdict.why
            response.invalid_pose_indices = verdict.blocked[: options.most_indices]
            if hasattr(response, 'success'):
                response.success = True
            why = verdict.why
        if why:
            self._logger.warning(shortened(f'is_path_valid: {why}'))
        return response

    def _find_robot(self, frame: str) -> Pose | None:
        """Return the pose of the robot in ``frame``; None where no transform gives it."""
        try:
            return self._to_frame(robot_pose(self._settings()), frame)
        except Refusal:
            return None


class _Goal:
    """
    A goal that is being planned for.

    Its search ends when ``cancel`` is set: by its client (then ``cancelled`` is true), or by a
    newer goal (then ``preempted`` is). It arrived at ``arrived``, by ``time.monotonic`` [s].
    """

    def __init__(self) -> None:
        self.arrived = time.monotonic()
        self.cancel = threading.Event()
        self.cancelled = False
        self.preempted = False


class _Action:
    """
    The server of one of the two actions.

    Parameters
    ----------
    node : Node
        The node that offers the action.
    kind : type
        Type of the action, of ``nav2_msgs``.
    name : str
        Name of the action.
    poses_of : callable
        Returns the poses to pass, and the last one to end at, of a goal message.
    server : RequestServer
        The server that plans for the goals.
    settings : callable
        Returns the parameters in force.

    """

    def __init__(
        self,
        node: Node,
        kind: Any,
        name: str,
        poses_of: Callable[[Any], Sequence[PoseStamped]],
        server: RequestServer,
        settings: Callable[[], Settings],
    ) -> None:
        self._name = name
        self._poses_of = poses_of
        self._server = server
        self._settings = settings
        self._results = PathResults(kind)
        if self._results.why_slow:
            why = self._results.why_slow
            node.get_logger().warning(f'results of {name} are built pose by pose: {why}')
        self._goals: dict[bytes, _Goal] = {}
        self._one_at_a_time = threading.Lock()
        ActionServer(
            node,
            self._results.kind,
            name,
            self._execute,
            handle_accepted_callback=self._begin,
            cancel_callback=self._cancel,
            callback_group=ReentrantCallbackGroup(),
            result_timeout=RESULTS_KEPT,
        )

    def _begin(self, handle: ServerGoalHandle) -> None:
        """Begin to plan for a new goal, and end the search for any goal before it."""
        with self._one_at_a_time:
            for other in self._goals.values():
                other.preempted = True
                other.cancel.set()
            self._goals[_key(handle)] = _Goal()
        handle.execute()

    def _cancel(self, handle: ServerGoalHandle) -> CancelResponse:
        """End the search for a goal and accept that; reject it if the search has ended already."""
        with self._one_at_a_time:
            goal = self._goals.get(_key(handle))
            if goal is None:
                return CancelResponse.REJECT
            goal.cancelled = True
            goal.cancel.set()
            return CancelResponse.ACCEPT

    def _execute(self, handle: ServerGoalHandle) -> Any:
        """Plan for a goal, mark it as cancelled, succeeded or aborted, and return its result."""
        goal = self._goals[_key(handle)]
        handle.publish_feedback(self._results.kind.Feedback())
        publication = self._server.plan(
            self._name, self._request(handle.request), goal.cancel, goal.arrived
        )
        response = publication.response
        with self._one_at_a_time:
            del self._goals[_key(handle)]
        if goal.cancelled:
            _wait_for_cancellation(handle)
        if handle.is_cancel_requested:
            handle.canceled()
        elif response.solved:
            handle.succeed()
        else:
            handle.abort()
        result = self._result(response, publication.header, goal)
        self._server.response_sent()  # the result leaves when this returns
        return result

    def _request(self, goal: Any) -> PlanRequest:
        """Return the request for a path that a goal message stands for."""
        start = pose_from_message(goal.start) if goal.use_start else None
        poses = [pose_from_message(pose) for pose in self._poses_of(goal)]
        return goal_request(start, poses, goal.planner_id, self._settings())

    def _result(self, response: PlanResponse, header: Header, goal: _Goal) -> Any:
        """
        Return the result message: path, time, error code, and for a failure the reason.

        The reason is a newer goal where ``goal`` was preempted.
        """
        fields = {
            'error_code': getattr(self._results.kind.Result, error_name(response)),
            'planning_time': _duration(time.monotonic() - goal.arrived),
        }
        if not response.solved:
            why = 'a newer goal took its place' if goal.preempted else response.why
            fields['error_msg'] = f'{response.outcome.name}: {why}'
        if response.n_reached is not None and hasattr(self._results.kind.Result, 'ALL_GOALS'):
            fields['last_reached_index'] = response.n_reached - 1
        return self._results.make(response.poses, header, **fields)


def _poses_to_one(goal: Any) -> list[PoseStamped]:
    """Return the goal of an action to one pose, after its ``viapoints`` where Nav2 has them."""
    return [*getattr(goal, 'viapoints', ()), goal.goal]


def _poses_through(goal: Any) -> list[PoseStamped]:
    """Return the goals of an action through poses; newer ones of Nav2 wrap them."""
    return list(getattr(goal.goals, 'goals', goal.goals))


def _key(handle: ServerGoalHandle) -> bytes:
    return bytes(handle.goal_id.uuid)


def _wait_for_cancellation(handle: ServerGoalHandle) -> None:
    """
    Wait until rclpy marks a goal as cancelled, ``LONGEST_CHANGE`` at most.

    It does so only after our callback ``_cancel`` has accepted the cancellation.
    """
    deadline = time.monotonic() + LONGEST_CHANGE
    while not handle.is_cancel_requested and time.monotonic() < deadline:
        time.sleep(1e-3)


def _duration(seconds: float) -> Duration:
    """Return a duration [s] as a message, rounded to nanoseconds."""
    return RclpyDuration(nanoseconds=round(1e9 * seconds)).to_msg()
