"""The actions and the service that Nav2 asks a planner server for, where nav2_msgs is there."""

from collections.abc import Iterator
import signal
from test.brute_force import path_collisions
from test.ros.harness import (
    Client,
    grid_message,
    maze,
    NodeProcess,
    points_of,
    pose,
    result_of,
    two_rooms,
    until,
)
from test.ros.one_node.test_msg_docs import examples, fill, OFFICE
from typing import Any

from action_msgs.msg import GoalStatus
from builtin_interfaces.msg import Duration
from hnr_planner.maps import load_map
from hnr_planner.ros.messages.action_results import PathResults
from hnr_planner.ros.messages.paths import path_message
from nav_msgs.msg import Path
import numpy as np
import pytest
from rclpy.action import ActionClient
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import Header
import yaml

MISSING = 'nav2_msgs comes with a ROS from apt only'
actions_of_nav2 = pytest.importorskip('nav2_msgs.action', reason=MISSING)
services_of_nav2 = pytest.importorskip('nav2_msgs.srv', reason=MISSING)
ToPose = actions_of_nav2.ComputePathToPose
ThroughPoses = actions_of_nav2.ComputePathThroughPoses
IsPathValid = services_of_nav2.IsPathValid
ROOMS = two_rooms()
START, MIDDLE, GOAL = (0.5, 0.6), (2.5, 2.5), (4.5, 0.7)
ACTIONS = {'compute_path_to_pose': ToPose, 'compute_path_through_poses': ThroughPoses}


class SafeActionClient(ActionClient):
    """
    An action client that other threads than that of its node's executor may use.

    rclpy's own drops a response that the executor takes before the call that asked for it has
    noted its number: here each such call is made in the executor's thread.
    """

    def send_goal_async(self, *args: Any, **named: Any) -> Any:
        return self._in_executor(super().send_goal_async, *args, **named)

    def _get_result_async(self, handle: Any) -> Any:
        return self._in_executor(super()._get_result_async, handle)

    def _cancel_goal_async(self, handle: Any) -> Any:
        return self._in_executor(super()._cancel_goal_async, handle)

    def _in_executor(self, call: Any, *args: Any, **named: Any) -> Any:
        return result_of(self._node.executor.create_task(call, *args, **named))


@pytest.fixture(scope='module')
def actions(client: Client, planner: NodeProcess) -> dict[str, ActionClient]:
    """Return clients of both actions of a node that has the rooms."""
    client.publish_map(grid_message(ROOMS))
    planner.wait_for('map received')
    made = {name: SafeActionClient(client.node, kind, name) for name, kind in ACTIONS.items()}
    assert all(action.wait_for_server(20.0) for action in made.values())
    return made


@pytest.fixture
def long_search(client: Client, planner: NodeProcess) -> Iterator[dict[str, Any]]:
    """Put a map to use on which a search takes long, and return the fields of such a goal."""
    received = planner.log.count('map received')
    client.publish_map(grid_message(maze()))
    until(lambda: planner.log.count('map received') > received, 'the maze')
    client.set_parameters(time_limit=60.0, algorithm='hit_and_run')
    yield {'start': pose(0.025, 0.025), 'goal': pose(20.0, 20.0), 'use_start': True}
    if planner.popen.poll() is None:
        client.set_parameters(time_limit=1.0, algorithm='auto')
        client.publish_map(grid_message(ROOMS))
        until(lambda: planner.log.count('map received') > received + 1, 'the rooms')


def to_pose(**changes: Any) -> Any:
    """Return a goal of the first action, with some fields changed."""
    usual = {'start': pose(*START), 'goal': pose(*GOAL), 'use_start': True}
    return ToPose.Goal(**(usual | changes))


def through_poses(*goals: tuple[float, float], **changes: Any) -> Any:
    """Return a goal of the second action."""
    usual = {'start': pose(*START), 'use_start': True}
    message = ThroughPoses.Goal(**(usual | changes))
    poses = [pose(*goal) for goal in goals]
    if hasattr(message.goals, 'goals'):  # newer ones of Nav2 wrap them
        message.goals.goals = poses
    else:
        message.goals = poses
    return message


def send(action: ActionClient, goal: Any) -> Any:
    """Send a goal and return its handle."""
    handle = result_of(action.send_goal_async(goal))
    assert handle.accepted
    return handle


