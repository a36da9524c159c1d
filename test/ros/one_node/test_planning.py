"""Plans by every service of a real node, and what it publishes about each."""

import math
from test.brute_force import path_collisions
from test.ros.harness import (
    Client,
    grid_message,
    NodeProcess,
    points_in,
    points_of,
    pose,
    stamp_of,
    until,
    yaws_of,
)
from test.ros.rooms import DATA, GOAL, in_map, ORIGIN, RESOLUTION, START
import time

from diagnostic_msgs.msg import DiagnosticArray
from hnr_planner.server.requests.outcomes import Outcome
from nav_msgs.msg import Path
import numpy as np
import pytest
from rclpy.qos import QoSProfile

SERVICES = ('plan', 'plan_hit_and_run', 'plan_rrt')


@pytest.fixture(scope='module', autouse=True)
def map_is_there(client: Client, planner: NodeProcess) -> None:
    """Publish the rooms, turned and moved."""
    client.publish_map(grid_message(DATA, RESOLUTION, ORIGIN))
    planner.wait_for('map received')
    # No clock cuts what is compared.
    client.set_parameters(optimize_for=0.0, time_limit=600.0)


@pytest.mark.parametrize('service', SERVICES)
def test_path_is_free_and_ends_at_the_pose_asked_for(client: Client, service: str) -> None:
    path = client.plan(pose(*START), pose(*GOAL, yaw=2.0), service=service)
    outcome, values = client.outcome_of(path)
    points = points_of(path)
    assert outcome is Outcome.SOLVED
    assert path.header.frame_id == 'map'
    assert points[0].tolist() == list(START)
    assert points[-1].tolist() == list(GOAL)
    assert path_collisions(points, DATA >= 65, RESOLUTION, ORIGIN) == []
    assert yaws_of(path)[-1] == pytest.approx(2.0)
    assert float(values['offset']) == 0.0
    length = np.hypot(*np.diff(points, axis=0).T).sum()
    assert float(values['length']) == pytest.approx(length, rel=1e-5)


@pytest.mark.parametrize('service', SERVICES)
def test_algorithm_is_the_one_of_the_service(client: Client, service: str) -> None:
    client.set_parameters(algorithm='hit_and_run')
    path = client.plan(pose(*START), pose(*GOAL), service=service)
    client.set_parameters(algorithm='auto')
    expected = {'plan': 'hit_and_run'}.get(service, service.removeprefix('plan_'))
    assert client.outcome_of(path)[1]['algorithm'] == expected


def test_poses_are_spaced_by_the_resolution_and_look_along_the_path(client: Client) -> None:
    path = client.plan(pose(*START), pose(*GOAL, yaw=-1.0))
    steps = np.diff(points_of(path), axis=0)
    lengths = np.hypot(*steps.T)
    assert lengths.max() <= RESOLUTION + 1e-9
    assert lengths.min() > 0.0
    along = np.arctan2(steps[:, 1], steps[:, 0])
    assert np.allclose(np.exp(1j * yaws_of(path)[:-1]), np.exp(1j * along), atol=1e-6)


@pytest.mark.parametrize(('spacing', 'most'), [(0.5, 0.5), (0.0, 10.0)])
def test_pose_spacing_is_a_parameter(client: Client, spacing: float, most: float) -> None:
    client.set_parameters(pose_spacing=spacing)
    path = client.plan(pose(*START), pose(*GOAL))
    client.set_parameters(pose_spacing=-1.0)
    lengths = np.hypot(*np.diff(points_of(path), axis=0).T)
    assert RESOLUTION < lengths.max() <= most + 1e-9


