"""Bad maps and bad requests: answered at once and by name, and the next good one is served."""

import math
from test.ros.harness import (
    Client,
    grid_message,
    NodeProcess,
    pose,
    set_field,
    two_rooms,
    until,
)
from typing import Any

from geometry_msgs.msg import PoseStamped
from hnr_planner.server.requests.outcomes import Outcome
from nav_msgs.msg import OccupancyGrid
import pytest

GOOD = grid_message(two_rooms())
START, GOAL = (0.5, 0.6), (4.5, 0.7)
NAN = math.nan


def refused(
    client: Client, start: PoseStamped, goal: PoseStamped, tolerance: float = 0.0
) -> tuple[Outcome, str]:
    """Ask for what cannot be given; return outcome and reason of the answer without a search."""
    path = client.plan(start, goal, tolerance=tolerance)
    assert path.poses == []
    outcome, values = client.outcome_of(path)
    assert values.get('iterations', '0') == '0'
    return outcome, values['why']


def test_before_the_first_map_requests_are_told_so(client: Client) -> None:
    """Stands first: the node has no map yet."""
    outcome, why = refused(client, pose(*START), pose(*GOAL))
    assert outcome is Outcome.NO_MAP
    assert 'map' in why


def test_first_map_that_is_bad_leaves_none(client: Client, planner: NodeProcess) -> None:
    """Stands second: still there is no map, and the log does not speak of one."""
    client.publish_map(bad_map('info.resolution', 1e-45))
    planner.wait_for('map refused')
    line = next(line for line in planner.log.splitlines() if 'map refused' in line)
    assert 'no map is in use' in line and 'got 1e-45 m' in line and 'stays' not in line
    outcome, why = refused(client, pose(*START), pose(*GOAL))
    assert outcome is Outcome.NO_MAP and '1e-45' in why


def test_good_map_ends_that(client: Client, planner: NodeProcess) -> None:
    """Stands third: from here on there is a good map."""
    client.publish_map(GOOD)
    planner.wait_for('map received')
    assert len(client.plan(pose(*START), pose(*GOAL)).poses) > 2


def bad_map(field: str, value: object) -> OccupancyGrid:
    """Return a map with one impossible field; dots lead to the field."""
    message = grid_message(two_rooms(50, 50))
    set_field(message, field, value)
    return message


def empty_map() -> OccupancyGrid:
    """Return a map of size 0."""
    message = OccupancyGrid()
    message.header.frame_id = 'map'
    message.info.resolution = 0.05
    return message


BAD_MAPS = {
    'no cells': empty_map(),
    '2500 values': bad_map('info.width', 51),
    'must be in 0.0001..1000 m, got 0.0': bad_map('info.resolution', 0.0),
    'must be in 0.0001..1000 m, got -1.0': bad_map('info.resolution', -1.0),
    'must be in 0.0001..1000 m, got nan': bad_map('info.resolution', NAN),
    'origin must be finite, got (nan': bad_map('info.origin.position.x', NAN),
    '0.0, nan)': bad_map('info.origin.position.z', NAN),
    'got [0.0, nan, 0.0, 1.0]': bad_map('info.origin.orientation.y', NAN),
    'got [0.0, 0.0, 0.0, 0.0]': bad_map('info.origin.orientation.w', 0.0),
    'must be level': bad_map('info.origin.orientation.y', 1.0),
}


@pytest.mark.parametrize('words', BAD_MAPS)
def test_bad_map_is_refused_and_the_good_one_stays(
    client: Client, planner: NodeProcess, words: str
) -> None:
    client.publish_map(BAD_MAPS[words])
    until(lambda: words in planner.log, f'the refusal of a map with "{words}"')
    line = next(line for line in planner.log.splitlines() if words in line)
    assert '[ERROR]' in line and 'map refused, the last good map stays in use' in line
    assert len(client.plan(pose(*START), pose(*GOAL)).poses) > 2


@pytest.mark.parametrize(
    ('point', 'words'),
    [((-1.0, 0.5), 'outside'), ((2.5, 0.5), 'obstacle'), ((1e30, 0.0), 'outside')],
)
def test_ends_outside_or_in_an_obstacle_are_named(
    client: Client, point: tuple[float, float], words: str
) -> None:
    outcome, why = refused(client, pose(*point), pose(*GOAL))
    assert outcome is Outcome.INVALID_START and words in why and 'start' in why
    outcome, why = refused(client, pose(*START), pose(*point))
    assert outcome is Outcome.INVALID_GOAL and words in why and 'goal' in why