def ask(action: ActionClient, goal: Any) -> tuple[int, Any]:
    """Send a goal; return its status and its result."""
    answer = result_of(send(action, goal).get_result_async())
    return answer.status, answer.result


def test_path_to_a_pose(
    actions: dict[str, ActionClient], client: Client, planner: NodeProcess
) -> None:
    assert 'pose by pose' not in planner.log
    status, result = ask(actions['compute_path_to_pose'], to_pose())
    assert status == GoalStatus.STATUS_SUCCEEDED
    assert (result.error_code, result.error_msg) == (ToPose.Result.NONE, '')
    points = points_of(result.path)
    assert path_collisions(points, ROOMS >= 65, 0.05) == []
    assert points[0].tolist() == list(START) and points[-1].tolist() == list(GOAL)
    assert result.planning_time.nanosec > 0
    # Which of the two made the path of auto depends on the clock.
    made_by = client.outcome_of(result.path)[1]['algorithm']
    assert made_by in ('hit_and_run_connect', 'polyanya')


@pytest.mark.parametrize('name', ACTIONS)
@pytest.mark.parametrize('n_poses', [0, 2, 3, 500])
def test_result_from_bytes_is_the_ordinary_one(name: str, n_poses: int) -> None:
    kind, header = ACTIONS[name], Header(frame_id='map')
    rows = np.random.default_rng(n_poses).normal(size=(n_poses, 7))
    results = PathResults(kind)
    assert results.why_slow == ''
    fields = {'error_msg': 'why', 'error_code': 3, 'planning_time': Duration(sec=1)}
    response = results.kind.Impl.GetResultService.Response()
    response.status, response.result = 4, results.make(rows, header, **fields)
    ordinary = kind.Result(path=path_message(rows, header), **fields)
    sent = deserialize_message(serialize_message(response), kind.Impl.GetResultService.Response)
    assert (sent.status, sent.result) == (4, ordinary)
    # Whoever takes the result in the ordinary way gets the path as well.
    assert response.result.path == ordinary.path


def test_result_is_the_ordinary_one_where_bytes_do_not_work() -> None:
    results = PathResults(ToPose)
    results.why_slow = 'another rclpy'
    rows = np.random.default_rng(0).normal(size=(3, 7))
    made = results.make(rows, Header(), error_msg='why')
    assert made == ToPose.Result(path=path_message(rows, Header()), error_msg='why')


def test_path_through_poses_meets_each(actions: dict[str, ActionClient], client: Client) -> None:
    status, result = ask(actions['compute_path_through_poses'], through_poses(MIDDLE, GOAL, START))
    assert status == GoalStatus.STATUS_SUCCEEDED, result.error_msg
    points = points_of(result.path).tolist()
    assert path_collisions(points, ROOMS >= 65, 0.05) == []
    places = [points.index(list(place)) for place in (START, MIDDLE, GOAL)]
    assert places == sorted(places)
    assert points[-1] == list(START)
    assert points_of(client.stamped(client.paths, result.path)).tolist() == points


@pytest.mark.parametrize('planner_id', ['rrt', 'hit_and_run'])
def test_planner_id_names_the_algorithm(
    actions: dict[str, ActionClient], client: Client, planner_id: str
) -> None:
    _, result = ask(actions['compute_path_to_pose'], to_pose(planner_id=planner_id))
    assert client.outcome_of(result.path)[1]['algorithm'] == planner_id


FAILURES = {
    'INVALID_PLANNER': {'planner_id': 'Smac'},
    'TF_ERROR': {'goal': pose(*GOAL, frame='nowhere')},
    'START_OUTSIDE_MAP': {'start': pose(-1.0, 0.0)},
    'GOAL_OUTSIDE_MAP': {'goal': pose(0.0, 99.0)},
    'START_OCCUPIED': {'start': pose(2.5, 0.1)},
    'GOAL_OCCUPIED': {'goal': pose(2.5, 0.1)},
    'UNKNOWN': {'goal': pose(float('nan'), 1.0)},
}


@pytest.mark.parametrize('name', FAILURES)
def test_failure_has_its_code_and_words(actions: dict[str, ActionClient], name: str) -> None:
    status, result = ask(actions['compute_path_to_pose'], to_pose(**FAILURES[name]))
    assert status == GoalStatus.STATUS_ABORTED
    assert result.error_code == getattr(ToPose.Result, name)
    assert len(result.error_msg) > 20
    assert result.path.poses == []


