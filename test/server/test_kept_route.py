"""A route stays while the map changes a little, and gives way to a much shorter one."""

from dataclasses import replace
from itertools import pairwise
import math
from test.brute_force import path_collisions
from test.server.test_planning_server import server
from test.server.test_requests import receive, RESOLUTION, SETTINGS, store
import threading

from hnr_planner.core import GridSpace
from hnr_planner.core.lengths import path_length
from hnr_planner.server.planning.respond import only_same_frame
from hnr_planner.server.planning_server import PlanningServer
from hnr_planner.server.requests.outcomes import Outcome
from hnr_planner.server.requests.plan_request import PlanRequest, Pose
from hnr_planner.server.responses.plan_response import PlanResponse
from hnr_planner.server.routes.last_routes import next_vertex
from hnr_planner.server.routes.route_class import detour, Landmarks, route_class
import numpy as np
import pytest

#: Two ways around an island, of nearly the same length: which is shorter depends on the door.
SHAPE, ISLAND = (40, 60), np.s_[10:30, 20:40]
START, GOAL = (0.5, 2.0), (5.5, 2.0)


def island(lower: int = 0, upper: int = 0) -> np.ndarray:
    """Return a room with an island; the ways below and above it are narrowed by so many cells."""
    data = np.zeros(SHAPE, dtype=np.int8)
    data[ISLAND] = 100
    below, above = 10 - lower, 30 + upper
    data[below:10, 20:40] = data[30:above, 20:40] = 100
    return data


def request(start: tuple[float, float] = START, goal: tuple[float, float] = GOAL) -> PlanRequest:
    """Return a request from a start to a goal."""
    return PlanRequest(Pose((*start, 0.0)), Pose((*goal, 0.0)), 0.0, 'auto')


#: Pose of the hall in the map's frame: turned, so that a wrong frame shows.
ORIGIN = (2.0, -1.0, 0.5)


def to_map(points: np.ndarray) -> np.ndarray:
    """Return points (k, 2) [m] of the hall in the map's frame."""
    x, y, yaw = ORIGIN
    turn = np.array([[math.cos(yaw), -math.sin(yaw)], [math.sin(yaw), math.cos(yaw)]])
    return points @ turn.T + (x, y)


def from_map(points: np.ndarray) -> np.ndarray:
    """Return points (k, 2) [m] of the map's frame in that of the hall."""
    x, y, yaw = ORIGIN
    turn = np.array([[math.cos(yaw), -math.sin(yaw)], [math.sin(yaw), math.cos(yaw)]])
    return (points - (x, y)) @ turn


class Robot:
    """Asks again and again while the map changes."""

    def __init__(self, ratio: float) -> None:
        self.maps = store(island())
        settings = replace(SETTINGS, keep_route=ratio, optimize_for=10.0, algorithm='auto')
        self.server = PlanningServer(lambda: settings, self.maps.newest, only_same_frame, print)
        self.server.searches.enable()

    def ask(
        self,
        data: np.ndarray,
        start: tuple[float, float] = START,
        goal: tuple[float, float] = GOAL,
    ) -> PlanResponse:
        """Put a map to use and return the response to a request, whose path is free there."""
        receive(self.maps, data)
        response = self.server.plan(request(start, goal))
        assert response.outcome is Outcome.SOLVED
        assert path_collisions(response.path, data >= 65, RESOLUTION) == []
        assert response.path[0].tolist() == list(start)
        assert response.path[-1].tolist() == list(goal)
        return response


def is_above(response: PlanResponse) -> bool:
    """Return whether a path passes above the island."""
    path = response.path
    along = path[np.argsort(path[:, 0])]
    return bool(np.interp(3.0, along[:, 0], along[:, 1]) > 2.0)


def test_route_stays_on_its_side_while_the_shorter_side_changes() -> None:
    changes = [(int(n % 2) * 2, int(1 - n % 2) * 2) for n in range(10)]
    sides = {}
    for ratio in (0.0, 0.2):
        robot = Robot(ratio)
        sides[ratio] = [is_above(robot.ask(island(*change))) for change in changes]
    switches = {ratio: sum(a != b for a, b in pairwise(side)) for ratio, side in sides.items()}
    assert switches == {0.0: 9, 0.2: 0}


def test_outcome_says_kept_mended_or_new_and_why() -> None:
    robot = Robot(0.2)
    assert robot.ask(island()).values['route'] == 'new'
    again = robot.ask(island(), start=(0.7, 2.0))
    assert again.values['route'] == 'kept'
    assert 'the route is kept: it is longer than a new one by' in again.why
    above = is_above(again)
    narrowed = island(upper=3) if above else island(lower=3)
    mended = robot.ask(narrowed, start=(0.7, 2.0))
    assert mended.values['route'] == 'mended' and is_above(mended) is above
    closed = island(upper=10) if above else island(lower=10)
    other = robot.ask(closed, start=(0.7, 2.0))
    assert is_above(other) is not above


def test_much_shorter_path_is_taken() -> None:
    robot = Robot(0.05)
    robot.ask(island())
    free = robot.ask(np.zeros(SHAPE, dtype=np.int8))
    assert free.values['route'] == 'new' or path_length(free.path) < 5.0 / 0.95
    assert path_length(free.path) <= 5.0 / 0.95 + 1e-9


def test_route_of_another_goal_or_without_the_parameter_is_not_kept() -> None:
    robot = Robot(0.2)
    robot.ask(island())
    elsewhere = replace(request(), goal=Pose((5.5, 3.0, 0.0)))
    assert robot.server.plan(elsewhere).values['route'] == 'new'
    assert 'route' not in server(store(island()).newest).plan(request()).values


