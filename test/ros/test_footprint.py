"""A node with a footprint: its path is one of poses, free by an independent check."""

from collections.abc import Iterator
import math
from test.pose_checker import PoseChecker
from test.ros.harness import (
    Client,
    from_corner,
    grid_message,
    node_process,
    NodeProcess,
    points_in,
    points_of,
    pose,
    until,
    yaws_of,
)
from typing import Any

from hnr_planner.core.kernels.modes import VARIABLE
from hnr_planner.ros.messages.paths import poses_from_path
from hnr_planner.server.geometry.pose_motions import twists_between
from hnr_planner.server.requests.outcomes import Outcome
from nav_msgs.msg import Path
import numpy as np
import pytest
from std_msgs.msg import Bool
from std_srvs.srv import Trigger

RESOLUTION, ORIGIN = 0.1, (1.0, -2.0, 0.4)
VERTICES = [[0.3, 0.2], [0.3, -0.2], [-0.2, -0.2], [-0.2, 0.2]]
SETTINGS = {'footprint': f"'{VERTICES}'", 'robot_radius': 0.3, 'time_limit': 600.0, 'seed': 1}


def rooms(door: int = 8) -> np.ndarray:
    """Return two rooms of 2 m x 2 m, and a door between them."""
    data = np.zeros((20, 40), dtype=np.int8)
    data[:, 19:21] = 100
    first = 10 - door // 2
    data[np.arange(first, first + door), 19:21] = 0
    return data


def at(x: float, y: float, yaw: float) -> tuple[float, float, float]:
    """Return a pose in the map frame, given from the map's corner along its sides."""
    return (*from_corner(ORIGIN, x, y), yaw + ORIGIN[2])


START, GOAL = at(0.5, 0.5, 0.0), at(3.5, 0.5, 1.5)


def message(x: float, y: float, yaw: float) -> Any:
    """Return a pose as a message."""
    return pose(x, y, yaw=yaw)


@pytest.fixture(scope='module')
def planner(tmp_path_factory: pytest.TempPathFactory) -> Iterator[NodeProcess]:
    """Run a node with a footprint; what it calls a few times is not compiled for it."""
    log = tmp_path_factory.mktemp('planner') / 'log'
    with pytest.MonkeyPatch.context() as monkeypatch:
        monkeypatch.setenv(VARIABLE, 'interpreted')
        with node_process('planner_node', log, **SETTINGS) as process:
            yield process


@pytest.fixture(scope='module', autouse=True)
def rooms_are_known(client: Client, planner: NodeProcess) -> None:
    """Let the rooms arrive."""
    client.publish_map(grid_message(rooms(), RESOLUTION, ORIGIN))
    planner.wait_for('map received')


@pytest.fixture(scope='module')
def answer(client: Client, rooms_are_known: None) -> Path:
    """Return the answer to a request from room to room."""
    return client.plan(message(*START), message(*GOAL))


def collisions(path: Path, data: np.ndarray) -> list[str]:
    """Return what the independent checker finds wrong with a path that a client has received."""
    poses = np.column_stack([points_of(path), yaws_of(path)])
    checker = PoseChecker(data > 0, RESOLUTION, ORIGIN, VERTICES)
    return checker.collisions(poses, twists_between(poses))


def test_poses_of_the_path_are_the_robot_on_its_way(client: Client, answer: Path) -> None:
    outcome, values = client.outcome_of(answer)
    assert outcome is Outcome.SOLVED, values['why']
    assert collisions(answer, rooms()) == []
    ends = poses_from_path(answer)[[0, -1]]
    np.testing.assert_allclose(ends[:, :2], [START[:2], GOAL[:2]])
    np.testing.assert_allclose(np.cos(ends[:, 2] - [START[2], GOAL[2]]), 1.0)
    steps = np.hypot(*np.diff(points_of(answer), axis=0).T)
    assert steps.max() <= RESOLUTION + 1e-9
    assert float(values['length']) == pytest.approx(steps.sum(), rel=0.01)
    cloud = points_in(client.stamped(client.clouds, answer))
    assert len(cloud) == int(values['samples']) and not cloud['z'].any()
    markers = {m.ns: m for m in client.stamped(client.markers, answer).markers}
    assert len(markers['footprint'].points) >= 2 * len(VERTICES) * 10


def test_log_says_what_the_robot_is(planner: NodeProcess) -> None:
    assert 'footprint with 4 vertices, differential drive' in planner.log
    assert 'robot_radius is not used: the robot has a footprint' in planner.log


def test_map_that_meets_only_the_footprint_makes_the_path_invalid(
    client: Client, planner: NodeProcess, answer: Path
) -> None:
    valid = client.listen(Bool, '/hnr_planner/path_valid')
    data, points = rooms(), points_of(answer)
    x, y = points[len(points) // 2]
    yaw = yaws_of(answer)[len(points) // 2]
    # A cell beside the path, nearer than the robot is wide.
    z = complex(x - 0.15 * math.sin(yaw), y + 0.15 * math.cos(yaw)) - complex(*ORIGIN[:2])
    z *= complex(math.cos(ORIGIN[2]), -math.sin(ORIGIN[2]))
    data[int(z.imag / RESOLUTION), int(z.real / RESOLUTION)] = 100
    assert collisions(answer, data) != []
    client.publish_map(grid_message(data, RESOLUTION, ORIGIN))
    until(lambda: valid and not valid[-1].data, 'a blocked path')
    client.publish_map(grid_message(rooms(), RESOLUTION, ORIGIN))
    until(lambda: valid[-1].data, 'a free path')


def test_what_has_no_meaning_is_refused_and_changes_hold_from_the_next_request_on(
    client: Client, planner: NodeProcess, answer: Path
) -> None:
    assert 'BAD_REQUEST' in client.call(Trigger, '/hnr_planner/sample', Trigger.Request()).message
    moved = client.plan(message(*START), message(*GOAL), 'plan_kinodynamic_connect')
    assert client.outcome_of(moved)[0] is Outcome.BAD_REQUEST
    (refusal,) = client.set_parameters(footprint='[[0, 0], [1, 1]]')
    assert not refusal.successful and 'k >= 3' in refusal.reason
    client.set_parameters(footprint='[[0.44, 0.44], [0.44, -0.44], [-0.44, -0.44], [-0.44, 0.44]]')
    wide = client.plan(message(*START), message(*GOAL))
    assert client.outcome_of(wide)[0] is Outcome.UNREACHABLE
    client.set_parameters(footprint='[]')
    circle = client.plan(message(*START), message(*GOAL), 'plan_rrt')
    outcome, values = client.outcome_of(circle)
    assert outcome is Outcome.SOLVED and float(values['clearance']) >= 0.3 - 0.15
    yaws, steps = yaws_of(circle), np.diff(points_of(circle), axis=0)
    np.testing.assert_allclose(np.cos(yaws[:-1] - np.arctan2(steps[:, 1], steps[:, 0])), 1.0)
