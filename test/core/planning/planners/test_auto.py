"""The planner for any request: solved wherever a flood fill finds a path, and else as before."""

import math
from test.brute_force import path_collisions
from typing import Any

from hnr_planner.core import GridSpace, plan, PlannerStatus, PlanResult
from hnr_planner.core.kernels.streams import stream
from hnr_planner.core.planning.planner import make_problem
from hnr_planner.core.planning.planners.auto import Auto, ROUND
from hnr_planner.core.planning.planners.hit_and_run_connect import HitAndRunConnect
import numpy as np
from numpy.typing import NDArray
import pytest


def solve(space: GridSpace, start: Any, goal: Any, **given: Any) -> PlanResult:
    return plan(space, start, goal, **{'seed': 0, 'time_limit': math.inf, **given})


def strip() -> NDArray[np.bool_]:
    """Return a strip of 600 x 5 cells, at its end a shaft and a gap, both one cell wide."""
    blocked = np.zeros((300, 600), dtype=bool)
    blocked[5, 1:] = True
    blocked[5:300, 1] = True
    blocked[13, 1] = False
    return blocked


def maze(n: int, seed: int) -> NDArray[np.bool_]:
    """Return a maze of n x n rooms of one cell, without loops."""
    rng, blocked = np.random.default_rng(seed), np.ones((2 * n + 1, 2 * n + 1), dtype=bool)
    stack = [(0, 0)]
    blocked[1, 1] = False
    while stack:
        row, column = stack[-1]
        for i, j in rng.permutation([(0, 1), (1, 0), (0, -1), (-1, 0)]).tolist():
            inside = 0 <= row + i < n and 0 <= column + j < n
            if inside and blocked[2 * (row + i) + 1, 2 * (column + j) + 1]:
                blocked[2 * row + 1 + i, 2 * column + 1 + j] = False
                blocked[2 * (row + i) + 1, 2 * (column + j) + 1] = False
                stack.append((row + i, column + j))
                break
        else:
            stack.pop()
    return blocked


@pytest.mark.parametrize('seed', range(3))
def test_a_long_strip_with_a_narrow_end_is_solved(seed: int):
    blocked = strip()
    space = GridSpace.from_blocked(blocked, 0.05)
    result = solve(space, (596.7 * 0.05, 0.085), (24.0, 7.5), seed=seed)
    assert result.status is PlannerStatus.SOLVED
    assert path_collisions(result.path, blocked, 0.05) == []
    if result.planner == 'flood_fill':
        assert result.iterations > ROUND
        assert len(result.samples) == 2 + result.iterations  # those of the search are kept
    again = solve(space, (596.7 * 0.05, 0.085), (24.0, 7.5), seed=seed)
    np.testing.assert_array_equal(result.path, again.path)


@pytest.mark.parametrize('seed', range(3))
@pytest.mark.parametrize('goal_radius', [0.0, 0.3])
def test_a_maze_of_one_cell_is_solved(seed: int, goal_radius: float):
    blocked = maze(40, seed)
    space = GridSpace.from_blocked(blocked, 0.1, (1.0, 2.0, 0.5))
    start, goal = space.cell_centres(1, 1), space.cell_centres(79, 79)
    result = solve(space, start, goal, seed=seed, goal_radius=goal_radius)
    assert result.status is PlannerStatus.SOLVED
    assert path_collisions(result.path, blocked, 0.1, (1.0, 2.0, 0.5)) == []
    np.testing.assert_array_equal(result.path[0], start)
    assert math.dist(result.path[-1], goal) <= goal_radius


def test_a_region_whose_centre_is_blocked_is_flooded_into():
    blocked = maze(40, 1)
    blocked[79, 79] = True
    space = GridSpace.from_blocked(blocked, 0.1)
    goal = space.cell_centres(79, 79)
    result = solve(space, space.cell_centres(1, 1), goal, goal_radius=0.16)
    assert result.status is PlannerStatus.SOLVED
    assert path_collisions(result.path, blocked, 0.1) == []
    assert math.dist(result.path[-1], goal) <= 0.16


