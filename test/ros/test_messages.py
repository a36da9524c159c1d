"""Messages to and from arrays, without a node."""

from dataclasses import replace
from itertools import product
import math
from test.ros.harness import points_in, set_field

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Quaternion, Transform, Vector3
from hnr_planner.core import GridSpace, plan, PlanResult
from hnr_planner.core.systems import DoubleIntegrator, Trajectory
from hnr_planner.maps import OccupancyMap
from hnr_planner.ros.messages.cdr import with_elements
from hnr_planner.ros.messages.maps import map_from_message, message_from_map
from hnr_planner.ros.messages.markers import serialised_markers
from hnr_planner.ros.messages.paths import path_message, serialised_path
from hnr_planner.ros.messages.plan_responses import PlanResponses
from hnr_planner.ros.messages.samples import LAYOUT, serialised_samples
from hnr_planner.ros.messages.trajectories import serialised_trajectory
from hnr_planner.server.map.map_store import MapSnapshot
from hnr_planner.server.map.received_maps import as_written, MapError
from hnr_planner.server.requests.outcomes import Outcome
from hnr_planner.server.requests.plan_request import PlanRequest, Pose
from hnr_planner.server.responses.plan_response import PlanResponse
from hnr_planner.server.responses.shapes import MOST_POINTS
from nav_msgs.msg import OccupancyGrid
from nav_msgs.msg import Path as PathMessage
from nav_msgs.srv import GetPlan
import numpy as np
import pytest
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import MultiDOFJointState, PointCloud2
from std_msgs.msg import Header
from trajectory_msgs.msg import MultiDOFJointTrajectory
from visualization_msgs.msg import Marker, MarkerArray

STAMP = Time(sec=12, nanosec=34)
HEADER = Header(stamp=STAMP, frame_id='map')
DATA = np.arange(-1, 5, dtype=np.int8).reshape(2, 3)


def message(**changes: object) -> OccupancyGrid:
    """Return a good map message, with some fields changed."""
    result = message_from_map(OccupancyMap(DATA, 0.05, (1.0, -2.0, 0.5), 'floor'), STAMP)
    for name, value in changes.items():
        set_field(result, name.replace('__', '.'), value)
    return result


def test_map_survives_the_way_there_and_back() -> None:
    grid = map_from_message(message())
    assert np.array_equal(grid.data, DATA)
    assert grid.data.dtype == np.int8
    assert grid.resolution == 0.05
    assert grid.origin == pytest.approx((1.0, -2.0, 0.5), abs=1e-15)
    assert grid.frame == 'floor'


@pytest.mark.parametrize('resolution', [0.05, 0.1, 0.025, 1.0, 0.03, 1e-4, 12.5, 1000.0])
def test_resolution_is_read_as_it_was_written(resolution: float) -> None:
    assert as_written(float(np.float32(resolution))) == resolution
    assert map_from_message(message(info__resolution=resolution)).resolution == resolution


BAD_MAPS = {
    'no cells': {'info__width': 0},
    'width 3 x height 3': {'info__height': 3},
    r'resolution must be in 0.0001\.\.1000 m, got 0': {'info__resolution': 0.0},
    'got -0.05': {'info__resolution': -0.05},
    'got nan m': {'info__resolution': math.nan},
    'got inf m': {'info__resolution': math.inf},
    'got 1e-45 m': {'info__resolution': 1e-45},
    'got 9.9e-05 m': {'info__resolution': 9.9e-5},
    'got 1001.0 m': {'info__resolution': 1001.0},
    r'\(nan, -2': {'info__origin__position__x': math.nan},
    r'-2.0, nan\)': {'info__origin__position__z': math.nan},
    r'\(1.0, inf': {'info__origin__position__y': math.inf},
    'norm above 0, got .*nan': {'info__origin__orientation__z': math.nan},
    r'norm above 0, got \[nan': {'info__origin__orientation__x': math.nan},
    'level': {'info__origin__orientation__x': 0.5},
}


