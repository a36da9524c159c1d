"""The way out of a start that is not free: the shortest straight one that crosses no obstacle."""

from dataclasses import replace
import math
from test.brute_force import path_collisions
from test.server.test_requests import ask, rooms, SETTINGS, store

from hnr_planner.core import GridSpace
from hnr_planner.maps import OccupancyMap
from hnr_planner.server.escape import escape_point
from hnr_planner.server.map_store import MapSnapshot
from hnr_planner.server.outcomes import Outcome
import numpy as np
import pytest

CELL = 0.1
LED_OUT = replace(SETTINGS, escape_radius=0.5, robot_radius=0.2)
NEAR_WALL = (1.85, 0.55)
"""In the last column before the wall of `rooms`, so within the robot's radius of it."""


def nearest_by_hand(
    space: GridSpace, start: tuple[float, float], radius: float, part_of: tuple[float, float]
) -> float:
    """Return the length of the shortest way out of `start`, by trying a fine raster of points."""
    steps = np.arange(-radius, radius, CELL / 10.0) + CELL / 20.0
    x, y = np.meshgrid(start[0] + steps, start[1] + steps)
    points = np.stack([x.ravel(), y.ravel()], axis=-1)
    lengths = np.hypot(*(points - start).T)
    for index in np.argsort(lengths):
        way = np.array([start, points[index]])
        if lengths[index] > radius:
            break
        if not space.contains(points[index]) or not space.connected(points[index], part_of):
            continue
        if not crosses(space, way):
            return float(lengths[index])
    return math.inf


def crosses(space: GridSpace, way: np.ndarray) -> bool:
    """Return whether a straight way crosses an occupied cell, but for the one it begins in."""
    return bool(path_collisions(way, space.occupied, space.resolution, space.origin))


@pytest.mark.parametrize('origin', [(0.0, 0.0, 0.0), (-3.0, 2.0, 0.7)])
def test_way_out_is_the_shortest_straight_one(origin: tuple[float, float, float]) -> None:
    rng, lengths = np.random.default_rng(1), []
    for _ in range(25):
        data = np.where(rng.random((30, 30)) < 0.06, 100, 0).astype(np.int8)
        space = GridSpace.from_occupancy(data, CELL, origin, robot_radius=0.2)
        snapshot = MapSnapshot(space, OccupancyMap(data, CELL, origin, 'map'), 1)
        goal = tuple(space.cell_centres(*np.argwhere(space.largest_component())[0]))
        inflated = np.argwhere(space.blocked & ~space.occupied)
        start = tuple(space.cell_centres(*rng.choice(inflated)) + rng.uniform(-0.04, 0.04, 2))
        point = escape_point(snapshot, start, goal, 0.6)
        expected = nearest_by_hand(space, start, 0.6, goal)
        if math.isinf(expected):
            assert point is None or not space.connected(point, goal)
            continue
        assert point is not None
        assert space.contains(point)
        assert not crosses(space, np.array([start, point]))
        # Where the nearest point of a cell is hidden, its centre stands for the rest of it.
        length = math.dist(point, start)
        assert length <= expected + CELL / math.sqrt(2.0)
        lengths.append((length, expected))
    exact = [length <= expected + 1e-9 for length, expected in lengths]
    assert len(exact) >= 15 and np.mean(exact) >= 0.8, (len(exact), np.mean(exact))


def test_start_near_a_wall_is_led_out_and_the_words_say_so() -> None:
    data = rooms()
    refused = ask(store(data, LED_OUT), NEAR_WALL, settings=replace(LED_OUT, escape_radius=0.0))
    assert refused.outcome is Outcome.INVALID_START
    response = ask(store(data, LED_OUT), NEAR_WALL, (0.5, 1.5), settings=LED_OUT)
    assert response.outcome is Outcome.SOLVED
    assert response.path[0].tolist() == list(NEAR_WALL)
    assert response.escape == pytest.approx(
        math.dist(response.path[0], response.path[1]), abs=1e-12
    )
    assert response.escape == pytest.approx(0.15, abs=1e-3)
    assert path_collisions(response.free_path, data >= 65, CELL, robot_radius=0.2) == []
    assert path_collisions(response.path, data >= 65, CELL) == []
    assert (
        'led out by 0.15 m because start (1.85, 0.55) is within the robot radius' in response.why
    )
    steps = np.diff(response.path, axis=0)
    assert response.result is not None
    assert response.result.length == pytest.approx(np.hypot(*steps.T).sum())


def test_start_that_is_free_is_not_led_anywhere() -> None:
    response = ask(store(rooms()), settings=replace(SETTINGS, escape_radius=1.0))
    assert response.escape == 0.0
    assert np.array_equal(response.path, ask(store(rooms())).path)


