"""Requests for a robot with a footprint, held against an independent checker of its poses."""

from dataclasses import replace
import math
from test.pose_checker import orbit, PoseChecker
from test.server.test_requests import RESOLUTION, SETTINGS
import threading
from typing import Any

from hnr_planner.maps import OccupancyMap
from hnr_planner.server.geometry.orientations import quaternion_of, yaw_of
from hnr_planner.server.geometry.pose_motions import LARGEST_TURN, poses_of, twists_between
from hnr_planner.server.map.map_store import MapStore
from hnr_planner.server.parameters.arguments import pose_space_arguments
from hnr_planner.server.parameters.rules import SettingsError
from hnr_planner.server.parameters.settings import DEFAULTS, Settings
from hnr_planner.server.planning.respond import respond
from hnr_planner.server.requests.outcomes import Outcome
from hnr_planner.server.requests.plan_request import PlanRequest, Pose
from hnr_planner.server.responses.plan_response import PlanResponse
from hnr_planner.server.responses.shapes import search_shapes
from hnr_planner.server.sampling import draw
from hnr_planner.server.validity.path_monitor import PathMonitor
from hnr_planner.server.validity.path_validity import judge_path
import numpy as np
import pytest

pytestmark = pytest.mark.interpreted

#: A robot of .5 m by .4 m that turns about a point behind its middle.
VERTICES = ((0.3, 0.2), (0.3, -0.2), (-0.2, -0.2), (-0.2, 0.2))
FOOTPRINT = str([list(vertex) for vertex in VERTICES])
ROBOT = replace(SETTINGS, algorithm='auto', footprint=FOOTPRINT)
#: A robot whose largest disc does not fit through the door.
WIDE = '[[0.44, 0.44], [0.44, -0.44], [-0.44, -0.44], [-0.44, 0.44]]'
CAR = replace(ROBOT, drive='car', min_turning_radius=0.3)
#: Corner and yaw of the map, and the ends of a path through its door, all in the map frame.
ORIGIN = (1.0, -2.0, 0.4)


def at(x: float, y: float, yaw: float) -> tuple[float, float, float]:
    """Return a pose in the map frame, given in the frame of the map's corner."""
    cos, sin = math.cos(ORIGIN[2]), math.sin(ORIGIN[2])
    turned = (yaw + ORIGIN[2] + math.pi) % (2.0 * math.pi) - math.pi
    return ORIGIN[0] + cos * x - sin * y, ORIGIN[1] + sin * x + cos * y, turned


START, GOAL = at(0.5, 0.5, 0.0), at(3.5, 0.5, 1.5)


def rooms(door: int = 8) -> np.ndarray:
    """Return two rooms of 2 m x 2 m, and a door of a number of cells between them."""
    data = np.zeros((20, 40), dtype=np.int8)
    data[:, 19:21] = 100
    first = 10 - door // 2
    data[np.arange(first, first + door), 19:21] = 0
    return data


def store(settings: Settings, data: np.ndarray | None = None) -> MapStore:
    """Return a store that has received a map."""
    maps = MapStore(settings)
    receive(maps, rooms() if data is None else data)
    return maps


def receive(maps: MapStore, data: np.ndarray) -> None:
    """Let one more map arrive."""
    maps.receive(lambda: OccupancyMap(data, RESOLUTION, ORIGIN, 'map'))


def pose(x: float, y: float, yaw: float) -> Pose:
    """Return a pose as it is requested."""
    return Pose((x, y, 0.0), quaternion_of(yaw))


def ask(maps: Any, settings: Settings, goal: Any = GOAL, **changes: Any) -> PlanResponse:
    """Ask for a path; ``maps`` is a store, or a function that returns the newest map."""
    request = PlanRequest(pose(*START), pose(*goal), 0.0, settings.algorithm)
    newest = maps.newest if isinstance(maps, MapStore) else maps
    return respond(replace(request, **changes), settings, newest, threading.Event())


def checker(data: np.ndarray | None = None, vertices: Any = VERTICES) -> PoseChecker:
    """Return the independent checker for the robot on a map."""
    return PoseChecker((rooms() if data is None else data) > 0, RESOLUTION, ORIGIN, vertices)


def as_sent(response: PlanResponse) -> tuple[np.ndarray, np.ndarray]:
    """Return the poses (n, 3) that a client receives, and the twists that it infers (n - 1, 3)."""
    yaws = [yaw_of(tuple(row)) for row in response.poses[:, 3:].tolist()]
    poses = np.column_stack([response.poses[:, :2], yaws])
    return poses, twists_between(poses)


