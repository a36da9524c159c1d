"""What turns a request into an answer: no ROS here, but real spaces and real searches."""

from collections.abc import Callable
from dataclasses import replace
import math
from test.brute_force import path_collisions
import threading
import time

from hnr_planner.core import ALGORITHMS
from hnr_planner.maps import OccupancyMap
from hnr_planner.server.map.map_store import MapSnapshot, MapStore
from hnr_planner.server.map.received_maps import MapError
from hnr_planner.server.parameters.settings import DEFAULTS, Settings
from hnr_planner.server.planning.respond import respond
from hnr_planner.server.requests.outcomes import Outcome
from hnr_planner.server.requests.plan_request import PlanRequest, Pose
from hnr_planner.server.responses.plan_response import PlanResponse
import numpy as np
import pytest

RESOLUTION = 0.1

#: Seen from the door, but not from where the paths start.
GOAL = (3.5, 0.3)

#: Seconds that a busy machine may take longer than a time limit.
SLACK = 5.0

SETTINGS = replace(
    DEFAULTS, seed=7, algorithm='rrt', optimize_for=0.0, time_limit=600.0, map_wait=0.0
)


def rooms(door: bool = True) -> np.ndarray:
    """Return two rooms of 2 m x 2 m beside each other; a wall, two cells thick, is between."""
    data = np.zeros((20, 40), dtype=np.int8)
    data[:, 19:21] = 100
    if door:
        data[9:12, 19:21] = 0
    return data


def store(data: np.ndarray, settings: Settings = SETTINGS, frame: str = 'map') -> MapStore:
    """Return a store that has received one map."""
    maps = MapStore(settings)
    receive(maps, data, frame)
    return maps


def receive(maps: MapStore, data: np.ndarray, frame: str = 'map') -> None:
    """Let one more map arrive."""
    maps.receive(lambda: OccupancyMap(data, RESOLUTION, (0.0, 0.0, 0.0), frame))


def ask(
    maps: MapStore | Callable[[], MapSnapshot],
    start: tuple[float, float] = (0.5, 0.5),
    goal: tuple[float, float] = GOAL,
    *,
    tolerance: float = 0.0,
    settings: Settings = SETTINGS,
    algorithm: str = 'rrt',
    start_pose: Pose | None = None,
    goal_pose: Pose | None = None,
) -> PlanResponse:
    """Ask for a path."""
    request = PlanRequest(
        start_pose or Pose((*start, 0.0)),
        goal_pose or Pose((*goal, 0.0)),
        tolerance,
        algorithm,
    )
    newest = maps.newest if isinstance(maps, MapStore) else maps
    return respond(request, settings, newest, threading.Event())


def ask_with(part: str, pose: Pose) -> PlanResponse:
    """Ask for a path with a start or goal of its own."""
    if part == 'start':
        return ask(store(rooms()), start_pose=pose)
    return ask(store(rooms()), goal_pose=pose)


@pytest.mark.parametrize('algorithm', ALGORITHMS)
def test_path_is_free_and_ends_where_asked(algorithm: str) -> None:
    data = rooms()
    response = ask(store(data), algorithm=algorithm)
    assert response.outcome is Outcome.SOLVED
    assert response.path[0].tolist() == [0.5, 0.5]
    assert response.path[-1].tolist() == list(GOAL)
    assert response.offset == 0.0
    assert path_collisions(response.path, data >= 65, RESOLUTION) == []
    assert response.clearance > 0.0
    assert response.frame == 'map'


def test_robot_radius_counts() -> None:
    narrow = replace(SETTINGS, robot_radius=0.5)
    response = ask(store(rooms(), narrow), settings=narrow)
    assert response.outcome is Outcome.UNREACHABLE
    assert '(0.5, 0.5)' in response.why


def test_start_equal_to_goal_is_two_equal_points() -> None:
    response = ask(store(rooms()), (0.5, 0.5), (0.5, 0.5))
    assert response.outcome is Outcome.SOLVED
    assert response.path.tolist() == [[0.5, 0.5], [0.5, 0.5]]