def test_failures_through_poses(actions: dict[str, ActionClient]) -> None:
    action, codes = actions['compute_path_through_poses'], ThroughPoses.Result
    for goals, code in (((), codes.NO_VIAPOINTS_GIVEN), (((2.5, 0.1), GOAL), codes.GOAL_OCCUPIED)):
        status, result = ask(action, through_poses(*goals))
        assert status == GoalStatus.STATUS_ABORTED
        assert result.error_code == code, result.error_msg
    assert 'leg 1 of 2' in result.error_msg


def test_partial_path_through_poses_where_it_is_allowed(
    actions: dict[str, ActionClient], client: Client
) -> None:
    action, goals = actions['compute_path_through_poses'], (MIDDLE, (2.5, 0.1), GOAL)
    status, result = ask(action, through_poses(*goals))
    assert status == GoalStatus.STATUS_ABORTED
    client.set_parameters(allow_partial_planning=True)
    status, result = ask(action, through_poses(*goals))
    none, _ = ask(action, through_poses((2.5, 0.1), GOAL))
    client.set_parameters(allow_partial_planning=False)
    assert (status, none) == (GoalStatus.STATUS_SUCCEEDED, GoalStatus.STATUS_ABORTED)
    assert points_of(result.path)[-1].tolist() == list(MIDDLE)
    assert 'leg 2 of 3' in client.outcome_of(result.path)[1]['why']
    if hasattr(ThroughPoses.Result, 'ALL_GOALS'):
        assert result.last_reached_index == 0
        assert ask(action, through_poses(MIDDLE))[1].last_reached_index == -1


@pytest.mark.skipif(not hasattr(ToPose.Goal(), 'viapoints'), reason='Nav2 has none here yet')
def test_viapoints_are_met(actions: dict[str, ActionClient]) -> None:
    goal = to_pose(viapoints=[pose(*MIDDLE)])
    status, result = ask(actions['compute_path_to_pose'], goal)
    assert status == GoalStatus.STATUS_SUCCEEDED
    assert list(MIDDLE) in points_of(result.path).tolist()


@pytest.mark.skipif(not hasattr(IsPathValid.Request(), 'footprint'), reason='not in this Nav2')
def test_path_is_judged_as_newer_requests_want(
    actions: dict[str, ActionClient], client: Client
) -> None:
    path = ask(actions['compute_path_to_pose'], to_pose())[1].path
    for blocked in (10, 20):
        path.poses[blocked].pose.position.x = 2.5
        path.poses[blocked].pose.position.y = 0.1

    def judged(**wishes: Any) -> Any:
        return client.call(IsPathValid, '/is_path_valid', IsPathValid.Request(path=path, **wishes))

    assert len(judged(stop_at_first_collision=True).invalid_pose_indices) == 1
    assert len(judged(stop_at_first_collision=False).invalid_pose_indices) > 1
    ahead = judged(max_lookahead_distance=0.2)
    assert ahead.success and ahead.is_valid
    for wishes in ({'layer_name': 'a'}, {'footprint': '[[0, 0]]'}, {'max_cost': 10}):
        refused = judged(**wishes)
        assert not refused.success and not refused.is_valid


def test_start_of_the_robot_needs_a_transform(actions: dict[str, ActionClient]) -> None:
    status, result = ask(actions['compute_path_to_pose'], to_pose(use_start=False))
    assert status == GoalStatus.STATUS_ABORTED
    assert result.error_code == ToPose.Result.TF_ERROR
    assert "'base_link'" in result.error_msg


def test_time_limit_is_a_timeout(
    actions: dict[str, ActionClient], client: Client, long_search: dict[str, Any]
) -> None:
    client.set_parameters(time_limit=0.2)
    _, result = ask(actions['compute_path_to_pose'], to_pose(**long_search))
    assert result.error_code == ToPose.Result.TIMEOUT


def test_cancelled_goal_ends_as_cancelled(
    actions: dict[str, ActionClient], client: Client, long_search: dict[str, Any]
) -> None:
    handle = send(actions['compute_path_to_pose'], to_pose(**long_search))
    client.wait_for_running(1)
    answer = result_of(handle.cancel_goal_async())
    assert len(answer.goals_canceling) == 1
    assert result_of(handle.get_result_async()).status == GoalStatus.STATUS_CANCELED
    client.wait_for_running(0)


