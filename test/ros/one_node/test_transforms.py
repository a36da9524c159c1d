"""Start and goal in other frames than the map's: brought there where tf2 is installed."""

from importlib.util import find_spec
import math
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
    yaws_of,
)
import time

from geometry_msgs.msg import PoseStamped, TransformStamped
from hnr_planner.server.requests.outcomes import Outcome
import numpy as np
import pytest

needs_tf = pytest.mark.skipif(
    not find_spec('tf2_ros'), reason='tf2_ros comes with a ROS from apt only'
)
START, GOAL = (0.5, 0.6), (4.5, 0.7)

#: Where the frame ``odom`` lies in the map.
SHIFT, TURN = (1.0, -2.0), 0.7


@pytest.fixture(scope='module', autouse=True)
def map_is_there(client: Client, planner: NodeProcess) -> None:
    """Publish the rooms."""
    client.publish_map(grid_message(two_rooms()))
    planner.wait_for('map received')


def in_odom(x: float, y: float, yaw: float = 0.0) -> PoseStamped:
    """Return the pose in ``odom`` that is at (x, y) and turned by ``yaw`` in the map."""
    dx, dy, cos, sin = x - SHIFT[0], y - SHIFT[1], math.cos(TURN), math.sin(TURN)
    return pose(cos * dx + sin * dy, -sin * dx + cos * dy, 'odom', yaw - TURN)


def transform(shift: tuple[float, float], turn: float, child: str) -> TransformStamped:
    """Return the transform of a frame in the map."""
    found = TransformStamped(child_frame_id=child)
    found.header.frame_id = 'map'
    found.transform.translation.x, found.transform.translation.y = shift
    found.transform.rotation.z, found.transform.rotation.w = np.sin(turn / 2), np.cos(turn / 2)
    return found


def test_frame_without_a_transform_is_refused_in_time_and_in_words(client: Client) -> None:
    for ends, name in (
        ((pose(1, 1, 'nowhere'), pose(*GOAL)), 'start'),
        ((pose(*START), pose(1, 1, 'nowhere')), 'goal'),
    ):
        path = client.plan(*ends)
        assert path.poses == [] and path.header.frame_id == 'map'
        outcome, values = client.outcome_of(path)
        assert outcome is Outcome.BAD_FRAME
        assert all(word in values['why'] for word in (f'the {name} is', "'nowhere'", "'map'"))
        assert float(values['elapsed']) < 0.3 + 5.0


@needs_tf
def test_poses_are_brought_into_the_map(client: Client) -> None:
    from tf2_msgs.msg import TFMessage

    static = client.node.create_publisher(TFMessage, '/tf_static', LATCHED)
    until(static.get_subscription_count, 'a subscription to transforms')
    static.publish(TFMessage(transforms=[transform(SHIFT, TURN, 'odom')]))

    def plans() -> bool:
        return bool(client.plan(in_odom(*START), pose(*GOAL)).poses)

    until(plans, 'a known transform')
    path = client.plan(in_odom(*START), in_odom(*GOAL, yaw=2.0))
    points = points_of(path)
    assert path.header.frame_id == 'map'
    assert points[0] == pytest.approx(START, abs=1e-9)
    assert points[-1] == pytest.approx(GOAL, abs=1e-9)
    assert yaws_of(path)[-1] == pytest.approx(2.0)
    outcome, values = client.outcome_of(path)
    assert outcome is Outcome.SOLVED and float(values['offset']) == 0.0


@needs_tf
def test_stamp_says_when_and_a_late_transform_is_waited_for(client: Client) -> None:
    from tf2_msgs.msg import TFMessage

    moving = client.node.create_publisher(TFMessage, '/tf', MANY)
    until(moving.get_subscription_count, 'a subscription to transforms')
    client.set_parameters(transform_tolerance=10.0, time_limit=20.0)
    for second, shift in ((100, (0.0, 0.0)), (200, (1.0, 0.0))):
        found = transform(shift, 0.0, 'base')
        found.header.stamp.sec = second
        moving.publish(TFMessage(transforms=[found]))
    start = pose(0.5, 0.6, 'base')
    start.header.stamp.sec = 150
    path = until(lambda: client.plan(start, pose(*GOAL)), 'an answer')
    assert points_of(path)[0] == pytest.approx((1.0, 0.6))
    start.header.stamp.sec = 0
    assert points_of(client.plan(start, pose(*GOAL)))[0] == pytest.approx((1.5, 0.6))

    start.header.stamp.sec = 300
    future = client.send_plan(start, pose(*GOAL))
    time.sleep(0.5)
    assert not future.done()
    late = transform((2.0, 0.0), 0.0, 'base')
    late.header.stamp.sec = 400
    moving.publish(TFMessage(transforms=[late]))
    until(future.done, 'the answer')
    assert points_of(future.result().plan)[0] == pytest.approx((2.0, 0.6))
    client.set_parameters(transform_tolerance=0.3, time_limit=1.0)
    start.header.stamp.sec = 500
    outcome, values = client.outcome_of(client.plan(start, pose(*GOAL)))
    assert outcome is Outcome.BAD_FRAME and '0.3 s' in values['why']