def test_path_with_a_kept_route_is_hardly_longer_than_the_shortest() -> None:
    """Random narrowings: on average within 2 %, and each within the ratio."""
    rng, robot, ratio = np.random.default_rng(5), Robot(0.1), 0.1
    excess = []
    for _ in range(30):
        data = island(*rng.integers(0, 4, 2).tolist())
        response = robot.ask(data)
        shortest = Robot(0.0).ask(data)
        excess.append(path_length(response.path) / path_length(shortest.path))
    assert max(excess) <= 1.0 / (1.0 - ratio) + 1e-6
    assert np.mean(excess) <= 1.02


def test_next_vertex_is_ahead_of_the_robot() -> None:
    path = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0]])
    assert next_vertex(path, np.array([0.5, 0.1])) == 1
    assert next_vertex(path, np.array([2.1, 0.5])) == 2
    assert next_vertex(path, np.array([2.0, 0.0])) == 2, 'a vertex that is reached is passed'
    assert next_vertex(path, np.array([9.0, 9.0])) == 2


def hall(*rects: tuple[int, int, int, int]) -> np.ndarray:
    """Return a hall with two shelves one above the other, and further obstacles: rows, columns."""
    data = np.zeros((60, 90), dtype=np.int8)
    for first_row, end_row, first_column, end_column in (
        (8, 24, 20, 70),
        (36, 52, 20, 70),
        *rects,
    ):
        data[first_row:end_row, first_column:end_column] = 100
    return data


#: A route between the shelves of the hall, bent by nobody.
BETWEEN = np.array([[0.5, 3.0], [8.5, 3.0]])
#: Somebody in the aisle, whom one can pass on either side, and a gate across the aisle.
PERSON, GATE = (27, 32, 42, 47), (24, 36, 44, 46)


def space_of(data: np.ndarray) -> GridSpace:
    """Return a map as a space."""
    return GridSpace.from_occupancy(data, RESOLUTION, ORIGIN)


@pytest.mark.interpreted
def test_person_is_passed_between_the_same_shelves() -> None:
    data = hall(PERSON)
    space, landmarks = space_of(data), Landmarks()
    route = to_map(BETWEEN)
    islands = landmarks.on(space)
    assert len(islands.x) == 2, 'a person is no landmark'
    way = detour(space, islands, route, math.inf, threading.Event())
    assert way is not None
    assert path_collisions(from_map(way), data >= 65, RESOLUTION) == []
    assert np.array_equal(way[[0, -1]], route[[0, -1]])
    assert route_class(space, islands, way) == route_class(space, islands, route)
    assert path_length(way) < 1.01 * path_length(route)


@pytest.mark.interpreted
def test_gate_leaves_no_detour_but_both_shelves_stay_landmarks() -> None:
    landmarks, space = Landmarks(), space_of(hall(GATE))
    assert len(landmarks.on(space).x) == 1, 'shelves and gate are one obstacle'
    landmarks.on(space_of(hall()))
    islands, route = landmarks.on(space), to_map(BETWEEN)
    below = to_map(np.array([[0.5, 3.0], [1.5, 0.5], [7.5, 0.5], [8.5, 3.0]]))
    assert space.is_path_free(below)
    assert route_class(space, islands, below) != route_class(space, islands, route)
    assert detour(space, islands, route, math.inf, threading.Event()) is None


@pytest.mark.interpreted
@pytest.mark.parametrize('end', [0, 1])
def test_route_with_a_blocked_end_has_no_detour(end: int) -> None:
    column = (4, 84)[end]
    space = space_of(hall((28, 32, column, column + 3)))
    route, islands = to_map(BETWEEN), Landmarks().on(space)
    assert detour(space, islands, route, math.inf, threading.Event()) is None


def test_landmarks_of_what_has_gone_are_forgotten() -> None:
    landmarks = Landmarks()
    assert len(landmarks.on(space_of(hall())).x) == 2
    assert len(landmarks.on(space_of(np.zeros((60, 90), dtype=np.int8))).x) == 0


def test_route_stays_on_its_side_of_a_shelf_while_people_walk_by() -> None:
    """Someone in either aisle: which aisle is shorter changes, and a memoryless path with it."""
    sides = {}
    for ratio in (0.0, 0.2):
        rng, robot, sides[ratio] = np.random.default_rng(2), Robot(ratio), []
        for _ in range(20):
            below, above = rng.integers(24, 32), rng.integers(52, 56)
            left, right = rng.integers(17, 24, 2)
            people = [(below, below + 5, left, left + 5), (above, above + 4, right, right + 4)]
            response = robot.ask(hall(*people), (0.5, 4.4), (8.5, 4.4))
            sides[ratio].append(bool(np.interp(4.5, *response.path.T) > 4.4))
    switches = {ratio: sum(a != b for a, b in pairwise(side)) for ratio, side in sides.items()}
    assert switches[0.2] == 0
    assert switches[0.0] > 2


def test_robots_that_ask_in_turns_keep_their_own_routes() -> None:
    """Two goals, and two starts for one of them, while the ways grow narrow in turns."""
    robot, asked = Robot(0.2), [(START, GOAL), ((0.5, 2.6), GOAL), (GOAL, START)]
    sides: list[list[bool]] = [[] for _ in asked]
    for n in range(6):
        data = island(2 * (n % 2), 2 - 2 * (n % 2))
        for side, (start, goal) in zip(sides, asked, strict=True):
            side.append(is_above(robot.ask(data, start, goal)))
    assert all(len(set(side)) == 1 for side in sides)