@pytest.fixture(scope='module')
def solved() -> PlanResponse:
    """Return the response to a request through the door, by a car."""
    return ask(store(CAR), CAR)


@pytest.mark.parametrize('spacing', [-1.0, 0.0, 0.3])
def test_poses_that_are_sent_are_a_free_path_by_themselves(spacing: float) -> None:
    settings = replace(CAR, pose_spacing=spacing)
    response = ask(store(settings), settings)
    assert response.outcome is Outcome.SOLVED, response.why
    poses, twists = as_sent(response)
    assert checker().collisions(poses, twists) == []
    np.testing.assert_allclose(poses[[0, -1]], [START, GOAL], atol=1e-12)
    # A car: no sideways motion, no arc tighter than its own.
    assert np.abs(twists[:, 1]).max() < 1e-9
    assert (np.abs(twists[:, 0]) >= 0.3 * np.abs(twists[:, 2]) - 1e-9).all()
    longest = {-1.0: RESOLUTION, 0.0: math.inf, 0.3: 0.3}[spacing]
    assert np.hypot(*twists[:, :2].T).max() <= longest + 1e-9
    assert np.abs(twists[:, 2]).max() <= min(longest, LARGEST_TURN) + 1e-9
    assert response.clearance >= 0.0 and response.offset == 0.0


def test_a_robot_that_may_not_reverse_drives_ahead() -> None:
    settings = replace(ROBOT, reverse=False, robot_radius=0.4)
    response = ask(store(settings), settings)
    poses, twists = as_sent(response)
    assert checker().collisions(poses, twists) == []
    assert twists[:, 0].min() >= -1e-12


def test_path_through_poses_has_the_heading_of_each() -> None:
    middle = at(1.1, 1.2, -1.0)
    response = ask(store(ROBOT), ROBOT, via=(pose(*middle),))
    assert response.outcome is Outcome.SOLVED, response.why
    poses, twists = as_sent(response)
    assert checker().collisions(poses, twists) == []
    assert np.abs(poses - middle).max(axis=1).min() < 1e-9
    assert response.motions[1].shape == (len(response.path) - 1, 3)


def test_goal_that_is_not_free_gives_way_to_the_nearest_with_its_heading() -> None:
    # The robot reaches .3 m ahead, and the wall of the map is 2 m ahead of its other side.
    goal = at(3.5, 1.75, math.pi / 2.0)
    refused = ask(store(ROBOT), ROBOT, goal)
    assert refused.outcome is Outcome.INVALID_GOAL
    response = ask(store(ROBOT), ROBOT, goal, tolerance=0.3)
    poses, twists = as_sent(response)
    assert checker().collisions(poses, twists) == []
    assert poses[-1, 2] == pytest.approx(goal[2])
    assert 0.05 < response.offset <= 0.05 + RESOLUTION
    assert 'the goal was moved by' in response.why
    near = np.linspace(0.0, 0.049, 5)[:, np.newaxis] * np.array([[-ORIGIN[2], 1.0, 0.0]])
    assert not checker().is_free(np.array(goal) + near).any()
    far = ask(store(ROBOT, rooms(door=2)), ROBOT, tolerance=0.2)
    assert far.outcome is Outcome.UNREACHABLE
    assert 'no pose with this heading within 0.2 m' in far.why


def test_heading_tolerance_lets_the_robot_end_turned() -> None:
    goal = at(3.5, 1.75, math.pi / 2.0)  # nothing is in the way of the other headings
    settings = replace(ROBOT, heading_tolerance=math.pi)
    response = ask(store(settings), settings, goal)
    poses, twists = as_sent(response)
    assert checker().collisions(poses, twists) == []
    np.testing.assert_allclose(poses[-1, :2], goal[:2])


@pytest.mark.parametrize(
    ('changes', 'words'),
    [
        ({'clearance': 0.2}, 'clearance has no meaning with a footprint'),
        ({'alternatives': 2}, 'alternatives has no meaning'),
        ({'roadmap': True}, 'roadmap has no meaning'),
        ({'keep_route': 0.1}, 'keep_route has no meaning'),
        ({'escape_radius': 0.3}, 'escape_radius has no meaning'),
        ({'any_order': True}, 'any_order has no meaning'),
        ({'occupied_threshold': 99}, 'occupied_threshold must not be 99 with a footprint'),
        ({'algorithm': 'polyanya'}, 'algorithm must be one of'),
        ({'drive': 'car'}, 'min_turning_radius must be above 0 for a car'),
        ({'min_turning_radius': 1.0}, 'min_turning_radius must be 0 for a differential drive'),
        ({'footprint': '[[3, 3], [-3, 3], [-3, -3], [3, -3]]'}, 'must fit into the map'),
    ],
)
def test_what_has_no_meaning_is_refused_with_the_reason(
    changes: dict[str, Any], words: str
) -> None:
    settings = replace(ROBOT, **changes)
    response = ask(store(settings), settings)
    assert response.outcome is Outcome.BAD_REQUEST
    assert words in response.why


