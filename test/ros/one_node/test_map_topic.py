"""Where maps come from: latched, late, volatile or lossy publishers."""

from array import array
from collections.abc import Iterator
from importlib.util import find_spec
import math
from test.brute_force import path_collisions
from test.ros.harness import (
    Client,
    grid_message,
    LATCHED,
    MANY,
    NodeProcess,
    points_of,
    pose,
    two_rooms,
    until,
)
import time

from diagnostic_msgs.msg import DiagnosticArray
from hnr_planner.server.requests.outcomes import Outcome
from nav_msgs.msg import OccupancyGrid
import pytest
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

VOLATILE, TRANSIENT_LOCAL = DurabilityPolicy.VOLATILE, DurabilityPolicy.TRANSIENT_LOCAL
RELIABLE, BEST_EFFORT = ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT


@pytest.fixture
def client(planner: NodeProcess) -> Iterator[Client]:
    """Return a client without a publisher of maps of its own."""
    client = Client()
    client.node.destroy_publisher(client._map_publisher)
    yield client
    client.close()


def offer(
    client: Client, durability: DurabilityPolicy, reliability: ReliabilityPolicy
) -> Publisher:
    """Return a publisher of maps."""
    profile = QoSProfile(depth=1, durability=durability, reliability=reliability)
    return client.node.create_publisher(OccupancyGrid, '/map', profile)


def assert_arrives(
    publisher: Publisher, planner: NodeProcess, resolution: float, *, once: bool
) -> None:
    """Publish a map, known by its resolution, and wait until the node has it."""
    words = 'received and prepared in'
    assert f'of {resolution:g} m' not in planner.log
    message = grid_message(two_rooms(), resolution)
    publisher.publish(message)

    def arrived() -> bool:
        if not once:
            publisher.publish(message)
        return any(
            words in line and f'of {resolution:g} m' in line for line in planner.log.splitlines()
        )

    until(arrived, f'the map of {resolution} m')


@pytest.mark.parametrize(
    ('durability', 'reliability', 'resolution', 'words'),
    [
        (VOLATILE, RELIABLE, 0.061, 'reliable and volatile'),
        (TRANSIENT_LOCAL, BEST_EFFORT, 0.062, 'best effort'),
        (VOLATILE, BEST_EFFORT, 0.063, 'best effort and volatile'),
    ],
)
def test_publisher_that_offers_less_is_named_and_heard(
    client: Client,
    planner: NodeProcess,
    durability: DurabilityPolicy,
    reliability: ReliabilityPolicy,
    resolution: float,
    words: str,
) -> None:
    logged = len(planner.log)
    publisher = offer(client, durability, reliability)
    until(lambda: publisher.get_subscription_count() == 1, 'the new subscription')
    assert_arrives(publisher, planner, resolution, once=reliability == RELIABLE)
    warnings = [line for line in planner.log[logged:].splitlines() if '[WARN]' in line]
    assert any('offers less' in line and words in line for line in warnings), warnings
    client.node.destroy_publisher(publisher)
    # A publisher that offers all gets the subscription that was wished, with its latched map.
    latched = client.node.create_publisher(OccupancyGrid, '/map', LATCHED)
    assert_arrives(latched, planner, resolution + 0.01, once=True)
    until(lambda: 'that way again' in planner.log[logged:], 'the subscription that was wished')
    client.node.destroy_publisher(latched)


def test_map_published_before_the_node_starts_is_received(
    client: Client, planner: NodeProcess
) -> None:
    """A latched map, and the one subscription: the map comes once."""
    publisher = client.node.create_publisher(OccupancyGrid, '/map', LATCHED)
    assert_arrives(publisher, planner, 0.075, once=True)
    assert planner.log.count('of 0.075 m') == 1
    assert len(client.plan(pose(0.5, 0.6), pose(6.0, 0.7)).poses) > 2


def arrived(planner: NodeProcess, words: str) -> None:
    """Wait until the node has a map that it describes so."""
    until(lambda: any(words in line for line in planner.log.splitlines()), f'a map of {words}')


