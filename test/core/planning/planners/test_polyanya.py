"""Polyanya finds the shortest path, by an independent solver in whole numbers."""

from itertools import count
import math
import os
from pathlib import Path
from test.brute_force import path_collisions
from test.visibility_graph import SCALE, shortest_length
import threading

from hnr_planner.core import BoxSpace, GridSpace, plan, PlannerStatus, Polyanya, RequestError
from hnr_planner.core.errors import Interrupted
from hnr_planner.core.kernels import interruption
from hnr_planner.core.kernels.interruption import interruptible
from hnr_planner.core.kernels.kernel import interpreted
from hnr_planner.core.kernels.streams import stream
from hnr_planner.core.planning.planner import make_problem
from hnr_planner.core.planning.planners import polyanya
from hnr_planner.maps import load_map
import numpy as np
import pytest

SEEDS = range(40)
SCENARIO = Path(os.environ.get('HNR_MAPS', '/nonexistent')) / 'Denver_1_256.map.scen'
#: What margins at corners add to a length at most [cells].
MARGINS = 1e-6


def exact(space, start, goal, **arguments):
    arguments = {'time_limit': math.inf, 'max_iterations': 100_000, **arguments}
    return plan(space, start, goal, algorithm='polyanya', **arguments)


def random_map(rng: np.random.Generator) -> np.ndarray:
    return rng.random(rng.integers(2, 10, size=2)) < rng.choice([0.15, 0.3, 0.45])


def random_blocks(rng: np.random.Generator) -> np.ndarray:
    """Return a map of rectangles, whose straight walls paths graze from both sides."""
    blocked = np.zeros(rng.integers(8, 20, size=2), dtype=bool)
    for _ in range(rng.integers(3, 9)):
        (row, column), (height, width) = rng.integers(blocked.shape), rng.integers(1, 8, size=2)
        blocked[row:, column:][:height, :width] = True
    return blocked


def random_points(rng, blocked, n):
    """Return points in quarters of a cell, on grid lines too."""
    rows, columns = blocked.shape
    return zip(
        rng.integers(1, SCALE * columns, size=n).tolist(),
        rng.integers(1, SCALE * rows, size=n).tolist(),
        strict=True,
    )


@pytest.mark.parametrize('seed', SEEDS)
def test_no_path_is_shorter(seed: int):
    rng = np.random.default_rng(seed)
    blocked = random_map(rng) if seed % 2 else random_blocks(rng)
    space = GridSpace.from_blocked(blocked)
    for a, b in zip(random_points(rng, blocked, 12), random_points(rng, blocked, 12), strict=True):
        start, goal = (tuple(x / SCALE for x in point) for point in (a, b))
        if not (space.contains(start) and space.contains(goal)):
            continue
        expected, result = shortest_length(blocked, a, b), exact(space, start, goal)
        assert result.length == pytest.approx(expected, abs=MARGINS), (blocked, start, goal)
        if result.status is PlannerStatus.SOLVED:
            assert path_collisions(result.path, blocked, 1.0) == []


def test_a_path_along_one_line_keeps_clear_of_walls_on_both_sides_of_it():
    """It bends at (5, 10) and (5, 1): a wall between them begins on one side, on the other one."""
    blocked = np.zeros((12, 9), dtype=bool)
    blocked[3:10, 5:], blocked[1, :5] = True, True
    result = exact(GridSpace.from_blocked(blocked), (7.5, 10.5), (2.5, 0.5))
    expected = shortest_length(blocked, (30, 42), (10, 2))
    assert result.length == pytest.approx(expected, abs=MARGINS)
    assert path_collisions(result.path, blocked, 1.0) == []


@pytest.mark.skipif(not SCENARIO.exists(), reason=f'HNR_MAPS has no {SCENARIO.name}')
def test_a_scenario_of_moving_ai_has_shortest_paths():
    """Every 150th request, from cell centre to cell centre, and no path longer than the octile."""
    blocked = load_map(SCENARIO.with_suffix('')).data >= 65
    space = GridSpace.from_blocked(blocked)
    for line in SCENARIO.read_text().splitlines()[1::150]:
        *ends, octile = map(float, line.split()[4:9])
        start, goal = (ends[0] + 0.5, ends[1] + 0.5), (ends[2] + 0.5, ends[3] + 0.5)
        result = exact(space, start, goal)
        inside = (tuple(int(SCALE * x) for x in point) for point in (start, goal))
        expected = shortest_length(blocked, *inside)
        assert result.lower_bound == pytest.approx(expected, abs=1e-8)
        # A margin of 4e-7 cells at each bend, on a map of this size.
        assert result.length - 1e-8 <= expected + 1e-6 * len(result.path)
        assert result.lower_bound <= octile + 1e-6
        assert path_collisions(result.path, blocked, 1.0) == []