def test_no_way_out_within_the_radius_keeps_the_name_of_the_failure() -> None:
    short = replace(LED_OUT, escape_radius=0.1)
    response = ask(store(rooms(), short), NEAR_WALL, settings=short)
    assert response.outcome is Outcome.INVALID_START
    assert 'no straight way of 0.1 m' in response.why


def test_no_way_leads_through_a_wall() -> None:
    """A corridor as wide as the robot: nothing in it is free, but all beyond its wall is."""
    data = np.zeros((40, 40), dtype=np.int8)
    data[0:3, :] = data[5, :] = 100
    settings = replace(LED_OUT, escape_radius=2.0)
    response = ask(store(data, settings), (2.05, 0.4), (2.0, 3.0), settings=settings)
    assert response.outcome is Outcome.INVALID_START


def test_start_in_an_obstacle_leaves_it_by_the_shortest_way() -> None:
    data = np.zeros((20, 40), dtype=np.int8)
    data[8:12, 10:14] = 100
    data[:, 20] = 100
    data[10, 20] = 0
    settings = replace(SETTINGS, escape_radius=0.5)
    response = ask(store(data), (1.33, 1.0), (3.5, 0.3), settings=settings)
    assert response.outcome is Outcome.SOLVED
    assert response.path[1].tolist() == pytest.approx([1.4, 1.0], abs=1e-3)
    assert response.clearance == 0.0
    assert 'is occupied' in response.why


@pytest.mark.parametrize('goal', [(0.5, 1.5), (3.5, 1.5)])
def test_no_way_leads_from_the_inflation_of_a_costmap_through_its_wall(
    goal: tuple[float, float],
) -> None:
    data = np.zeros((20, 40), dtype=np.int8)
    data[:, 17:23], data[:, 20] = 99, 100
    costmap = replace(SETTINGS, occupied_threshold=99, escape_radius=1.0)
    for start, side in (((1.85, 1.0), 1.7), ((2.15, 1.0), 2.3)):
        response = ask(store(data, costmap), start, goal, settings=costmap)
        same_side = (goal[0] < 2.0) == (start[0] < 2.0)
        assert response.outcome is (Outcome.SOLVED if same_side else Outcome.UNREACHABLE)
        if same_side:
            assert response.path[1].tolist() == pytest.approx([side, 1.0], abs=1e-3)
    # Nothing free is left on the side of the start: it is not led to the other one.
    data[:, :17] = 99
    response = ask(store(data, costmap), (1.85, 1.0), (3.5, 1.5), settings=costmap)
    assert response.outcome is Outcome.INVALID_START


def test_start_in_a_wall_is_not_led_to_its_far_side_for_the_goal() -> None:
    data = np.zeros((20, 40), dtype=np.int8)
    data[:, 19:23] = 100
    settings = replace(SETTINGS, escape_radius=1.0)
    response = ask(store(data), (1.95, 1.0), (3.5, 1.0), settings=settings)
    assert response.outcome is Outcome.UNREACHABLE


def test_way_out_leads_to_where_the_goal_can_be_reached() -> None:
    """A pocket is nearer than the room, but leads nowhere."""
    data = np.zeros((20, 20), dtype=np.int8)
    data[10, :10] = -1
    data[:, 10] = -1
    response = ask(
        store(data), (0.05, 1.05), (1.5, 0.5), settings=replace(LED_OUT, robot_radius=0)
    )
    assert response.outcome is Outcome.UNREACHABLE
    start = (0.95, 1.05)
    for goal in ((0.5, 0.5), (0.5, 1.5), (1.5, 0.5)):
        settings = replace(SETTINGS, escape_radius=0.5)
        response = ask(store(data), start, goal, settings=settings)
        assert response.outcome is Outcome.SOLVED, response.why


@pytest.mark.parametrize('start', [(-0.01, 0.5), (0.5, 2.1), (1e9, 0.5)])
def test_start_outside_the_map_has_no_way_in(start: tuple[float, float]) -> None:
    settings = replace(SETTINGS, escape_radius=10.0)
    assert ask(store(rooms()), start, settings=settings).outcome is Outcome.INVALID_START


@pytest.mark.parametrize('start', [(0.0, 0.0), (0.0, 0.5), (4.0, 2.0)])
def test_start_on_an_edge_is_led_off_it(start: tuple[float, float]) -> None:
    settings = replace(SETTINGS, escape_radius=0.01)
    response = ask(store(rooms()), start, settings=settings)
    assert response.outcome is Outcome.SOLVED
    assert 0.0 < response.escape < 1e-6


def test_way_out_and_tolerance_go_together() -> None:
    response = ask(
        store(rooms(), LED_OUT), NEAR_WALL, (1.85, 1.7), tolerance=0.3, settings=LED_OUT
    )
    assert response.outcome is Outcome.SOLVED
    assert 'led out' in response.why and 'goal was moved' in response.why