@pytest.mark.parametrize('number', [NAN, math.inf])
def test_numbers_that_are_none_are_a_bad_request(client: Client, number: float) -> None:
    outcome, why = refused(client, pose(number, 0.5), pose(*GOAL))
    assert outcome is Outcome.BAD_REQUEST and 'start' in why and str(number) in why
    outcome, why = refused(client, pose(*START), pose(0.5, number))
    assert outcome is Outcome.BAD_REQUEST and 'goal' in why and str(number) in why


def test_goal_without_orientation_is_a_bad_request(client: Client) -> None:
    goal = pose(*GOAL)
    goal.pose.orientation.w = 0.0
    outcome, why = refused(client, pose(*START), goal)
    assert outcome is Outcome.BAD_REQUEST and 'orientation' in why


def test_stamp_before_the_beginning_of_time_is_a_bad_request(client: Client) -> None:
    start = pose(*START)
    start.header.stamp.sec = -1
    outcome, why = refused(client, start, pose(*GOAL))
    assert outcome is Outcome.BAD_REQUEST and 'stamp of the start' in why and '-1' in why


def test_other_frame_is_a_bad_frame(client: Client) -> None:
    for ends in ((pose(*START, frame='odom'), pose(*GOAL)), (pose(*START), pose(1, 1, 'odom'))):
        outcome, why = refused(client, *ends)
        assert outcome is Outcome.BAD_FRAME and "'odom'" in why and "'map'" in why


@pytest.mark.parametrize('tolerance', [-0.5, NAN, math.inf])
def test_impossible_tolerance_is_a_bad_request(client: Client, tolerance: float) -> None:
    outcome, why = refused(client, pose(*START), pose(*GOAL), tolerance)
    assert outcome is Outcome.BAD_REQUEST and 'tolerance' in why


def test_unreachable_goal_is_proved_at_once(client: Client, planner: NodeProcess) -> None:
    closed = two_rooms(door=0)
    client.publish_map(grid_message(closed, resolution=0.0501))
    until(lambda: 'of 0.0501 m' in planner.log, 'the closed rooms')
    outcome, _ = refused(client, pose(*START), pose(*GOAL))
    client.publish_map(grid_message(two_rooms(), resolution=0.0502))
    until(lambda: 'of 0.0502 m' in planner.log, 'the open rooms')
    assert outcome is Outcome.UNREACHABLE


def test_failure_is_empty_everywhere_and_clears_the_picture(client: Client) -> None:
    path = client.plan(pose(*START), pose(-1.0, 0.0))
    published = client.stamped(client.paths, path)
    assert published.poses == [] and published.header.frame_id == 'map'
    assert client.stamped(client.clouds, path).width == 0
    markers = client.stamped(client.markers, path).markers
    assert len(markers) == 1 and markers[0].action == markers[0].DELETEALL


@pytest.mark.parametrize(
    ('name', 'value', 'words'),
    [
        ('algorithm', 'a_star', 'auto, hit_and_run, rrt'),
        ('unknown', 'perhaps', 'blocked, free'),
        ('time_limit', 0.0, 'time_limit'),
        ('time_limit', 2, 'DOUBLE'),
        ('robot_radius', NAN, 'robot_radius'),
        ('seed', -5, 'seed'),
        ('pose_spacing', -0.3, 'vertices only'),
        ('map_subscribe_transient_local', False, 'read-only'),
    ],
)
def test_impossible_parameter_is_refused_and_nothing_changes(
    client: Client, name: str, value: Any, words: str
) -> None:
    before = client.get_parameters(name)
    (answer,) = client.set_parameters(**{name: value})
    assert not answer.successful
    assert words in answer.reason
    assert client.get_parameters(name) == before
    assert len(client.plan(pose(*START), pose(*GOAL)).poses) > 2


def test_omitted_start_is_taken_literally_and_the_log_says_so(
    client: Client, planner: NodeProcess
) -> None:
    outcome, why = refused(client, PoseStamped(), pose(*GOAL))
    assert outcome is Outcome.INVALID_START
    assert '(0, 0)' in why
    assert 'as if left out' in planner.log


def test_log_is_free_of_tracebacks(planner: NodeProcess) -> None:
    """Stands last."""
    assert 'Traceback' not in planner.log
