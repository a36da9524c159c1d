"""Clearance: kept where possible, reduced in doors, never at the price of a collision."""

from functools import partial
from itertools import pairwise
import math
from test.brute_force import path_collisions
from test.laws import maps
from test.visibility_graph import Cells, SCALE, shortest_length
import threading

from hnr_planner import core
from hnr_planner.core import ALGORITHMS, GridSpace, PlannerStatus, PlanResult, RequestError
from hnr_planner.core.planning import shortest
from hnr_planner.core.planning.homology import islands_at, signature
from hnr_planner.core.planning.limits import Budget
from hnr_planner.core.planning.postprocessing import clearance as module
from hnr_planner.core.planning.postprocessing.clearance import increase_clearance, path_cost
from hnr_planner.core.planning.request import check_request
from hnr_planner.core.spaces.grid.kept_clear import kept_clear
from hypothesis import given, settings, strategies
import numpy as np
from numpy.typing import NDArray
import pytest

Floats = NDArray[np.float64]
# No law here is about time, however busy the machine is.
plan = partial(core.plan, time_limit=60.0)

BLOCKED = maps.rooms(60, 80, 20, seed=4)
ORIGIN = (2.0, -1.0, 0.4)
SPACE = GridSpace.from_blocked(BLOCKED, 0.1, ORIGIN)
START, GOAL = SPACE.cell_centres(9, 9), SPACE.cell_centres(50, 70)


def points_on(path: Floats, spacing: float) -> Floats:
    """Return points along a path, its vertices among them."""
    pieces = [path[:1]]
    for a, b in pairwise(path):
        n = 1 + int(math.dist(a, b) / spacing)
        pieces.append(a + np.arange(1, n + 1)[:, np.newaxis] / n * (b - a))
    return np.concatenate(pieces)


def wall_distances(points: Floats, occupied: NDArray[np.bool_]) -> Floats:
    """Return the distance from points in cells to the nearest occupied square, by definition."""
    row, column = np.argwhere(occupied).T
    x, y = points.T[:, :, np.newaxis]
    beside = np.maximum(np.maximum(column - x, x - column - 1), 0.0)
    above = np.maximum(np.maximum(row - y, y - row - 1), 0.0)
    return np.hypot(beside, above).min(axis=1)


def away(path: Floats, distance: float) -> Floats:
    """Return points along a path that are this far from both of its ends."""
    points = points_on(path, 0.25)
    from_start, from_goal = (np.hypot(*(points - end).T) for end in path[[0, -1]])
    return points[(from_start > distance) & (from_goal > distance)]


# -- where the clearance is possible -------------------------------------------------------------


@pytest.mark.parametrize('seed', range(10))
@pytest.mark.parametrize('clearance', [2.0, 5.0, 9.0])
def test_a_hall_has_room_for_what_is_asked(clearance: float, seed: int):
    """Around a wall in a hall of 80 x 100 cells: the distance asked for is kept, within 10 %."""
    occupied = np.zeros((80, 100), dtype=bool)
    occupied[:50, 48:52] = True
    occupied[[0, -1]] = occupied[:, [0, -1]] = True
    space = GridSpace.from_blocked(occupied)
    start, goal = (14.5, 14.5), (85.5, 14.5)
    path = plan(space, start, goal, clearance=clearance, seed=seed).path
    assert path_collisions(path, occupied, 1.0) == []
    kept = wall_distances(points_on(path, 0.25), occupied).min()
    assert 0.9 * clearance <= kept <= 1.1 * clearance
    around = math.hypot(33.5, 35.5 + clearance) * 2 + 4 + 2 * clearance
    assert sum(map(math.dist, path[:-1], path[1:])) < around


@pytest.mark.parametrize('seed', range(10))
def test_along_a_wall_the_path_moves_away_from_it(seed: int):
    occupied = np.zeros((40, 120), dtype=bool)
    occupied[0] = True
    space = GridSpace.from_blocked(occupied)
    result = plan(space, (5.0, 2.0), (115.0, 2.0), clearance=6.0, seed=seed)
    assert result.iterations == 0
    assert wall_distances(away(result.path, 15.0), occupied).min() >= 0.9 * 6.0
    assert result.first_solution.length == 110.0 < result.length < 118.0


# -- where there is not --------------------------------------------------------------------------