def test_samples_markers_path_and_outcome_bear_the_stamp_of_the_answer(client: Client) -> None:
    path = client.plan(pose(*START), pose(*GOAL), service='plan_rrt')
    cloud = client.stamped(client.clouds, path)
    markers = client.stamped(client.markers, path)
    published = client.stamped(client.paths, path)
    _, values = client.outcome_of(path)
    assert np.array_equal(points_of(published), points_of(path))
    assert cloud.width == int(values['samples'])
    assert cloud.header.frame_id == path.header.frame_id
    points = points_in(cloud)
    assert [points['x'][0], points['y'][0]] == np.array(START, np.float32).tolist()
    assert points['parent'][0] == -1
    assert all(points['parent'][1:] < points['index'][1:])
    assert [marker.ns for marker in markers.markers[1:]] == [
        'samples',
        'tree',
        'path',
        'start',
        'goal',
    ]


def test_alternatives_have_a_message_each_with_one_stamp(client: Client) -> None:
    paths = client.listen(Path, '/hnr_planner/paths')
    client.set_parameters(alternatives=2)
    path = client.plan(pose(*START), pose(*GOAL))
    client.set_parameters(alternatives=1)
    _, values = client.outcome_of(path)
    count = int(values['alternatives'])

    def alternatives() -> list[Path]:
        return [one for one in list(paths) if stamp_of(one) == stamp_of(path)]

    until(lambda: len(alternatives()) >= count, 'all alternatives')
    first, *others = (points_of(one) for one in alternatives())
    assert np.array_equal(first, points_of(path)) and len(others) == count - 1
    for points in others:
        assert points[[0, -1]].tolist() == first[[0, -1]].tolist()


def test_outcome_says_where_the_time_went(client: Client) -> None:
    began = time.monotonic()
    path = client.plan(pose(*START), pose(*GOAL))
    round_trip = time.monotonic() - began
    _, values = client.outcome_of(path)
    elapsed = float(values['elapsed'])
    phases = [float(values[f'{name}_time']) for name in ('map', 'search', 'shortening', 'message')]
    assert min(phases) >= 0.0 and min(phases[1:]) > 0.0
    assert sum(phases) <= elapsed + 1e-5
    assert values['planning_time'] == values['elapsed']
    # What waits for the interpreter after sending counts as sending, up to a limit.
    assert elapsed - phases[3] <= round_trip


def test_two_trees_have_two_roots_start_and_goal(client: Client) -> None:
    path = client.plan(pose(*START), pose(*GOAL))
    points = points_in(client.stamped(client.clouds, path))
    assert np.flatnonzero(points['parent'] == -1).tolist() == [0, 1]
    roots = np.stack([points['x'], points['y']], axis=1)[:2]
    assert np.allclose(roots, [START, GOAL], atol=1e-5)


def test_late_subscriber_gets_the_last_result(client: Client) -> None:
    path = client.plan(pose(*START), pose(*GOAL))
    client.stamped(client.markers, path)
    late = Client()
    try:
        assert np.array_equal(points_of(late.stamped(late.paths, path)), points_of(path))
        assert late.stamped(late.clouds, path).width > 0
        assert late.stamped(late.markers, path).markers
        assert late.outcome_of(path)[0] is Outcome.SOLVED
        until(lambda: len(late.outcomes) >= 3, 'the outcomes of earlier requests')
    finally:
        late.close()


@pytest.mark.parametrize('service', SERVICES)
def test_same_seed_is_the_same_path(client: Client, service: str) -> None:
    client.set_parameters(seed=11)
    one, two = (client.plan(pose(*START), pose(*GOAL), service=service) for _ in range(2))
    client.set_parameters(seed=-1)
    assert np.array_equal(points_of(one), points_of(two))
    assert client.outcome_of(one)[1]['seed'] == '11'


def test_fresh_seeds_differ_and_are_reported(client: Client) -> None:
    paths = [client.plan(pose(*START), pose(*GOAL)) for _ in range(3)]
    assert len({client.outcome_of(path)[1]['seed'] for path in paths}) == 3