@pytest.mark.parametrize(('words', 'changes'), BAD_MAPS.items())
def test_impossible_map_is_refused_with_the_value(words: str, changes: dict) -> None:
    with pytest.raises(MapError, match=words):
        map_from_message(message(**changes))


def test_origin_without_orientation_is_refused() -> None:
    bad = message(info__origin__orientation__z=0.0, info__origin__orientation__w=0.0)
    with pytest.raises(MapError, match='norm above 0'):
        map_from_message(bad)


def test_yaw_of_an_origin_of_any_norm_is_read() -> None:
    scaled = message(
        info__origin__orientation__z=7.0 * math.sin(0.25),
        info__origin__orientation__w=7.0 * math.cos(0.25),
    )
    assert map_from_message(scaled).origin[2] == pytest.approx(0.5)


def response_on_a_map() -> PlanResponse:
    """Return a solved request with a tree of some size."""
    data = np.zeros((60, 60), dtype=np.int8)
    data[5:55, 20] = data[5:55, 40] = 100
    grid = OccupancyMap(data, 0.1, (3.0, 4.0, 0.3), 'map')
    space = GridSpace.from_occupancy(data, grid.resolution, grid.origin)
    start, goal = space.cell_centres(np.array([30, 30]), np.array([5, 55]))
    result = plan(space, start, goal, algorithm='rrt', seed=1, simplify=False)
    request = PlanRequest(Pose((*start, 0.0)), Pose((*goal, 0.0)), 0.0, 'rrt')
    return PlanResponse(
        Outcome[result.status.name], '', request, result, snapshot=MapSnapshot(space, grid, 1)
    )


def test_cloud_holds_samples_and_parents_of_the_result() -> None:
    result = response_on_a_map().result
    assert result is not None and len(result.samples) > 10
    cloud = deserialize_message(serialised_samples(result, 100_000, HEADER), PointCloud2)
    points = points_in(cloud)
    assert cloud.header == HEADER
    assert (cloud.height, cloud.width) == (1, len(result.samples))
    assert cloud.row_step == cloud.width * cloud.point_step == len(cloud.data)
    assert np.array_equal(
        np.stack([points['x'], points['y']], 1), result.samples.astype(np.float32)
    )
    assert np.array_equal(points['index'], np.arange(len(points)))
    assert np.array_equal(points['parent'], result.parents)
    assert not points['z'].any()


def test_capped_cloud_refers_to_its_own_points() -> None:
    result = response_on_a_map().result
    assert result is not None
    points = points_in(deserialize_message(serialised_samples(result, 9, HEADER), PointCloud2))
    assert len(points) == 9
    # By place, since vertices of RRT at a wall may coincide in single precision.
    samples = [tuple(xy) for xy in result.samples.astype(np.float32).tolist()]
    edges = {
        (xy, samples[parent] if parent >= 0 else None)
        for xy, parent in zip(samples, result.parents, strict=True)
    }
    shown = [tuple(xy) for xy in np.stack([points['x'], points['y']], axis=1).tolist()]
    for xy, parent in zip(shown, points['parent'], strict=True):
        assert (xy, shown[parent] if parent >= 0 else None) in edges


#: Names of all lengths modulo eight: what follows them in a message moves with them.
FRAMES = ['', 'a', 'ab', 'map', 'odom', 'floor', 'world', 'robot_1/map', 'карта']


def test_cloud_is_one_that_rclpy_would_send() -> None:
    found = response_on_a_map().result
    assert found is not None
    for frame, result, limit in product(FRAMES, (None, found), (0, 1, 2, 9)):
        header = Header(stamp=STAMP, frame_id=frame)
        data = serialised_samples(result, limit, header)
        cloud = deserialize_message(data, PointCloud2)
        assert len(serialize_message(cloud)) == len(data)  # padding may differ
        assert cloud.header == header and cloud.is_dense and not cloud.is_bigendian
        assert cloud.point_step == LAYOUT.itemsize
        assert cloud.width == len(points_in(cloud)) == (0 if result is None else limit)