def test_no_map_is_named() -> None:
    response = ask(MapStore(SETTINGS))
    assert response.outcome is Outcome.NO_MAP
    assert response.path.shape == (0, 2)
    assert response.frame == ''


def test_refused_map_is_the_reason_when_there_is_no_other() -> None:
    maps = MapStore(SETTINGS)
    with pytest.raises(MapError, match='resolution'):
        maps.receive(lambda: OccupancyMap(rooms(), -1.0, (0.0, 0.0, 0.0), 'map'))
    response = ask(maps)
    assert response.outcome is Outcome.NO_MAP
    assert 'resolution' in response.why


def test_refused_map_leaves_the_last_good_one() -> None:
    maps = store(rooms())
    with pytest.raises(MapError, match='nan'):
        maps.receive(lambda: OccupancyMap(rooms(), RESOLUTION, (math.nan, 0.0, 0.0), 'map'))
    assert ask(maps).outcome is Outcome.SOLVED


def test_map_that_cannot_be_prepared_leaves_the_last_good_one() -> None:
    maps = store(rooms())
    # One byte, repeated: only the space for it would need more memory than there can be.
    endless = np.broadcast_to(np.int8(0), (10**8, 10**8))
    with pytest.raises(MapError, match=r'preparing the map failed: .*MemoryError.* allocate'):
        receive(maps, endless)
    assert maps.snapshot is not None
    assert ask(maps).outcome is Outcome.SOLVED


def test_map_under_preparation_is_named() -> None:
    maps = MapStore(SETTINGS)
    responses = []

    def read_slowly() -> OccupancyMap:
        responses.append(ask(maps))
        return OccupancyMap(rooms(), RESOLUTION, (0.0, 0.0, 0.0), 'map')

    maps.receive(read_slowly)
    assert responses[0].outcome is Outcome.MAP_NOT_READY
    assert ask(maps).outcome is Outcome.SOLVED


def test_newer_map_is_prepared_while_the_old_one_answers() -> None:
    maps = store(rooms())
    responses = []

    def read_slowly() -> OccupancyMap:
        responses.append(ask(maps))
        return OccupancyMap(rooms(door=False), RESOLUTION, (0.0, 0.0, 0.0), 'map')

    maps.receive(read_slowly)
    assert responses[0].outcome is Outcome.SOLVED
    assert ask(maps).outcome is Outcome.UNREACHABLE


def test_same_map_is_not_prepared_again() -> None:
    maps = store(rooms())
    before = maps.newest()
    receive(maps, rooms())
    assert maps.newest() is before
    receive(maps, rooms(), frame='floor')
    assert maps.newest().number == before.number + 1
    other = rooms()
    other[0, 0] = -1
    receive(maps, other, frame='floor')
    assert maps.newest().number == before.number + 2


def test_changed_robot_radius_prepares_the_last_map_again() -> None:
    maps = store(rooms())
    assert ask(maps).outcome is Outcome.SOLVED
    assert maps.use(replace(SETTINGS, robot_radius=0.5)) is not None
    assert ask(maps).outcome is Outcome.UNREACHABLE
    assert maps.use(replace(SETTINGS, robot_radius=0.5, time_limit=2.0)) is None


