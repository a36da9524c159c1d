"""The last path is watched: what a new map makes of it is published at once."""

from test.ros.harness import (
    Client,
    grid_message,
    LATCHED,
    NodeProcess,
    points_of,
    pose,
    two_rooms,
    until,
)

from hnr_planner.ros.messages.outcomes import read_outcome
from hnr_planner.server.requests.outcomes import Outcome
import numpy as np
import pytest
from std_msgs.msg import Bool

START, GOAL = (0.5, 0.6), (4.5, 0.7)
RESOLUTION = 0.05


@pytest.fixture
def valid(client: Client, planner: NodeProcess) -> list[Bool]:
    """Plan through the open door; return what is said of the path from now on."""
    send(client, planner, two_rooms())
    heard = client.listen(Bool, '/hnr_planner/path_valid', LATCHED)
    assert len(client.plan(pose(*START), pose(*GOAL)).poses) > 2
    until(lambda: heard and heard[-1].data, 'a valid path')
    return heard


def send(client: Client, planner: NodeProcess, data: np.ndarray, frame: str = 'map') -> None:
    """Let a map arrive; in one free cell it is unlike all before it."""
    maps = planner.log.count('map received')
    data[-1, -1] = maps % 60
    client.publish_map(grid_message(data, RESOLUTION, frame=frame))
    until(lambda: planner.log.count('map received') > maps, 'the map')


def test_map_that_blocks_the_path_is_told_with_the_place(
    client: Client, planner: NodeProcess, valid: list[Bool]
) -> None:
    answer = client.plan(pose(*START), pose(*GOAL))
    client.outcome_of(answer)
    path, outcomes = points_of(answer), len(client.outcomes)
    send(client, planner, two_rooms(door=0))
    until(lambda: not valid[-1].data, 'a blocked path')
    message = until(lambda: client.outcomes[outcomes:], 'the outcome')[0]
    outcome, values = read_outcome(message)
    assert outcome is Outcome.MAP_CHANGED
    assert message.status[0].name == '/hnr_planner/path_valid'
    assert message.header.stamp != answer.header.stamp
    # The wall begins at column 49, and the path crosses it from the left.
    assert float(values['blocked_x']) == pytest.approx(49 * RESOLUTION, abs=1e-6)
    before = path[path[:, 0] <= float(values['blocked_x'])]
    assert abs(before[-1, 1] - float(values['blocked_y'])) < RESOLUTION
    assert values['blocked_x'][:4] in values['why']

    send(client, planner, two_rooms())
    until(lambda: valid[-1].data, 'a free path again')


def test_map_that_leaves_the_path_free_says_nothing(
    client: Client, planner: NodeProcess, valid: list[Bool]
) -> None:
    said = len(valid)
    rooms = two_rooms()
    rooms[-1, :5] = 100
    send(client, planner, rooms)
    send(client, planner, np.pad(rooms, ((0, 50), (0, 50))))
    # An answer comes after all that the maps had to say.
    client.plan(pose(*START), pose(*GOAL))
    until(lambda: len(valid) > said, 'the next path')
    assert [message.data for message in valid[said:]] == [True]


def test_robot_that_became_too_large_blocks_the_path(
    client: Client, planner: NodeProcess, valid: list[Bool]
) -> None:
    client.set_parameters(robot_radius=0.3)
    until(lambda: not valid[-1].data, 'a blocked path')
    client.set_parameters(robot_radius=0.0)
    until(lambda: valid[-1].data, 'a free path again')


def test_failure_leaves_no_path_to_be_valid(client: Client, valid: list[Bool]) -> None:
    client.plan(pose(*START), pose(-1.0, 0.0))
    until(lambda: not valid[-1].data, 'no path')


def test_map_in_another_frame_blocks_the_path(
    client: Client, planner: NodeProcess, valid: list[Bool]
) -> None:
    send(client, planner, two_rooms(), frame='floor')
    until(lambda: not valid[-1].data, 'a blocked path')


def test_late_subscriber_hears_the_last_word(client: Client, valid: list[Bool]) -> None:
    late = client.listen(Bool, '/hnr_planner/path_valid', LATCHED)
    until(lambda: late, 'the last word')
    assert [message.data for message in late] == [True]