@pytest.mark.parametrize('seed', range(10))
@pytest.mark.parametrize('width', [1, 3, 6])
def test_a_narrow_door_is_passed_in_its_middle_and_left_behind(width: int, seed: int):
    """A wall 4 cells thick with a door at one side; beyond it the clearance is kept again."""
    occupied = np.zeros((60, 100), dtype=bool)
    occupied[[0, -1]] = occupied[:, [0, -1]] = True
    occupied[:, 48:52] = True
    top = 20 + width
    occupied[20:top, 48:52] = False
    space = GridSpace.from_blocked(occupied)
    path = plan(space, (15.5, 45.5), (85.5, 45.5), clearance=8.0, seed=seed).path
    assert path_collisions(path, occupied, 1.0) == []
    points = points_on(path, 0.25)
    in_door = points[(points[:, 0] > 48.0) & (points[:, 0] < 52.0)]
    assert np.abs(in_door[:, 1] - (20.0 + width / 2.0)).max() <= 0.3 * width
    from_door = np.hypot(*(points - (50.0, 20.0 + width / 2.0)).T)
    assert wall_distances(points[from_door > 14.0], occupied).min() >= 0.9 * 8.0


@pytest.mark.parametrize('clearance', [1e-9, 0.01, 3.0, 1e6])
def test_any_clearance_can_be_asked_for(clearance: float):
    result = plan(SPACE, START, GOAL, clearance=clearance, seed=1)
    assert result.status is PlannerStatus.SOLVED and not result.cut_by_time
    assert path_collisions(result.path, BLOCKED, 0.1, ORIGIN) == []


# -- always --------------------------------------------------------------------------------------


@settings(max_examples=80, deadline=None)
@given(
    strategies.integers(0, 2**31),
    strategies.floats(0.005, 0.1),
    strategies.floats(0.05, 3.0),
    strategies.sampled_from([0.0, 0.12]),
)
def test_on_any_map_the_path_is_free_and_costs_no_more_than_the_shortest(
    seed, density, clearance, radius
):
    occupied = maps.speckle(50, 60, density, seed)
    space = GridSpace.from_blocked(occupied, 0.1, ORIGIN, robot_radius=radius)
    free = np.argwhere(space.largest_component())
    start, goal = space.cell_centres(*free[[0, -1]].T)
    shortest = plan(space, start, goal, seed=seed)
    result = plan(space, start, goal, seed=seed, clearance=clearance)
    assert path_collisions(result.path, space.blocked, 0.1, ORIGIN) == []
    np.testing.assert_array_equal(result.path[[0, -1]], [start, goal])
    costs = [path_cost(space, answer.path, clearance) for answer in (result, shortest)]
    assert costs[0] <= costs[1]
    assert result.first_solution.length == shortest.first_solution.length


def test_on_the_whole_more_is_asked_more_is_given():
    """Mean clearance over 40 requests in rooms, and length: both grow with what is asked."""
    clearances = (0.0, 0.1, 0.2, 0.4)
    free = np.argwhere(SPACE.largest_component())
    rng = np.random.default_rng(0)
    pairs = [SPACE.cell_centres(*free[rng.integers(len(free), size=2)].T) for _ in range(40)]
    given, lengths = [], []
    for clearance in clearances:
        paths = [plan(SPACE, *ends, clearance=clearance, seed=3).path for ends in pairs]
        along = np.concatenate([points_on(path, 0.05) for path in paths])
        given.append(SPACE.clearance(along).mean())
        lengths.append(sum(sum(map(math.dist, path[:-1], path[1:])) for path in paths))
    assert given == sorted(given) and given[-1] > 1.1 * given[0]
    assert lengths == sorted(lengths) and lengths[-1] < 1.2 * lengths[0]


def test_a_mutant_that_forgets_the_walls_is_caught(monkeypatch: pytest.MonkeyPatch):
    """Without stepping aside nothing is given; the laws above would not hold."""
    monkeypatch.setattr(module, 'move', lambda *arguments: False)
    with pytest.raises(AssertionError):
        test_on_the_whole_more_is_asked_more_is_given()
    with pytest.raises(AssertionError):
        test_a_hall_has_room_for_what_is_asked(5.0, 0)


def test_the_same_seed_gives_the_same_path():
    first, second = (plan(SPACE, START, GOAL, clearance=0.4, seed=7).path for _ in range(2))
    np.testing.assert_array_equal(first, second)


def test_no_clearance_changes_nothing():
    np.testing.assert_array_equal(
        plan(SPACE, START, GOAL, clearance=0.0, seed=7).path, plan(SPACE, START, GOAL, seed=7).path
    )


def test_more_searches_never_give_a_costlier_path():
    costs = [
        path_cost(SPACE, plan(SPACE, START, GOAL, clearance=0.4, seed=7, **more).path, 0.4)
        for more in ({}, {'optimize_iterations': 10}, {'optimize_iterations': 40})
    ]
    assert costs == sorted(costs, reverse=True)