def test_the_solver_detects_a_path_that_is_too_long():
    blocked = np.zeros((5, 5), dtype=bool)
    blocked[1:4, 2] = True
    space = GridSpace.from_blocked(blocked)
    found = plan(
        space, (0.5, 2.5), (4.5, 2.4), algorithm='rrt', seed=0, simplify=False, time_limit=math.inf
    )
    assert found.length > shortest_length(blocked, (2, 10), (18, 10)) + MARGINS


def test_batches_of_any_size_give_the_same_path():
    space = GridSpace.from_blocked(np.random.default_rng(3).random((60, 60)) < 0.2)
    cells = np.argwhere(space.largest_component())
    ends = [space.cell_centres(*cell) for cell in cells[[0, -1]]]
    whole = exact(space, *ends)
    assert whole.status is PlannerStatus.SOLVED
    cut = exact(space, *ends, max_iterations=whole.iterations - 1)
    assert cut.status is PlannerStatus.ITERATION_LIMIT
    again = exact(space, *ends, max_iterations=whole.iterations, seed=5)
    np.testing.assert_array_equal(whole.path, again.path)


def test_the_seed_is_reported_and_changes_nothing():
    space = GridSpace.from_blocked(np.random.default_rng(3).random((60, 60)) < 0.2)
    cells = np.argwhere(space.largest_component())
    ends = [space.cell_centres(*cell) for cell in cells[[0, -1]]]
    first, second = (exact(space, *ends, seed=seed) for seed in (1, 2))
    assert (first.seed, second.seed) == (1, 2)
    np.testing.assert_array_equal(first.path, second.path)
    np.testing.assert_array_equal(first.samples, second.samples)


def test_nothing_is_searched_again_for_a_better_path():
    blocked = np.zeros((30, 30), dtype=bool)
    blocked[10:, 15] = True
    space = GridSpace.from_blocked(blocked)
    once = exact(space, (5.5, 25.5), (25.5, 25.5), clearance=2.0)
    often = exact(space, (5.5, 25.5), (25.5, 25.5), clearance=2.0, optimize_iterations=5)
    assert often.iterations == once.iterations > 0
    np.testing.assert_array_equal(often.path, once.path)
    assert often.lower_bound < often.length


# -- limits --------------------------------------------------------------------------------------


def noise(n: int) -> tuple[GridSpace, tuple]:
    """Return a map that takes long to search, and its ends."""
    space = GridSpace.from_blocked(np.random.default_rng(1).random((n, n)) < 0.3)
    cells = np.argwhere(space.largest_component())
    return space, tuple(space.cell_centres(*cell) for cell in cells[[0, -1]])


def test_a_search_that_is_cut_has_a_bound_that_grows():
    space, ends = noise(100)
    shortest = exact(space, *ends).length
    bounds = [exact(space, *ends, max_iterations=n).lower_bound for n in (1, 10, 100, 1000)]
    assert math.dist(*ends) <= bounds[0] < bounds[-1] < shortest
    assert bounds == sorted(bounds)


def test_a_search_that_is_interrupted_anywhere_has_a_bound(monkeypatch: pytest.MonkeyPatch):
    """Also where the only open cone is just being expanded, so that none is open."""
    monkeypatch.setattr(interruption, 'CHECK_INTERVAL', 0.0)
    blocked = np.zeros((20, 12), dtype=bool)
    blocked[:16, 3] = blocked[4:, 6] = blocked[:16, 9] = True
    for name in ('begin', 'expand'):  # interpreted also where machine code is loaded
        monkeypatch.setattr(polyanya, name, interpreted(getattr(polyanya, name)))
    space = GridSpace.from_blocked(blocked)
    problem = make_problem(space, np.array([1.5, 2.5]), np.array([10.5, 2.5]), 0.0)
    planner = Polyanya().for_space(space)
    whole = planner.start(problem, stream(0))
    whole.advance(1000)
    assert whole.solved
    for n in range(1000):
        search, checks = planner.start(problem, stream(0)), count()
        search.advance(1)
        try:
            with interruptible(lambda: next(checks) >= n):  # noqa: B023
                search.advance(1000)
        except Interrupted:
            assert search.lower_bound <= whole.lower_bound
            continue
        break
    assert n > 10 and search.lower_bound == whole.lower_bound