@pytest.mark.parametrize('number', [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize('part', ['start', 'goal'])
def test_number_that_is_not_finite_is_a_bad_request(part: str, number: float) -> None:
    for bad in (Pose((number, 1.0, 0.0)), Pose((1.0, 1.0, 0.0), (0.0, 0.0, number, 1.0))):
        response = ask_with(part, bad)
        assert response.outcome is Outcome.BAD_REQUEST
        assert part in response.why
        assert str(number) in response.why


def test_goal_orientation_without_direction_is_a_bad_request() -> None:
    response = ask(store(rooms()), goal_pose=Pose((*GOAL, 0.0), (0.0, 0.0, 0.0, 0.0)))
    assert response.outcome is Outcome.BAD_REQUEST
    assert 'orientation of the goal' in response.why


def test_goal_orientation_is_normalised() -> None:
    tiny = (0.0, 0.0, 3e-200, 4e-200)
    response = ask(store(rooms()), goal_pose=Pose((*GOAL, 0.0), tiny))
    assert response.goal_orientation == pytest.approx((0.0, 0.0, 0.6, 0.8))


@pytest.mark.parametrize('tolerance', [-0.1, math.nan, math.inf])
def test_impossible_tolerance_is_a_bad_request(tolerance: float) -> None:
    response = ask(store(rooms()), tolerance=tolerance)
    assert response.outcome is Outcome.BAD_REQUEST
    assert 'tolerance' in response.why
    assert str(tolerance) in response.why


@pytest.mark.parametrize('part', ['start', 'goal'])
def test_other_frame_is_refused_with_both_names(part: str) -> None:
    response = ask_with(part, Pose((0.5, 0.5, 0.0), frame='odom'))
    assert response.outcome is Outcome.BAD_FRAME
    assert all(word in response.why for word in (part, "'odom'", "'map'"))


@pytest.mark.parametrize('point', [(2.0, 0.2), (-1.0, 0.5), (1e300, 0.5), (0.0, 0.0)])
def test_ends_that_are_not_free_are_named(point: tuple[float, float]) -> None:
    maps = store(rooms())
    assert ask(maps, start=point).outcome is Outcome.INVALID_START
    assert ask(maps, goal=point).outcome is Outcome.INVALID_GOAL


def test_tolerance_never_moves_a_goal_that_can_be_reached() -> None:
    response = ask(store(rooms()), tolerance=2.0)
    assert response.path[-1].tolist() == list(GOAL)
    assert response.offset == 0.0


def test_blocked_goal_gives_way_to_the_nearest_point_and_says_so() -> None:
    data = rooms()
    response = ask(store(data), goal=(2.05, 0.25), tolerance=0.5)
    assert response.outcome is Outcome.SOLVED
    # The wall ends at x = 2.1, and the start's component is on both sides of it.
    assert response.offset == pytest.approx(0.05, abs=1e-3)
    assert response.path[-1].tolist() == pytest.approx([2.1, 0.25], abs=1e-3)
    assert path_collisions(response.path, data >= 65, RESOLUTION) == []
    assert 'moved by 0.05' in response.why


def test_goal_in_another_room_gives_way_to_the_nearest_point_of_ours() -> None:
    response = ask(store(rooms(door=False)), goal=(2.25, 0.55), tolerance=0.5)
    assert response.outcome is Outcome.SOLVED
    assert response.path[-1].tolist() == pytest.approx([1.9, 0.55], abs=1e-3)
    assert response.offset == pytest.approx(0.35, abs=1e-3)


def test_nothing_within_the_tolerance_keeps_the_name_of_the_failure() -> None:
    maps = store(rooms(door=False))
    blocked = ask(maps, goal=(2.05, 0.55), tolerance=0.1)
    assert blocked.outcome is Outcome.INVALID_GOAL
    beyond = ask(maps, goal=GOAL, tolerance=0.1)
    assert beyond.outcome is Outcome.UNREACHABLE
    assert '0.1 m' in beyond.why


def test_goal_radius_ends_the_path_in_the_region() -> None:
    settings = replace(SETTINGS, goal_radius=0.4)
    response = ask(store(rooms()), settings=settings)
    assert response.outcome is Outcome.SOLVED
    assert 0.0 < response.offset <= 0.4


def test_same_seed_is_the_same_path_and_a_fresh_one_is_reported() -> None:
    maps = store(rooms())
    one, two = ask(maps), ask(maps)
    assert one.result is not None and one.result.seed == 7
    assert np.array_equal(one.path, two.path)
    fresh = replace(SETTINGS, seed=-1)
    seeds = {ask(maps, settings=fresh).result.seed for _ in range(3)}  # type: ignore[union-attr]
    assert len(seeds) == 3


def test_iteration_limit_is_named() -> None:
    settings = replace(SETTINGS, max_iterations=100)
    response = ask(store(maze()), (0.05, 0.05), (20.05, 20.05), settings=settings)
    assert response.outcome is Outcome.ITERATION_LIMIT
    assert response.result is not None and response.result.iterations == 100


def maze() -> np.ndarray:
    """Return a serpentine of passages one cell wide: no search here finds its end in seconds."""
    data = np.zeros((201, 201), dtype=np.int8)
    data[1::2, :] = 100
    data[1::4, 0] = 0
    data[3::4, -1] = 0
    return data


def test_time_limit_holds_and_is_named() -> None:
    settings = replace(SETTINGS, time_limit=0.2)
    response = ask(store(maze()), (0.05, 0.05), (20.05, 20.05), settings=settings)
    assert response.outcome is Outcome.TIMEOUT
    assert 0.2 <= response.elapsed < 0.2 + SLACK


def test_cancelled_search_is_named() -> None:
    request = PlanRequest(Pose((0.05, 0.05, 0.0)), Pose((20.05, 20.05, 0.0)), 0.0, 'rrt')
    cancel = threading.Event()
    threading.Timer(0.2, cancel.set).start()
    settings = replace(SETTINGS, time_limit=30.0)
    response = respond(request, settings, store(maze()).newest, cancel)
    assert response.outcome is Outcome.CANCELLED
    assert response.elapsed < 0.2 + SLACK


class ChangingMap:
    """The map in use, which another one replaces after it was read ``reads`` times."""

    def __init__(self, maps: MapStore, later: np.ndarray, frame: str = 'map', reads: int = 1):
        self._maps, self._later, self._frame, self._reads = maps, later, frame, reads

    def __call__(self) -> MapSnapshot:
        """Return the newest map."""
        if self._reads == 0:
            receive(self._maps, self._later, self._frame)
        self._reads -= 1
        return self._maps.newest()


def test_path_that_a_newer_map_blocks_is_planned_again() -> None:
    later = rooms()
    later[2:, 30] = 100
    assert path_collisions(ask(store(rooms())).path, later >= 65, RESOLUTION) != []
    response = ask(ChangingMap(store(rooms()), later))
    assert response.outcome is Outcome.SOLVED
    assert path_collisions(response.path, later >= 65, RESOLUTION) == []


def test_path_that_a_newer_map_leaves_free_stands() -> None:
    later = np.zeros((200, 400), dtype=np.int8)
    response = ask(ChangingMap(store(rooms()), later))
    assert np.array_equal(response.path, ask(store(rooms())).path)
    assert response.snapshot is not None and response.snapshot.occupancy.data.shape == (200, 400)


def test_newer_map_without_a_way_is_told_truly() -> None:
    response = ask(ChangingMap(store(rooms()), rooms(door=False)))
    assert response.outcome is Outcome.UNREACHABLE
    smaller = np.zeros((20, 10), dtype=np.int8)
    assert ask(ChangingMap(store(rooms()), smaller)).outcome is Outcome.INVALID_GOAL


def test_newer_map_in_another_frame_does_not_get_the_old_path() -> None:
    goal = Pose((*GOAL, 0.0), frame='map')
    response = ask(ChangingMap(store(rooms()), rooms(), frame='other'), goal_pose=goal)
    assert response.outcome is Outcome.BAD_FRAME


def test_no_time_for_another_path_is_named() -> None:
    maps = store(rooms())
    reads = []

    def newest() -> MapSnapshot:
        reads.append(time.monotonic())
        if len(reads) == 2:
            time.sleep(0.3)
            receive(maps, rooms(door=False))
        return maps.newest()

    response = ask(newest, settings=replace(SETTINGS, time_limit=0.3))
    assert response.outcome is Outcome.MAP_CHANGED
    assert '0.3 s' in response.why
    assert response.path.shape == (0, 2)


def test_maps_that_go_on_changing_end_in_time() -> None:
    """Every new map blocks the path that was just found, for ever."""
    low, high = rooms(door=False), rooms(door=False)
    low[2:5, 19:21], high[15:18, 19:21] = 0, 0
    maps = store(low)
    turns = [high, low]

    def newest() -> MapSnapshot:
        receive(maps, turns[0])
        turns.reverse()
        return maps.newest()

    response = ask(newest, settings=replace(SETTINGS, time_limit=2.0))
    assert response.outcome is Outcome.MAP_CHANGED
    assert response.elapsed < 2.0 + SLACK