def test_islands_are_passed_where_they_were():
    space = GridSpace.from_blocked(maps.wide_hall(60, 60))
    pillars = islands_at(space.island_points)
    rng = np.random.default_rng(0)
    for _ in range(200):
        path = rng.uniform(0.0, 60.0, (6, 2))
        if space.contains(path).all() and space.first_blocked_segment(path) is None:
            moved = increase_clearance(space, path, 5.0, Budget(math.inf), pillars)
            assert path_collisions(moved, space.blocked, 1.0) == []
            before, after = (signature(pillars, space.to_kernel(each)) for each in (path, moved))
            assert before == after


def test_alternatives_have_clearance_too():
    occupied = maps.wide_hall(60, 60)
    space = GridSpace.from_blocked(occupied)
    result = plan(space, (8.5, 29.5), (52.5, 29.5), alternatives=3, clearance=4.0, seed=0)
    assert len(result.paths) == 3
    for path in result.paths:
        assert path_collisions(path, occupied, 1.0) == []
        assert wall_distances(points_on(path, 0.25), occupied).min() >= 0.9 * 4.0


def test_the_clock_ends_it_with_a_path():
    cancel = threading.Event()
    cancel.set()
    near = np.array(START) + 0.01
    result = plan(SPACE, START, near, clearance=0.4, cancel=cancel)
    assert result.status is PlannerStatus.SOLVED and result.cut_by_time
    np.testing.assert_array_equal(result.path, [START, near])


# -- refused -------------------------------------------------------------------------------------


class WalllessSpace(GridSpace):
    """A space without ``walls``."""

    walls = None


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        ({'clearance': -0.1}, 'clearance must be in 0..1e'),
        ({'clearance': math.nan}, 'clearance must be in 0..1e'),
        ({'clearance': math.inf}, 'clearance must be in 0..1e'),
        ({'clearance': 'far'}, "clearance must be a number, got 'far'"),
        ({'clearance': 0.5, 'simplify': False}, 'clearance must be 0 when simplify is false'),
    ],
)
def test_what_cannot_be_had_is_refused(arguments: dict, words: str):
    with pytest.raises(RequestError, match=words):
        plan(SPACE, START, GOAL, **arguments)


def test_a_space_without_clearance_says_so():
    space = WalllessSpace.from_blocked(BLOCKED, 0.1)
    ends = space.cell_centres([9, 9], [9, 12])
    with pytest.raises(RequestError, match=r'must be 0 in a WalllessSpace, .*, got 0.5'):
        plan(space, *ends, clearance=0.5)
    assert plan(space, *ends).status is PlannerStatus.SOLVED


@pytest.mark.parametrize('algorithm', ALGORITHMS)
def test_every_planner_keeps_a_clearance(algorithm: str):
    request = {'algorithm': algorithm, 'seed': 2, 'time_limit': math.inf}
    paths = [plan(SPACE, START, GOAL, clearance=c, **request).path for c in (0.0, 0.3)]
    costs = [path_cost(SPACE, path, 0.3) for path in paths]
    assert costs[1] < costs[0]


# -- the exact search over cells that keep it ----------------------------------------------------


def two_ways() -> NDArray[np.bool_]:
    """Return a thick wall with a narrow passage on the short way, and a wide one farther off."""
    occupied = np.zeros((60, 40), dtype=bool)
    occupied[:, 14:26] = True
    occupied[10:12, 14:26] = occupied[40:56, 14:26] = False
    return occupied


@pytest.mark.parametrize(
    'arguments', [{'algorithm': 'polyanya'}, {'optimize_for': 60.0, 'optimize_iterations': 1}]
)
def test_the_exact_search_takes_the_wide_passage_instead_of_the_narrow_one(arguments: dict):
    occupied = two_ways()
    space = GridSpace.from_blocked(occupied)
    ends = (5.5, 18.5), (34.5, 18.5)
    narrow = plan(space, *ends, seed=0, **arguments)
    wide = plan(space, *ends, clearance=4.0, seed=0, **arguments)
    assert narrow.path[:, 1].max() < 20.0 < wide.path[:, 1].max()
    assert path_collisions(wide.path, occupied, 1.0) == []
    assert wall_distances(points_on(wide.path, 0.25), occupied).min() >= 3.5
    assert wide.lower_bound == narrow.lower_bound
    around = shortest_length(~cells_that_keep(space, occupied, 4.0), (22, 74), (138, 74))
    assert wide.clear_lower_bound == pytest.approx(around, abs=1e-6)
    assert 'the shortest over cells that keep 4 m' in wide.message


