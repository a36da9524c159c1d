"""Where maps come from: latched, late, volatile or lossy publishers."""

from collections.abc import Iterator
from test.ros.harness import Client, grid_message, LATCHED, NodeProcess, pose, two_rooms, until

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