def test_motions_draws_and_orientations_that_are_none_are_refused() -> None:
    maps = store(ROBOT)
    inertia = ask(maps, ROBOT, algorithm='kinodynamic_connect')
    assert inertia.outcome is Outcome.BAD_REQUEST and 'footprint must be []' in inertia.why
    nowhere = Pose((*START[:2], 0.0), (0.0, 0.0, 0.0, 0.0))
    response = ask(maps, ROBOT, start=nowhere)
    assert response.outcome is Outcome.BAD_REQUEST
    assert 'the orientation of the start must be a quaternion' in response.why
    drawn = draw(ROBOT, maps.newest, threading.Event())
    assert drawn.outcome is Outcome.BAD_REQUEST and 'footprint must be []' in drawn.why


@pytest.mark.parametrize(
    ('footprint', 'words'),
    [
        ('[[0, 0], [1, 0]]', 'k >= 3'),
        ('[[0, 0], [1, 1], [1, 0], [0, 1]]', 'must not cross or touch itself'),
        ('[0.3, 0.2, 0.1]', 'footprint must be [] or the points'),
        ('a rectangle', 'footprint must be [] or the points'),
        ('[[0, 0], [1, 0], [0, 1e999]]', 'must be finite'),
    ],
)
def test_text_of_no_polygon_is_refused_when_it_is_set(footprint: str, words: str) -> None:
    with pytest.raises(SettingsError) as refusal:
        replace(DEFAULTS, footprint=footprint)
    assert words in str(refusal.value)


def test_a_robot_without_a_footprint_is_a_circle() -> None:
    for footprint in ('[]', '', ' [] '):
        settings = replace(SETTINGS, footprint=footprint, drive='car')
        assert settings.vertices == () and pose_space_arguments(settings) is None
        assert store(settings).newest().pose_space is None
    assert ROBOT.vertices == VERTICES


def test_changed_footprint_holds_from_the_next_request_on(solved: PlanResponse) -> None:
    maps, wide = (
        store(CAR),
        replace(CAR, footprint=WIDE),
    )
    assert maps.use(wide) is not None
    assert ask(maps, wide).outcome is Outcome.UNREACHABLE
    # What describes no robot is refused, and the map is kept for what does.
    broken = replace(CAR, min_turning_radius=0.0)
    maps.use(broken)
    assert ask(maps, broken).outcome is Outcome.BAD_REQUEST
    maps.use(CAR)
    again = ask(maps, CAR)
    np.testing.assert_array_equal(again.poses, solved.poses)
    circle = replace(CAR, footprint='[]')
    maps.use(circle)
    response = ask(maps, circle)
    assert response.outcome is Outcome.SOLVED and response.path.shape[1] == 2


def test_path_is_found_anew_when_a_newer_map_blocks_only_the_sweep(solved: PlanResponse) -> None:
    data = rooms()
    swept = as_sent(solved)[0]
    row, column = _beside(swept)
    data[row, column] = 100
    maps = store(CAR)
    seen: list[int] = []

    def newest() -> Any:
        if seen:
            receive(maps, data)
        seen.append(0)
        return maps.newest()

    response = ask(newest, CAR)
    poses, twists = as_sent(response)
    assert checker(data).collisions(poses, twists) == []
    assert checker(data).collisions(*as_sent(solved)) != []


def _beside(poses: np.ndarray) -> tuple[int, int]:
    """
    Return a cell that the footprint sweeps, but on which no position of the path lies.

    It is near the start, where there is room to drive around it.
    """
    away_from_start = np.hypot(*(poses[:, :2] - poses[0, :2]).T)
    x, y, yaw = poses[np.argmax(away_from_start > 0.35)]
    side = np.array([math.cos(yaw), math.sin(yaw)]) * 0.25
    away = np.array([x, y]) + side + 0.12 * np.array([-math.sin(yaw), math.cos(yaw)])
    cells = _cells(np.vstack([away, poses[:, :2]]))
    assert not (cells[1:] == cells[0]).all(axis=1).any()
    return int(cells[0, 1]), int(cells[0, 0])


def _cells(points: np.ndarray) -> np.ndarray:
    """Return the cells (column, row) of points (n, 2) in the map frame."""
    cos, sin = math.cos(ORIGIN[2]), math.sin(ORIGIN[2])
    local = (points - ORIGIN[:2]) @ np.array([[cos, -sin], [sin, cos]])
    return np.floor(local / RESOLUTION).astype(int)