def cells_that_keep(space: GridSpace, occupied: NDArray[np.bool_], clearance: float) -> Cells:
    """Return which free cells have no point nearer than a clearance to an occupied cell."""
    keep = ~space.blocked
    for row, column in np.argwhere(keep):
        across = np.maximum(np.abs(np.argwhere(occupied) - (row, column)) - 1, 0)
        nearest = np.hypot(*across.T).min(initial=math.inf)
        keep[row, column] = nearest * space.resolution >= clearance - 1e-9
    return keep


def check_bound(seed: int) -> PlanResult:
    """Compare the bound on paths that keep a clearance with a solver in whole numbers."""
    rng = np.random.default_rng(seed)
    occupied = np.zeros((20, 24), dtype=bool)
    for row, column in rng.integers((0, 2), (17, 22), size=(6, 2)).tolist():
        height, width = rng.integers(1, (9, 3)).tolist()
        occupied[row:, column:][:height, :width] = True
    clearance, radius = rng.choice([0.4, 0.5, 0.8, 1.0, 1.2]), rng.choice([0.0, 0.5])
    space = GridSpace.from_blocked(occupied, 0.5, robot_radius=radius)
    keep = cells_that_keep(space, occupied, clearance)
    free = np.argwhere(space.largest_component() & (keep | (seed % 4 == 0)))
    free = free[np.argsort(free[:, 1], kind='stable')]  # from left to right
    (row, column), (to_row, to_column) = free[rng.integers(20, size=2) * (1, -1)].tolist()
    ends = space.cell_centres([row, to_row], [column, to_column])
    result = plan(space, *ends, clearance=clearance, algorithm='polyanya', seed=seed)
    assert path_collisions(result.path, space.blocked, 0.5) == []
    if result.clear_lower_bound == 0.0:  # the start sees the goal: nothing was searched
        assert result.iterations == 0
        return result
    expected = math.inf
    if keep[row, column] and keep[to_row, to_column]:
        centres = [(SCALE * x + 2, SCALE * y + 2) for x, y in ((column, row), (to_column, to_row))]
        expected = 0.5 * shortest_length(~keep, *centres)
    assert result.clear_lower_bound == pytest.approx(expected, abs=1e-6), seed
    ratio, where = result.length / expected, f' over cells that keep {clearance:g} m'
    assert (f', no path{where} exists' in result.message) == (expected == math.inf)
    assert (f' % longer than the shortest{where}' in result.message) == (ratio > 1.0 + 1e-6)
    if f', the shortest{where}' in result.message:
        assert path_collisions(result.path, ~keep, 0.5) == []
        assert ratio == pytest.approx(1.0, abs=1e-6)
    return result


def test_the_bound_on_paths_that_keep_a_clearance_is_their_least_length():
    results = [check_bound(seed) for seed in range(150)]
    words = [', no path over', ', the shortest over', ', no longer than']
    counts = [sum(each in result.message for result in results) for each in words]
    assert min(counts) >= 3, counts


@pytest.mark.parametrize('wrong', [-0.3, 0.3])
def test_a_mutant_with_other_cells_is_caught(wrong: float, monkeypatch: pytest.MonkeyPatch):
    """The bound of paths that keep less, or more, is not that of paths that keep the clearance."""
    monkeypatch.setattr(shortest, 'kept_clear', lambda space, c: kept_clear(space, c + wrong))
    with pytest.raises(AssertionError):
        test_the_bound_on_paths_that_keep_a_clearance_is_their_least_length()


def test_a_search_that_the_clock_ended_leaves_a_true_bound():
    occupied = two_ways()
    space = GridSpace.from_blocked(occupied)
    ends = (5.5, 18.5), (34.5, 18.5)
    whole = plan(space, *ends, clearance=4.0, algorithm='polyanya')
    request = check_request(
        space, *ends, goal_radius=0.0, simplify=True, seed=0, clearance=4.0, algorithm='polyanya'
    )
    for n_iterations in range(8):
        cut = shortest.shortest_kept_clear(request, Budget(math.inf, n_iterations))
        assert math.dist(*ends) <= cut.lower_bound <= whole.clear_lower_bound + 1e-9


def test_cells_that_keep_a_clearance_are_those_of_the_definition():
    occupied = np.random.default_rng(2).random((30, 40)) < 0.02
    space = GridSpace.from_blocked(occupied, 0.5, robot_radius=0.6)
    for clearance in (0.4, 0.5, 0.6, 1.5):
        clear = kept_clear(space, clearance)
        expected = ~cells_that_keep(space, occupied, clearance)
        np.testing.assert_array_equal(clear.blocked, expected)
        assert kept_clear(space, clearance) is clear
    assert kept_clear(space, 0.4) is not clear