@pytest.mark.parametrize('frame', FRAMES)
@pytest.mark.parametrize('n_poses', [0, 2, 3, 500])
def test_path_from_arrays_is_the_path_of_the_answer(frame: str, n_poses: int) -> None:
    rows = np.random.default_rng(n_poses).normal(size=(n_poses, 7))
    header = Header(stamp=STAMP, frame_id=frame)
    expected = path_message(rows, header)
    path = deserialize_message(serialised_path(rows, header), PathMessage)
    assert path == expected
    assert len(path.poses) == n_poses
    for pose, row in zip(path.poses, rows.tolist(), strict=True):
        place, turn = pose.pose.position, pose.pose.orientation
        assert [place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w] == row


@pytest.mark.parametrize('frame', FRAMES)
@pytest.mark.parametrize('n_poses', [0, 2, 3, 500])
def test_response_from_bytes_is_the_ordinary_one(frame: str, n_poses: int) -> None:
    rows = np.random.default_rng(n_poses).normal(size=(n_poses, 7))
    header = Header(stamp=STAMP, frame_id=frame)
    responses = PlanResponses()
    assert responses.why_slow == ''
    made = responses.make(rows, header, serialised_path(rows, header))
    assert isinstance(made, GetPlan.Response) and made.plan.poses == [], 'no object for a pose'
    sent = deserialize_message(serialize_message(made), GetPlan.Response)
    assert sent == GetPlan.Response(plan=path_message(rows, header))


@pytest.mark.parametrize('n_elements', [0, 1, 2, 3, 50])
def test_sequence_amid_a_message_is_spliced_in(n_elements: int) -> None:
    rows = np.random.default_rng(n_elements).normal(size=(n_elements, 7))

    def joints(count: int) -> MultiDOFJointState:
        poses = [
            Transform(
                translation=Vector3(**dict(zip('xyz', row[:3], strict=True))),
                rotation=Quaternion(**dict(zip('xyzw', row[3:], strict=True))),
            )
            for row in rows[:count].tolist()
        ]
        return MultiDOFJointState(header=HEADER, joint_names=['a', 'bc'], transforms=poses)

    short = [serialize_message(joints(count)) for count in range(3)]
    # Two empty sequences follow, each of which is its length.
    spliced = with_elements(short, [(56, rows)], n_after=8)
    assert deserialize_message(spliced, MultiDOFJointState) == joints(n_elements)


def test_response_is_the_ordinary_one_where_bytes_do_not_work() -> None:
    responses = PlanResponses()
    responses.why_slow = 'another rclpy'
    rows = np.random.default_rng(0).normal(size=(3, 7))
    made = responses.make(rows, HEADER, serialised_path(rows, HEADER))
    assert made.plan == path_message(rows, HEADER)


def trajectory(n_points: int) -> Trajectory:
    """Return a trajectory with some random points; the first ones are at rest."""
    rng = np.random.default_rng(n_points)
    states = rng.normal(size=(n_points, 4))
    states[:2, 2:] = 0.0
    return Trajectory(
        DoubleIntegrator(dim=2),
        np.cumsum(rng.random(n_points)),
        states,
        rng.normal(size=(n_points - 1, 2)),
    )


@pytest.mark.parametrize('frame', FRAMES)
@pytest.mark.parametrize('n_points', [2, 3, 50])
def test_trajectory_has_a_point_for_each_state(frame: str, n_points: int) -> None:
    made, header = trajectory(n_points), Header(stamp=STAMP, frame_id=frame)
    message = deserialize_message(serialised_trajectory(made, header), MultiDOFJointTrajectory)
    assert message.header == header and message.joint_names == ['base']
    assert len(message.points) == n_points
    for k, point in enumerate(message.points):
        (place,), (speed,), (pull,) = point.transforms, point.velocities, point.accelerations
        state = [place.translation.x, place.translation.y, speed.linear.x, speed.linear.y]
        assert state == made.states[k].tolist()
        control = made.controls[k] if k < n_points - 1 else np.zeros(2)
        assert [pull.linear.x, pull.linear.y] == control.tolist()
        time = point.time_from_start
        assert time.sec + 1e-9 * time.nanosec == pytest.approx(made.times[k], abs=1e-9)
        way = made.states[k, 2:] if k >= 2 else control
        if way.any():
            yaw = 2.0 * math.atan2(place.rotation.z, place.rotation.w)
            assert math.cos(yaw - math.atan2(way[1], way[0])) == pytest.approx(1.0)