def test_newer_goal_takes_the_place_of_the_one_before(
    actions: dict[str, ActionClient], client: Client, long_search: dict[str, Any]
) -> None:
    heard: list[Any] = []
    action = actions['compute_path_to_pose']
    first = result_of(action.send_goal_async(to_pose(**long_search), heard.append))
    client.wait_for_running(1)
    short = to_pose(**(long_search | {'goal': long_search['start']}))
    status, _ = ask(action, short)
    assert status == GoalStatus.STATUS_SUCCEEDED
    ended = result_of(first.get_result_async())
    assert ended.status == GoalStatus.STATUS_ABORTED
    assert 'newer goal' in ended.result.error_msg
    assert len(heard) == 1, 'feedback'
    # The other action goes its own way.
    other = send(actions['compute_path_through_poses'], through_poses((20.0, 20.0)))
    client.wait_for_running(1)
    ask(action, short)
    client.wait_for_running(1)
    assert client.cancel().message.startswith('1 running')
    assert result_of(other.get_result_async()).status == GoalStatus.STATUS_ABORTED


def test_planner_of_motions_succeeds_without_an_error(
    actions: dict[str, ActionClient], client: Client
) -> None:
    client.set_parameters(time_limit=600.0)
    status, result = ask(
        actions['compute_path_to_pose'], to_pose(planner_id='kinodynamic_connect')
    )
    client.set_parameters(time_limit=1.0)
    assert status == GoalStatus.STATUS_SUCCEEDED
    assert result.error_code == 0 and result.error_msg == '' and len(result.path.poses) > 2


def test_validity_of_a_path(
    actions: dict[str, ActionClient], client: Client, planner: NodeProcess
) -> None:
    def judged(path: Path) -> tuple[bool, list[int]]:
        request = IsPathValid.Request(path=path)
        if hasattr(request, 'stop_at_first_collision'):
            request.stop_at_first_collision = False
        answer = client.call(IsPathValid, '/is_path_valid', request)
        return answer.is_valid, list(answer.invalid_pose_indices)

    path = ask(actions['compute_path_to_pose'], to_pose())[1].path
    assert judged(path) == (True, [])
    path.poses[3].pose.position.x = 2.5
    path.poses[3].pose.position.y = 0.1
    valid, numbers = judged(path)
    assert not valid and 3 in numbers
    path.header.frame_id = 'odom'
    assert judged(path) == (False, list(range(len(path.poses))))
    assert judged(Path()) == (False, [])
    for why in ("in frame 'odom', the map in 'map'", 'the path has no poses', 'is not free'):
        assert any('is_path_valid: ' in line and why in line for line in planner.log.splitlines())


def test_examples_of_the_pages_work(client: Client, planner: NodeProcess) -> None:
    """Stands second to last: it puts another map to use."""
    office = load_map(OFFICE)
    received = planner.log.count('map received')
    client.publish_map(grid_message(office.data, office.resolution, office.origin))
    until(lambda: planner.log.count('map received') > received, 'the office')
    for name, kind, fields in examples('ros2 action send_goal'):
        action = ACTIONS[name.removeprefix('/')]
        assert kind == f'nav2_msgs/action/{action.__name__}'
        values = yaml.safe_load(fields)
        if hasattr(getattr(action.Goal(), 'goals', None), 'goals'):  # as newer ones wrap them
            values['goals'] = {'goals': values['goals']}
        goal = fill(action.Goal(), values)
        status, result = ask(ActionClient(client.node, action, name), goal)
        assert status == GoalStatus.STATUS_SUCCEEDED, result.error_msg
    ((name, _, fields),) = (e for e in examples('ros2 service call') if 'nav2_msgs' in e[1])
    request = fill(IsPathValid.Request(), yaml.safe_load(fields))
    assert client.call(IsPathValid, name, request).is_valid


def test_node_ends_in_order_during_a_goal(
    actions: dict[str, ActionClient],
    client: Client,
    planner: NodeProcess,
    long_search: dict[str, Any],
) -> None:
    """Stands last."""
    send(actions['compute_path_to_pose'], to_pose(**long_search))
    client.wait_for_running(1)
    assert planner.end(signal.SIGTERM) == 0
    assert 'Traceback' not in planner.log
