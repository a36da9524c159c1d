"""Ends that are moved: a goal within its tolerance, a start out of inflated cells."""

import math
from test.brute_force import path_collisions
from test.sweeps import sweep
from typing import Any

from hnr_planner.core import BoxSpace, GridSpace, plan, PlannerStatus, PlanResult, RequestError
from hnr_planner.core.planning.escape import escape_point
import numpy as np
import pytest

CELL = 0.1
#: In the last column before the wall of ``rooms``, so within a radius of .2 m of it.
NEAR_WALL = (1.85, 0.55)


def rooms() -> np.ndarray:
    """Return two rooms of 2 m x 2 m, with a door in the wall between them."""
    data = np.zeros((20, 40), dtype=np.int8)
    data[:, 19] = 100
    data[8:13, 19] = 0
    return data


def grid(data: np.ndarray, robot_radius: float = 0.0, **more: Any) -> GridSpace:
    return GridSpace.from_occupancy(data, CELL, robot_radius=robot_radius, **more)


def ask(space: GridSpace, start: Any, goal: Any = (0.5, 1.5), **given: Any) -> PlanResult:
    return plan(space, start, goal, **{'seed': 1, 'time_limit': math.inf, **given})


@pytest.mark.parametrize(
    ('start', 'goal'),
    [(NEAR_WALL, (3.5, 0.5)), ((0.5, 0.5), (2.15, 0.5)), (NEAR_WALL, (2.15, 0.5))],
)
def test_a_path_with_moved_ends_is_proved_the_shortest_for_them(start: Any, goal: Any):
    moves = {'start_escape': 0.5, 'goal_tolerance': 0.5, 'optimize_iterations': 1}
    result = ask(grid(rooms(), 0.2), start, goal, **moves)
    assert result.status is PlannerStatus.SOLVED
    assert result.escape + result.goal_offset > 0.0 and len(result.path) > 3
    assert result.lower_bound == pytest.approx(result.length, abs=1e-6)
    assert ', the shortest; the ' in result.message


# -- the goal ------------------------------------------------------------------------------------


@pytest.mark.parametrize('goal', [(1.95, 0.55), (1.97, 1.94)])
def test_a_blocked_goal_is_replaced_by_the_nearest_point_within_the_tolerance(goal: Any):
    space = grid(rooms())
    result = ask(space, (0.5, 0.5), goal, goal_tolerance=0.3)
    assert result.status is PlannerStatus.SOLVED
    nearest = space.nearest_reachable((0.5, 0.5), goal, 0.3)
    np.testing.assert_array_equal(result.path[-1], nearest)
    assert result.goal_offset == pytest.approx(math.dist(nearest, goal), abs=1e-12)
    assert 'the goal was moved by' in result.message and 'is occupied' in result.message


def test_a_goal_that_can_be_reached_is_never_moved():
    space = grid(rooms())
    exact, tolerant = (ask(space, (0.5, 0.5), (3.5, 0.5), goal_tolerance=t) for t in (0.0, 1.0))
    np.testing.assert_array_equal(exact.path, tolerant.path)
    assert tolerant.goal_offset == 0.0 and tolerant.message == exact.message


def test_nothing_within_the_tolerance_keeps_the_name_of_the_failure():
    data = rooms()
    data[:, 19] = 100
    result = ask(grid(data), (0.5, 0.5), (3.5, 0.5), goal_tolerance=0.2)
    assert result.status is PlannerStatus.UNREACHABLE
    assert 'nothing within 0.2 m of it can be reached' in result.message
    assert result.goal_offset == 0.0


def test_a_moved_goal_is_met_exactly_whatever_the_region():
    space, goal = grid(rooms()), (1.95, 0.55)
    result = ask(space, (0.5, 0.5), goal, goal_tolerance=0.3, goal_radius=0.01)
    np.testing.assert_array_equal(
        result.path[-1], space.nearest_reachable(result.path[0], goal, 1)
    )


# -- the start -----------------------------------------------------------------------------------


def nearest_by_hand(space: GridSpace, start: Any, radius: float, goal: Any) -> float:
    """Return the length of the shortest escape from a start, from a fine raster of points."""
    steps = np.arange(-radius, radius, CELL / 10.0) + CELL / 20.0
    x, y = np.meshgrid(start[0] + steps, start[1] + steps)
    points = np.stack([x.ravel(), y.ravel()], axis=-1)
    lengths = np.hypot(*(points - start).T)
    for index in np.argsort(lengths):
        if lengths[index] > radius:
            break
        if (
            space.contains(points[index])
            and space.connected(points[index], goal)
            and not crosses(space, np.array([start, points[index]]))
        ):
            return float(lengths[index])
    return math.inf


