"""Keepout zones over real DDS: from the topic, and as Nav2's filters announce them."""

from importlib.util import find_spec
from test.ros.harness import Client, free_map, grid_message, LATCHED, NodeProcess, pose, until

from hnr_planner.server.requests.outcomes import Outcome
from nav_msgs.msg import OccupancyGrid
import numpy as np
import pytest

START, GOAL = pose(0.5, 2.5), pose(2.5, 2.5)


def outcome(client: Client) -> Outcome:
    """Ask for a path and return how that ended."""
    return client.outcome_of(client.plan(START, GOAL))[0]


def zone(frame: str = 'map', value: int = 100) -> OccupancyGrid:
    """Return a mask with a zone of half a metre around the goal."""
    return grid_message(np.full((10, 10), value, np.int8), 0.05, (2.25, 2.25, 0.0), frame)


def test_mask_blocks_until_an_empty_one_comes(client: Client, planner: NodeProcess) -> None:
    client.publish_map(grid_message(free_map()))
    planner.wait_for('map received')
    masks = client.node.create_publisher(OccupancyGrid, '/keepout', LATCHED)
    assert outcome(client) is Outcome.SOLVED
    masks.publish(zone())
    planner.wait_for('keepout mask from keepout received')
    until(lambda: outcome(client) is Outcome.INVALID_GOAL, 'a zone')
    masks.publish(zone(frame='odom'))
    planner.wait_for("a keepout mask is in frame 'odom', the map in 'map'")
    assert outcome(client) is Outcome.INVALID_GOAL, 'the last good mask stays'
    path = client.plan(GOAL, START)
    assert float(client.outcome_of(path)[1]['escape']) > 0.2, 'a start inside is led out'
    masks.publish(zone(value=0))
    until(lambda: outcome(client) is Outcome.SOLVED, 'no zone')


@pytest.mark.skipif(find_spec('nav2_msgs') is None, reason='nav2_msgs comes with a ROS from apt')
def test_mask_of_a_filter_of_nav2_blocks(client: Client, planner: NodeProcess) -> None:
    from nav2_msgs.msg import CostmapFilterInfo

    masks = client.node.create_publisher(OccupancyGrid, '/filter_mask', LATCHED)
    masks.publish(zone())
    filters = client.node.create_publisher(CostmapFilterInfo, '/costmap_filter_info', LATCHED)
    wish = {'filter_mask_topic': '/filter_mask', 'base': 0.0, 'multiplier': 1.0}
    filters.publish(CostmapFilterInfo(type=1, **wish))
    planner.wait_for('it has type 1, and only keepout filters (0) are used')
    assert outcome(client) is Outcome.SOLVED
    filters.publish(CostmapFilterInfo(type=0, **wish))
    planner.wait_for('keepout mask from /filter_mask received')
    until(lambda: outcome(client) is Outcome.INVALID_GOAL, 'a zone')
