"""The click tools of RViz: a start is kept, a goal is planned to."""

from collections.abc import Iterator
import math
from pathlib import Path
from test.ros.harness import (
    Client,
    grid_message,
    MANY,
    node_process,
    NodeProcess,
    points_of,
    pose,
    two_rooms,
    until,
)

from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
from hnr_planner.ros.messages.outcomes import read_outcome
from hnr_planner.server.requests.outcomes import Outcome
import pytest
from rclpy.publisher import Publisher

START, GOAL, IN_WALL = (0.5, 0.6), (4.5, 0.7), (2.5, 0.5)


@pytest.fixture
def planner(tmp_path: Path) -> Iterator[NodeProcess]:
    """Run a planning node that listens to clicks."""
    with node_process('planner_node', tmp_path / 'log', rviz_clicks=True) as process:
        yield process


@pytest.fixture
def client(planner: NodeProcess) -> Iterator[Client]:
    """Return a client of that node, which has a map."""
    client = Client()
    client.publish_map(grid_message(two_rooms()))
    planner.wait_for('map received')
    yield client
    client.close()


def clicker(client: Client, kind: type, topic: str) -> Publisher:
    """Return a publisher that the node listens to."""
    publisher = client.node.create_publisher(kind, topic, MANY)
    until(publisher.get_subscription_count, f'a subscription to {topic}')
    return publisher


def after(client: Client, publisher: Publisher, goal: PoseStamped) -> tuple[Outcome, dict]:
    """Click a goal and return what came of it."""
    known = len(client.outcomes)
    publisher.publish(goal)
    message = until(lambda: client.outcomes[known:], 'an outcome')[0]
    assert message.status[0].name == '/hnr_planner/goal_pose'
    return read_outcome(message)


def test_goal_is_planned_to_from_the_start_that_was_clicked(
    client: Client, planner: NodeProcess
) -> None:
    goals = clicker(client, PoseStamped, '/goal_pose')
    starts = clicker(client, PoseWithCovarianceStamped, '/initialpose')
    outcome, values = after(client, goals, pose(*GOAL))
    assert outcome is Outcome.NO_START and 'start' in values['why']

    click = PoseWithCovarianceStamped(header=pose(*START).header)
    click.pose.pose = pose(*START).pose
    starts.publish(click)
    planner.wait_for('the start is (0.5, 0.6)')
    for goal in (GOAL, (4.5, 4.5)):
        assert after(client, goals, pose(*goal))[0] is Outcome.SOLVED
        path = until(lambda goal=goal: ends_at(client, goal), 'the path')
        assert path[0] == list(START)

    assert after(client, goals, pose(*IN_WALL))[0] is Outcome.INVALID_GOAL
    client.set_parameters(default_tolerance=0.5)
    outcome, values = after(client, goals, pose(*IN_WALL))
    assert outcome is Outcome.SOLVED and 0.0 < float(values['offset']) <= 0.5
    assert after(client, goals, pose(math.nan, 0.0))[0] is Outcome.BAD_REQUEST

    client.set_parameters(rviz_clicks=False)
    until(lambda: not goals.get_subscription_count(), 'an end of listening')
    client.set_parameters(rviz_clicks=True)
    until(goals.get_subscription_count, 'a subscription again')
    assert after(client, goals, pose(*GOAL))[0] is Outcome.NO_START


def ends_at(client: Client, goal: tuple[float, float]) -> list[list[float]]:
    """Return the points of the last path if it ends at ``goal``."""
    points = points_of(client.paths[-1]).tolist()
    return points if points and points[-1] == list(goal) else []