def test_the_clock_and_a_cancellation_end_it():
    space, ends = noise(400)
    late = exact(space, *ends, time_limit=0.0)
    assert late.status is PlannerStatus.TIMEOUT and late.cut_by_time
    cancel = threading.Event()
    cancel.set()
    cancelled = exact(space, *ends, cancel=cancel)
    assert cancelled.status is PlannerStatus.CANCELLED
    for result in (late, cancelled):
        assert result.path.shape == (0, 2)
        assert math.dist(*ends) <= result.lower_bound < math.inf


# -- goal regions --------------------------------------------------------------------------------


def points_of_region(space, blocked, goal, radius, rng) -> np.ndarray:
    """Return free points of a disc: on its rim, where it meets lines of cells, and inside."""
    angles = rng.uniform(0.0, 2.0 * math.pi, 12)
    points = [goal + (1.0 - 1e-9) * radius * np.array([math.cos(a), math.sin(a)]) for a in angles]
    for axis in (0, 1):
        for line in range(blocked.shape[1 - axis] + 1):
            across = line - goal[axis]
            if abs(across) < radius:
                along = (1.0 - 1e-7) * math.sqrt(radius**2 - across**2)
                for shift in (-1e-7, 1e-7):
                    for side in (-1.0, 1.0):
                        ends = (line + shift, goal[1 - axis] + side * along)
                        points.append(np.array(ends if axis == 0 else ends[::-1]))
    points += list(rng.uniform(0.0, blocked.shape[::-1], (8, 2)))
    kept = [p for p in points if math.dist(p, goal) <= radius and space.contains(p)]
    return np.array(kept).reshape(-1, 2)


@pytest.mark.parametrize('seed', range(20))
def test_no_point_of_a_goal_region_is_nearer(seed: int):
    rng = np.random.default_rng(seed)
    blocked = random_map(rng)
    space = GridSpace.from_blocked(blocked)
    for start in random_points(rng, blocked, 3):
        start = tuple(x / SCALE for x in start)
        goal, radius = rng.uniform(-1.0, np.add(blocked.shape[::-1], 1.0)), rng.choice([0.3, 1, 4])
        if not space.contains(start):
            continue
        result = exact(space, start, goal, goal_radius=radius)
        points = points_of_region(space, blocked, goal, radius, rng)
        lengths = [exact(space, start, point).length for point in points]
        if result.status is not PlannerStatus.SOLVED:
            assert min(lengths, default=math.inf) == math.inf
            continue
        assert math.dist(result.path[-1], goal) <= radius
        assert path_collisions(result.path, blocked, 1.0) == []
        if result.iterations > 0:  # else the start lies in the region
            assert result.length <= min(lengths, default=math.inf) + MARGINS
            assert result.lower_bound == pytest.approx(result.length, abs=MARGINS)


def test_a_region_is_reached_past_the_slab_that_is_seen_first():
    """The wall's near side is in the region too, but a longer way off."""
    blocked = np.zeros((20, 20), dtype=bool)
    blocked[9, :18] = True
    space = GridSpace.from_blocked(blocked)
    result = exact(space, (1.5, 2.5), (1.5, 12.5), goal_radius=3.0)
    around = math.dist((1.5, 2.5), (18.0, 9.0)) + 1.0 + math.dist((18.0, 10.0), (1.5, 12.5)) - 3.0
    assert result.length == pytest.approx(around, abs=MARGINS)
    near = exact(space, (1.5, 2.5), (1.5, 12.5), goal_radius=4.0)
    assert near.length == pytest.approx(6.0, abs=MARGINS)


def test_a_space_that_is_no_grid_is_refused():
    with pytest.raises(RequestError, match=r'polyanya plans in a GridSpace, got a BoxSpace'):
        exact(BoxSpace((0.0, 0.0), (1.0, 1.0)), (0.1, 0.1), (0.9, 0.9))