def test_no_trajectory_has_no_points() -> None:
    message = deserialize_message(serialised_trajectory(None, HEADER), MultiDOFJointTrajectory)
    assert message.points == [] and message.header == HEADER


@pytest.mark.parametrize('frame', FRAMES)
def test_markers_are_whole_in_every_frame(frame: str) -> None:
    response = response_on_a_map()
    header = Header(stamp=STAMP, frame_id=frame)
    shapes = markers_of(response, header)
    assert all(shape.header == header for shape in shapes)
    assert [shape.points for shape in shapes] == [
        shape.points for shape in markers_of(response, HEADER)
    ]
    assert [shape.scale for shape in shapes] == [
        shape.scale for shape in markers_of(response, HEADER)
    ]


def points_of(marker: Marker) -> np.ndarray:
    """Return the points (n, 2) of a marker."""
    return np.array([(point.x, point.y) for point in marker.points])


def markers_of(response: PlanResponse, header: Header = HEADER) -> list[Marker]:
    """Return the markers of a response as a subscriber gets them."""
    return deserialize_message(serialised_markers(response, header), MarkerArray).markers


def test_markers_show_samples_tree_path_and_ends() -> None:
    response = response_on_a_map()
    assert response.result is not None
    first, *shapes = markers_of(response)
    assert first.action == Marker.DELETEALL
    by_name = {shape.ns: shape for shape in shapes}
    assert {name: shape.type for name, shape in by_name.items()} == {
        'samples': Marker.POINTS,
        'tree': Marker.LINE_LIST,
        'path': Marker.LINE_STRIP,
        'start': Marker.SPHERE,
        'goal': Marker.SPHERE,
    }
    assert len(by_name['samples'].points) == len(response.result.samples)
    assert len(by_name['tree'].points) == 2 * (len(response.result.samples) - 1)
    assert len(by_name['path'].points) == len(response.path)
    assert points_of(by_name['path']).tolist() == response.path.tolist()
    assert by_name['goal'].pose.position.x == response.path[-1][0]
    assert all(shape.header.stamp == STAMP for shape in (first, *shapes))


def test_markers_show_the_segments_of_all_alternatives() -> None:
    response = response_on_a_map()
    assert isinstance(response.result, PlanResult)
    others = tuple(np.random.default_rng(0).normal(size=(n, 2)) for n in (3, 2))
    response = replace(response, result=replace(response.result, others=others))
    (marker,) = (one for one in markers_of(response) if one.ns == 'alternatives')
    assert marker.type == Marker.LINE_LIST
    segments = [[*others[0][:2]], [*others[0][1:]], [*others[1]]]
    assert np.array_equal(points_of(marker), np.vstack(segments))


def test_markers_are_capped() -> None:
    response = response_on_a_map()
    assert response.result is not None
    chain = np.linspace((3.0, 4.0), (4.0, 5.0), 3 * MOST_POINTS)
    parents = np.arange(-1, len(chain) - 1)
    result = replace(response.result, samples=chain, parents=parents, path=chain)
    response = replace(response, result=result)
    sizes = {shape.ns: len(shape.points) for shape in markers_of(response)}
    assert sizes['samples'] == sizes['path'] == MOST_POINTS
    assert MOST_POINTS - 2 <= sizes['tree'] <= MOST_POINTS


def test_markers_are_cleared_after_a_failure() -> None:
    request = PlanRequest(Pose((0.0, 0.0, 0.0)), Pose((1.0, 1.0, 0.0)), 0.0, 'rrt')
    markers = markers_of(PlanResponse(Outcome.TIMEOUT, '', request))
    assert [marker.action for marker in markers] == [Marker.DELETEALL]