def test_monitor_reports_the_pose_at_which_the_footprint_meets_an_obstacle(
    solved: PlanResponse,
) -> None:
    maps, reports = store(CAR), []
    monitor = PathMonitor(maps.newest, lambda *report: reports.append(report))
    monitor.follow(solved)
    data = rooms()
    data[_beside(as_sent(solved)[0])] = 100
    receive(maps, data)
    monitor.check()
    valid, _, changed = reports[-1]
    assert not valid and changed is not None and changed.blocked is not None
    assert checker(data).distances([changed.blocked])[0] < 1e-6  # it touches, and no more
    receive(maps, rooms())
    monitor.check()
    assert reports[-1][0]
    # A wider robot does not fit through where the path leads; a circle of radius 0 does.
    for footprint, fits in ((WIDE, False), ('[]', True)):
        maps.use(replace(CAR, footprint=footprint))
        monitor.check()
        assert reports[-1][0] is fits


def test_a_path_of_a_client_is_judged_by_the_sweep_between_its_poses() -> None:
    """Both poses are free, and the corner of the footprint passes a post when it turns."""
    maps = store(ROBOT)
    ends = np.array([at(1.0, 0.98, 0.0), at(1.0, 0.98, 1.4), at(0.966, 0.783, 1.4)])
    assert judge_path(ends, 'map', maps.newest(), None).why == ''
    data = rooms()
    data[13, 10] = 100
    receive(maps, data)
    poses = checker(data)
    assert poses.is_free(ends).all() and poses.collisions(ends, twists_between(ends)) != []
    verdict = judge_path(ends, 'map', maps.newest(), None)
    assert verdict.blocked == [1] and 'motion of the footprint' in verdict.why
    ends[1, 2] = math.nan
    assert judge_path(ends, 'map', maps.newest(), None).blocked == [1]


def test_twist_between_two_poses_leads_from_one_to_the_other() -> None:
    rng = np.random.default_rng(5)
    for _ in range(200):
        begin, twist = rng.uniform(-3.0, 3.0, 3), rng.uniform(-1.0, 1.0, 3) * (2.0, 2.0, 3.14)
        twist *= rng.integers(0, 2, 3)
        twist[2] *= 10.0 ** -float(rng.integers(0, 18))  # rounding turns straight lines so little
        end = orbit(begin, twist, [1.0])[0]
        np.testing.assert_allclose(twists_between(np.array([begin, end])), [twist], atol=1e-9)


def test_quaternions_of_any_norm_are_poses() -> None:
    rows = np.zeros((3, 7))
    rows[:, 3:] = [(0, 0, 2 * math.sin(0.4), 2 * math.cos(0.4)), (0, 0, 0, 0), (0, 0, 0, math.nan)]
    np.testing.assert_allclose(poses_of(rows)[:, 2], [0.8, math.nan, math.nan])


def test_zone_holds_for_the_whole_footprint() -> None:
    maps = store(ROBOT)
    mask = np.zeros((20, 40), dtype=np.int8)
    mask[5:, 38:] = 100
    maps.receive_mask('keepout', lambda: OccupancyMap(mask, RESOLUTION, ORIGIN, 'map'))
    goal = at(3.7, 1.0, math.pi / 2.0)
    assert checker(mask).distances([goal])[0] == 0.0 and not mask[10, 37]
    response = ask(maps, ROBOT, goal)
    assert response.outcome is Outcome.INVALID_GOAL
    assert response.why.endswith('the goal is in a keepout zone')
    free = ask(maps, ROBOT)
    assert checker(np.maximum(mask, rooms())).collisions(*as_sent(free)) == []


def test_markers_show_footprints_on_the_path(solved: PlanResponse) -> None:
    shapes = {shape.name: shape for shape in search_shapes(solved)}
    sides = shapes['footprint'].points.reshape(-1, len(VERTICES), 2, 2)
    np.testing.assert_array_equal(np.roll(sides[:, :, 0], -1, axis=1), sides[:, :, 1])
    first, *_, last = sides[:, :, 0]
    expected = checker().polygons([START, GOAL])
    for outline, polygon in zip((first, last), expected, strict=True):
        corners = np.array(polygon.exterior.coords)[:-1]
        apart = np.hypot(*(outline[:, np.newaxis] - corners).T)
        assert apart.min(axis=0).max() < 1e-9
    assert all(shape.points.shape[1] == 2 for shape in shapes.values())
    assert 'footprint' not in {
        shape.name for shape in search_shapes(replace(solved, snapshot=None))
    }