def test_reported_seed_gives_the_path_again(client: Client) -> None:
    path = client.plan(pose(*START), pose(*GOAL))
    client.set_parameters(seed=int(client.outcome_of(path)[1]['seed']))
    again = client.plan(pose(*START), pose(*GOAL))
    client.set_parameters(seed=-1)
    assert np.array_equal(points_of(path), points_of(again))


def test_stamps_increase_strictly_on_success_and_failure(client: Client) -> None:
    goals = [pose(*GOAL), pose(1e6, 0.0)] * 10
    paths = [client.plan(pose(*START), goal) for goal in goals]
    stamps = [(path.header.stamp.sec, path.header.stamp.nanosec) for path in paths]
    assert stamps == sorted(set(stamps))
    client.stamped(client.outcomes, paths[-1])
    outcomes = [(m.header.stamp.sec, m.header.stamp.nanosec) for m in client.outcomes]
    assert outcomes == sorted(set(outcomes))


def test_start_equal_to_goal_is_solved_by_two_poses(client: Client) -> None:
    path = client.plan(pose(*START), pose(*START, yaw=1.0))
    assert client.outcome_of(path)[0] is Outcome.SOLVED
    assert points_of(path).tolist() == [list(START), list(START)]
    assert yaws_of(path).tolist() == pytest.approx([1.0, 1.0])


def test_empty_frame_means_the_frame_of_the_map(client: Client) -> None:
    path = client.plan(pose(*START, frame=''), pose(*GOAL, frame=''))
    assert path.header.frame_id == 'map'
    assert client.outcome_of(path)[0] is Outcome.SOLVED


def test_tolerance_moves_a_blocked_goal_only_and_says_so(client: Client) -> None:
    wall = in_map(2.5, 0.5)
    assert client.outcome_of(client.plan(pose(*START), pose(*wall)))[0] is Outcome.INVALID_GOAL
    path = client.plan(pose(*START), pose(*wall), tolerance=0.2)
    outcome, values = client.outcome_of(path)
    offset = math.dist(points_of(path)[-1], wall)
    assert outcome is Outcome.SOLVED
    assert 0.05 - 1e-9 <= offset <= 0.2
    assert float(values['offset']) == pytest.approx(offset, abs=1e-6)
    assert 'moved' in values['why']
    reached = client.plan(pose(*START), pose(*GOAL), tolerance=1.0)
    assert points_of(reached)[-1].tolist() == list(GOAL)


def test_robot_radius_holds_from_the_next_request_on(client: Client) -> None:
    client.set_parameters(robot_radius=0.3)
    path = client.plan(pose(*START), pose(*GOAL))
    client.set_parameters(robot_radius=0.1)
    wide = client.plan(pose(*START), pose(*GOAL))
    client.set_parameters(robot_radius=0.0)
    assert client.outcome_of(path)[0] is Outcome.UNREACHABLE
    assert path_collisions(points_of(wide), DATA >= 65, RESOLUTION, ORIGIN, robot_radius=0.1) == []


def test_samples_are_capped_by_a_parameter(client: Client) -> None:
    client.set_parameters(samples_max=3, seed=5)
    path = client.plan(pose(*START), pose(*GOAL), service='plan_hit_and_run')
    client.set_parameters(samples_max=100_000, seed=-1)
    assert client.stamped(client.clouds, path).width == min(
        3, int(client.outcome_of(path)[1]['samples'])
    )


def test_health_is_published_and_counts(client: Client) -> None:
    heard = client.listen(DiagnosticArray, '/diagnostics', QoSProfile(depth=10))
    until(lambda: len(heard) >= 2, 'two reports of health')
    status = heard[-1].status[0]
    values = {item.key: item.value for item in status.values}
    assert status.name == '/hnr_planner: planner'
    assert (status.level, status.message) == (b'\0', 'ready')
    assert '100 x 100 cells of 0.05 m' in values['map']
    assert int(values['requests']) >= int(values['SOLVED']) > 0
    assert 0.0 < float(values['time_median']) <= float(values['time_p95'])