def crosses(space: GridSpace, way: np.ndarray) -> bool:
    return bool(path_collisions(way, space.occupied, space.resolution, space.origin))


@pytest.mark.parametrize('origin', [sweep((0.0, 0.0, 0.0)), (-3.0, 2.0, 0.7)])
def test_the_escape_is_the_shortest_straight_one(origin: tuple[float, float, float]):
    rng, lengths, n_solved = np.random.default_rng(1), [], 0
    for _ in range(25):
        data = np.where(rng.random((30, 30)) < 0.06, 100, 0).astype(np.int8)
        space = GridSpace.from_occupancy(data, CELL, origin, robot_radius=0.2)
        goal = space.cell_centres(*np.argwhere(space.largest_component())[0])
        inflated = np.argwhere(space.blocked & ~space.occupied)
        start = space.cell_centres(*rng.choice(inflated)) + rng.uniform(-0.04, 0.04, 2)
        point = escape_point(space, start, goal, 0.6)
        expected = nearest_by_hand(space, start, 0.6, goal)
        if math.isinf(expected):
            assert point is None or not space.connected(point, goal)
            continue
        assert point is not None and space.contains(point)
        assert not crosses(space, np.array([start, point]))
        # Where the nearest point of a cell is hidden, its centre represents the rest of it.
        length = math.dist(point, start)
        assert length <= expected + CELL / math.sqrt(2.0)
        lengths.append((length, expected))
        result = ask(space, start, goal, start_escape=0.6)
        assert result.status in (PlannerStatus.SOLVED, PlannerStatus.UNREACHABLE)
        if result.status is PlannerStatus.SOLVED:
            np.testing.assert_array_equal(result.path[:2], [start, point])
            assert space.is_path_free(result.path[1:])
            assert result.escape == pytest.approx(length, abs=1e-12)
            n_solved += 1
    assert n_solved >= 15
    exact = [length <= expected + 1e-9 for length, expected in lengths]
    assert len(exact) >= 15 and np.mean(exact) >= 0.8, (len(exact), np.mean(exact))


def test_a_start_near_a_wall_is_led_out_and_the_message_says_so():
    space = grid(rooms(), 0.2)
    assert ask(space, NEAR_WALL).status is PlannerStatus.INVALID_START
    result = ask(space, NEAR_WALL, start_escape=0.5)
    assert result.status is PlannerStatus.SOLVED
    assert result.escape == pytest.approx(0.15, abs=1e-3)
    words = 'moved by 0.15 m because start (1.85, 0.55) is within the robot radius'
    assert words in result.message
    assert result.length == pytest.approx(np.hypot(*np.diff(result.path, axis=0).T).sum())
    assert result.first_solution is not None
    np.testing.assert_array_equal(result.first_solution.path[:2], result.path[:2])


def test_alternatives_are_led_out_too():
    data = np.zeros((40, 60), dtype=np.int8)
    data[15:25, 25:35] = 100
    data[:, 0] = 100
    result = ask(grid(data, 0.2), (0.15, 2.0), (5.5, 2.0), start_escape=0.5, alternatives=2)
    assert len(result.paths) == 2
    for path in result.paths:
        np.testing.assert_array_equal(path[0], (0.15, 2.0))


def test_without_an_escape_the_status_of_the_failure_is_kept():
    result = ask(grid(rooms(), 0.2), NEAR_WALL, start_escape=0.1)
    assert result.status is PlannerStatus.INVALID_START and result.escape == 0.0
    assert 'no straight segment of 0.1 m at most' in result.message


def test_no_escape_crosses_a_wall():
    """A corridor as wide as the robot: nothing in it is free, but all beyond its wall is."""
    data = np.zeros((40, 40), dtype=np.int8)
    data[0:3, :] = data[5, :] = 100
    result = ask(grid(data, 0.2), (2.05, 0.4), (2.0, 3.0), start_escape=2.0)
    assert result.status is PlannerStatus.INVALID_START


@pytest.mark.parametrize('thickness', [1, 4])
@pytest.mark.parametrize('robot_radius', [0.0, 0.15])
def test_there_is_no_escape_from_an_obstacle(thickness: int, robot_radius: float):
    data = np.zeros((20, 40), dtype=np.int8)
    rows = slice(8, 8 + thickness)
    data[rows, 5:35] = 100
    start = (2.0, 0.8 + thickness * CELL / 2.0)
    result = ask(grid(data, robot_radius), start, start_escape=2.0)
    assert result.status is PlannerStatus.INVALID_START