@pytest.mark.parametrize('batch', [7, ROUND, 20 * ROUND])
def test_the_winner_does_not_depend_on_the_size_of_the_batches(batch: int):
    space = GridSpace.from_blocked(maze(40, 2))
    problem = make_problem(space, np.array([1.5, 1.5]), np.array([79.5, 79.5]), 0.0)
    search, one_by_one = Auto().start(problem, stream(1)), Auto().start(problem, stream(1))
    trees = HitAndRunConnect().start(problem, stream(1))
    for each, n_iterations in ((search, batch), (one_by_one, 1)):
        while not each.solved:
            each.advance(n_iterations)
    assert ROUND < search.iterations == one_by_one.iterations
    assert search.made_by == one_by_one.made_by == 'flood_fill'
    np.testing.assert_array_equal(search.path, one_by_one.path)
    trees.advance(search.iterations)
    np.testing.assert_array_equal(search.samples, trees.samples)


@pytest.mark.parametrize('seed', range(3))
def test_noise_is_solved_by_few_steps(seed: int):
    blocked = np.random.default_rng(seed).random((600, 600)) < 0.3
    space = GridSpace.from_blocked(blocked, 0.1)
    cells = np.argwhere(space.largest_component())
    start, goal = space.cell_centres(*cells[[0, -1]].T)
    result = solve(space, start, goal, seed=seed)
    assert result.status is PlannerStatus.SOLVED
    assert result.iterations <= 2 * ROUND
    assert path_collisions(result.path, blocked, 0.1) == []


def island(size: int) -> NDArray[np.bool_]:
    """Return free cells around a block of occupied cells."""
    blocked = np.zeros((3 * size, 3 * size), dtype=bool)
    end = 2 * size
    blocked[size:end, size:end] = True
    return blocked


def test_optimized_it_is_the_shortest_and_says_so():
    space = GridSpace.from_blocked(island(4))
    result = solve(space, (2.0, 6.0), (10.0, 6.5), optimize_iterations=1)
    shortest = min(
        math.dist((2.0, 6.0), (4.0, y)) + 4.0 + math.dist((8.0, y), (10.0, 6.5))
        for y in (4.0, 8.0)
    )
    assert result.length == pytest.approx(shortest, abs=1e-6)
    assert result.planner == 'polyanya' and result.message.endswith(', the shortest')
    assert shortest - 1e-6 <= result.lower_bound <= result.length
    assert len(result.samples) > 2  # those of the first search


def test_the_shortest_path_to_a_region_is_proved_too():
    space, request = GridSpace.from_blocked(island(4)), ((2.0, 6.0), (10.0, 6.5))
    result = solve(space, *request, goal_radius=1.0, optimize_iterations=1)
    exact = solve(space, *request, goal_radius=1.0, algorithm='polyanya')
    assert result.message.endswith(', the shortest')
    assert result.length == exact.length == pytest.approx(result.lower_bound, abs=1e-6)
    assert math.dist(result.path[-1], (10.0, 6.5)) <= 1.0


def test_the_work_of_the_exact_search_is_counted():
    space, request = GridSpace.from_blocked(island(4)), ((2.0, 6.0), (10.0, 6.5))
    first = solve(space, *request, seed=1)
    exact = solve(space, *request, algorithm='polyanya')
    both = solve(space, *request, seed=1, optimize_iterations=1)
    assert both.iterations == first.iterations + exact.iterations
    assert both.counts['cones'] == exact.counts['cones'] > 0


@pytest.mark.parametrize('seed', range(5))
def test_no_path_is_shorter_than_its_lower_bound(seed: int):
    rng = np.random.default_rng(seed)
    space = GridSpace.from_blocked(rng.random((40, 40)) < 0.25, 0.1)
    rows, columns = np.nonzero(space.largest_component())
    start, goal = space.cell_centres(rows[[0, -1]], columns[[0, -1]])
    exact = solve(space, start, goal, optimize_iterations=1)
    for given in ({}, {'algorithm': 'rrt'}, {'goal_radius': 0.3}, {'clearance': 0.2}):
        result = solve(space, start, goal, seed=seed, **given)
        assert result.lower_bound <= result.length
        if not given.get('goal_radius'):
            assert result.lower_bound <= exact.lower_bound <= result.length


def test_a_planner_by_name_is_improved_by_itself_alone():
    space = GridSpace.from_blocked(island(4))
    result = solve(space, (2.0, 6.0), (10.0, 6.5), algorithm='rrt', optimize_iterations=2)
    assert result.planner == 'rrt'


def test_where_no_path_exists_no_length_would_do():
    blocked = np.zeros((5, 5), dtype=bool)
    blocked[:, 2] = True
    assert solve(GridSpace.from_blocked(blocked), (0.5, 0.5), (4.5, 0.5)).lower_bound == math.inf