def test_maps_grow_shrink_move_and_turn(client: Client, planner: NodeProcess) -> None:
    """The same two places in the first room, wherever the map puts it."""
    publisher = client.node.create_publisher(OccupancyGrid, '/map', LATCHED)
    until(publisher.get_subscription_count, 'a subscription')
    for number, (shape, origin) in enumerate(PLACES):
        data, resolution = two_rooms(*shape), 0.081 + 0.001 * number
        publisher.publish(grid_message(data, resolution, origin))
        arrived(planner, f'{shape[1]} x {shape[0]} cells of {resolution:g} m')
        cos, sin = math.cos(origin[2]), math.sin(origin[2])
        ends = [
            (origin[0] + cos * x - sin * y, origin[1] + sin * x + cos * y)
            for x, y in ((0.5, 0.6), (resolution * (shape[1] - 2), 0.7))
        ]
        path = points_of(client.plan(*(pose(*end) for end in ends)))
        assert len(path) > 2
        assert path_collisions(path, data >= 65, resolution, origin) == []
    client.node.destroy_publisher(publisher)


#: Shapes and origins of maps that come one after the other.
PLACES = (
    ((60, 80), (0.0, 0.0, 0.0)),
    ((200, 160), (0.0, 0.0, 0.0)),
    ((40, 50), (-7.0, 3.0, 0.0)),
    ((40, 50), (-7.0, 3.0, 2.5)),
    ((90, 50), (1e4, -1e4, -1.2)),
)


def test_same_map_again_is_not_prepared_again_but_is_young(
    client: Client, planner: NodeProcess
) -> None:
    publisher = client.node.create_publisher(OccupancyGrid, '/map', LATCHED)
    until(publisher.get_subscription_count, 'a subscription')
    message = grid_message(two_rooms(), 0.091)
    publisher.publish(message)
    arrived(planner, 'of 0.091 m')
    health = client.listen(DiagnosticArray, '/diagnostics', MANY)

    def age() -> float:
        values = {item.key: item.value for item in health[-1].status[0].values}
        return float(values.get('map_age', 0.0))

    until(lambda: health and age() > 1.5, 'a map that gets old')
    publisher.publish(message)
    until(lambda: age() < 1.5, 'a young map')
    assert planner.log.count('of 0.091 m') == 1
    client.node.destroy_publisher(publisher)


def test_updates_of_parts_are_used_or_warned_of(client: Client, planner: NodeProcess) -> None:
    if find_spec('map_msgs') is None:
        # Any type will do: without map_msgs only the topic's name says what comes.
        client.node.create_publisher(OccupancyGrid, '/map_updates', MANY)
        planner.wait_for('always_send_full_costmap')
        time.sleep(2.5)
        assert planner.log.count('always_send_full_costmap') == 1
        return
    from map_msgs.msg import OccupancyGridUpdate

    publisher = client.node.create_publisher(OccupancyGrid, '/map', LATCHED)
    parts = client.node.create_publisher(OccupancyGridUpdate, '/map_updates', MANY)
    until(publisher.get_subscription_count, 'a subscription')
    until(parts.get_subscription_count, 'a subscription to updates')
    publisher.publish(grid_message(two_rooms(), 0.092))
    arrived(planner, 'of 0.092 m')
    ends = pose(0.5, 0.6), pose(8.5, 0.7)
    assert len(client.plan(*ends).poses) > 2
    door = OccupancyGridUpdate(x=49, y=40, width=2, height=20)
    door.data = array('b', [100] * 40)
    parts.publish(door)
    until(lambda: planner.log.count('of 0.092 m') == 2, 'the closed door')
    assert client.outcome_of(client.plan(*ends))[0] is Outcome.UNREACHABLE
    for bad, words in (
        (OccupancyGridUpdate(x=99, y=0, width=2, height=1), 'not inside the map'),
        (OccupancyGridUpdate(x=0, y=-1, width=1, height=1), 'not inside the map'),
        (OccupancyGridUpdate(x=0, y=0, width=2, height=2), 'has 0 values'),
    ):
        parts.publish(bad)
        planner.wait_for(words)
    door.data = array('b', [0] * 40)
    parts.publish(door)
    until(lambda: planner.log.count('of 0.092 m') == 3, 'the open door')
    assert len(client.plan(*ends).poses) > 2
    for used in (publisher, parts):
        client.node.destroy_publisher(used)