@pytest.mark.parametrize('goal', [(0.5, 1.5), (3.5, 1.5)])
def test_the_inflation_of_a_costmap_is_left_but_not_through_its_wall(goal: Any):
    data = np.zeros((20, 40), dtype=np.int8)
    data[:, 17:23], data[:, 20] = 99, 100
    space = grid(data, occupied_threshold=99)
    for start, side in (((1.85, 1.0), 1.7), ((2.15, 1.0), 2.3)):
        result = ask(space, start, goal, start_escape=1.0)
        same_side = (goal[0] < 2.0) == (start[0] < 2.0)
        assert result.status is (PlannerStatus.SOLVED if same_side else PlannerStatus.UNREACHABLE)
        assert 'inflation of the costmap' in result.message
        if same_side:
            assert result.path[1].tolist() == pytest.approx([side, 1.0], abs=1e-3)
    assert ask(space, (2.05, 1.0), goal, start_escape=1.0).status is PlannerStatus.INVALID_START
    # Nothing free is left on the side of the start: it is not led to the other one.
    data[:, :17] = 99
    result = ask(grid(data, occupied_threshold=99), (1.85, 1.0), (3.5, 1.5), start_escape=1.0)
    assert result.status is PlannerStatus.INVALID_START


def test_of_unknown_cells_only_that_of_the_start_is_crossed():
    data = np.zeros((20, 20), dtype=np.int8)
    data[10] = -1
    out = ask(grid(data), (0.95, 1.05), (0.5, 0.5), start_escape=0.5)
    assert out.status is PlannerStatus.SOLVED
    assert out.escape == pytest.approx(0.05, abs=1e-6)
    data[9] = data[11] = -1
    assert ask(grid(data), (0.95, 1.05), start_escape=0.5).status is PlannerStatus.INVALID_START


def test_the_escape_ends_where_the_goal_can_be_reached():
    """A pocket is nearer than the large component, but the goal is not in it."""
    data = np.zeros((20, 20), dtype=np.int8)
    data[10] = -1
    for goal in ((0.5, 0.5), (0.5, 1.5)):
        for y in (1.03, 1.07):
            assert (
                ask(grid(data), (0.95, y), goal, start_escape=0.5).status is PlannerStatus.SOLVED
            )


@pytest.mark.parametrize('start', [(-0.01, 0.5), (0.5, 2.1), (1e9, 0.5)])
def test_a_start_outside_the_map_has_no_escape(start: Any):
    assert ask(grid(rooms()), start, start_escape=10.0).status is PlannerStatus.INVALID_START


@pytest.mark.parametrize('start', [(0.0, 0.0), (0.0, 0.5), (4.0, 2.0), (2.0, 0.5)])
@pytest.mark.parametrize('radius', [1e-8, 0.01])
def test_a_start_on_an_edge_is_led_off_it(start: Any, radius: float):
    result = ask(grid(rooms()), start, start_escape=radius)
    assert result.status is PlannerStatus.SOLVED
    assert 0.0 < result.escape < 1e-6


def test_a_start_that_is_free_is_not_led_anywhere():
    space = grid(rooms())
    free, allowed = (ask(space, (0.5, 0.5), (3.5, 0.5), start_escape=r) for r in (0.0, 1.0))
    np.testing.assert_array_equal(free.path, allowed.path)
    assert allowed.escape == 0.0 and allowed.message == free.message


def test_both_ends_are_moved_together():
    goal = (1.85, 1.7)
    result = ask(grid(rooms(), 0.2), NEAR_WALL, goal, goal_tolerance=0.3, start_escape=0.5)
    assert result.status is PlannerStatus.SOLVED
    assert result.escape > 0.0 and result.goal_offset > 0.0
    assert 'start was moved' in result.message and 'goal was moved' in result.message


@pytest.mark.parametrize(
    ('given', 'words'),
    [
        ({'goal_tolerance': 0.1}, 'goal_tolerance must be 0 in a BoxSpace, .*, got 0.1'),
        ({'start_escape': 0.1}, 'start_escape must be 0 in a BoxSpace, .*, got 0.1'),
        ({'goal_tolerance': -1.0}, 'goal_tolerance must be in'),
        ({'start_escape': math.nan}, 'start_escape must be in'),
    ],
)
def test_what_a_space_does_not_know_is_refused(given: dict[str, float], words: str):
    with pytest.raises(RequestError, match=words):
        plan(BoxSpace([0, 0], [1, 1]), (0.5, 0.5), (0.6, 0.6), **given)
