"""A node that searches for seconds answers everything else meanwhile."""

from collections.abc import Iterator
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
import time
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from hnr_planner.server.requests.outcomes import Outcome
import numpy as np
import pytest
from rclpy.qos import QoSProfile

MAZE = maze()
RESOLUTION = 0.05
MAZE_END = 0.05 * 400.5

#: Seconds that a busy machine may take longer; searches here last a minute.
SLACK = 10.0

#: Ends of the maze: no search gets from one to the other in the time of these tests.
START, GOAL = pose(0.025, 0.025), pose(MAZE_END, MAZE_END)


@pytest.fixture(scope='module', autouse=True)
def maze_is_there(client: Client, planner: NodeProcess) -> None:
    """Publish the maze, and give searches the time that they would need for it."""
    client.publish_map(grid_message(MAZE, RESOLUTION))
    planner.wait_for('map received')
    client.set_parameters(time_limit=60.0)


@pytest.fixture
def searches(client: Client, planner: NodeProcess) -> Iterator[list[Any]]:
    """Start a few searches and return the futures of their answers; end them afterwards."""
    futures = [client.send_plan(START, GOAL, service=name) for name in SERVICES]
    client.wait_for_running(len(futures))
    yield futures
    client.cancel()
    for future in futures:
        result_of(future)


SERVICES = ('plan_rrt', 'plan_hit_and_run', 'plan_rrt', 'plan_hit_and_run')


def test_health_keeps_its_beat_and_other_requests_go_through_during_five_seconds(
    client: Client, searches: list[Any]
) -> None:
    # The searches go on for a minute: what goes through meanwhile did not wait for them.
    beats: list[float] = []
    client.node.create_subscription(
        DiagnosticArray,
        '/diagnostics',
        lambda _: beats.append(time.monotonic()),
        QoSProfile(depth=10),
    )
    for _ in range(5):
        path = client.plan(START, START)
        assert len(path.poses) == 2
        assert client.plan(START, pose(-1.0, 0.0)).poses == []
        assert client.get_parameters('time_limit') == [60.0]
    until(lambda: len(beats) >= 6, 'six reports of health')
    assert not any(future.done() for future in searches)
    assert np.diff(beats).max() < 1.0 + SLACK


def test_cancel_ends_all_searches_and_says_how_many(client: Client, searches: list[Any]) -> None:
    answer = client.cancel()
    assert answer.success
    assert answer.message.startswith(f'{len(searches)} running searches')
    began = time.monotonic()
    for future in searches:
        path = result_of(future).plan
        assert path.poses == []
        assert client.outcome_of(path)[0] is Outcome.CANCELLED
    assert time.monotonic() - began < SLACK


def test_cancel_of_nothing_says_so(client: Client) -> None:
    assert client.cancel().message.startswith('0 running searches')


def test_more_searches_than_places_leave_cancel_a_thread(client: Client) -> None:
    futures = [client.send_plan(START, GOAL, service='plan_rrt') for _ in range(40)]
    time.sleep(1.0)

    def all_end() -> bool:
        client.cancel()
        return all(future.done() for future in futures)

    until(all_end, 'the end of all searches')
    assert {client.outcome_of(f.result().plan)[0] for f in futures} == {Outcome.CANCELLED}


def test_time_limit_holds(client: Client) -> None:
    client.set_parameters(time_limit=0.5)
    began = time.monotonic()
    path = client.plan(START, GOAL, service='plan_hit_and_run')
    elapsed = time.monotonic() - began
    client.set_parameters(time_limit=60.0)
    outcome, values = client.outcome_of(path)
    assert outcome is Outcome.TIMEOUT
    assert 0.5 <= elapsed < 0.5 + SLACK
    assert int(values['iterations']) > 0
    shown = client.stamped(client.clouds, path).width
    assert shown == min(int(values['samples']), 100_000) > 0


def test_map_that_changes_its_size_disturbs_neither_search_nor_truth(
    client: Client, planner: NodeProcess, searches: list[Any]
) -> None:
    rooms = two_rooms(60, 80)
    client.publish_map(grid_message(rooms, resolution=0.0625))
    until(lambda: '80 x 60 cells of 0.0625 m' in planner.log, 'the smaller map')
    # A new request is answered on the new map while the old searches go on.
    path = client.plan(pose(0.5, 0.5), pose(4.5, 0.5))
    assert path_collisions(points_of(path), rooms >= 65, 0.0625) == []
    assert client.outcome_of(path)[0] is Outcome.SOLVED
    assert not any(future.done() for future in searches)
    client.publish_map(grid_message(MAZE, RESOLUTION))


def test_path_found_on_a_map_that_is_gone_is_not_given(
    client: Client, planner: NodeProcess
) -> None:
    """The motion is made faster for 6 s; meanwhile a wall closes its door."""
    open_rooms, closed = two_rooms(100, 104), two_rooms(100, 104, door=0)
    client.publish_map(grid_message(open_rooms, RESOLUTION))
    until(lambda: planner.log.count('104 x 100 cells') == 1, 'the open rooms')
    client.set_parameters(optimize_for=6.0)
    ends = pose(0.5, 0.5), pose(4.5, 0.5)
    future = client.send_plan(*ends, service='plan_kinodynamic_connect')
    client.wait_for_running(1)
    client.publish_map(grid_message(closed, RESOLUTION))
    until(lambda: planner.log.count('104 x 100 cells') == 2, 'the closed rooms')
    assert not future.done()
    path = result_of(future).plan
    client.set_parameters(optimize_for=0.0)
    assert path.poses == []
    assert client.outcome_of(path)[0] is Outcome.UNREACHABLE
