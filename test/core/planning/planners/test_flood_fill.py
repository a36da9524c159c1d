"""The flood fill: a path wherever there is one, by few cells where obstacles are small."""

import math
from test.brute_force import path_collisions

from hnr_planner.core import GridSpace
from hnr_planner.core.planning.planner import make_problem
from hnr_planner.core.planning.planners.flood_fill import FloodFill
import numpy as np
from numpy.typing import NDArray
import pytest

Floats = NDArray[np.float64]

#: Any goal radius [cells] that is no distance between grid points.
RADIUS = 2.3


def noise(side: int, seed: int, fraction: float) -> GridSpace:
    """Return a map of side x side cells of 1 m, of which a fraction is blocked."""
    return GridSpace.from_blocked(np.random.default_rng(seed).random((side, side)) < fraction)


def free_points(space: GridSpace, n: int, seed: int) -> Floats:
    """Return ``n`` points (n, 2) [m] inside random free cells."""
    rng = np.random.default_rng(seed)
    cells = np.argwhere(~space.blocked)
    cells = cells[rng.integers(len(cells), size=n)]
    return space.cell_centres(*cells.T) + rng.uniform(-0.4, 0.4, (n, 2))


def filled(space: GridSpace, start: Floats, goal: Floats, radius: float = 0.0) -> FloodFill:
    """Return the flood fill of a request after it has gone on as far as it can."""
    fill = FloodFill(make_problem(space, start, goal, radius))
    fill.advance(space.data.labels.size)
    return fill


@pytest.mark.parametrize('seed', range(40))
@pytest.mark.parametrize('radius', [0.0, RADIUS])
def test_a_path_is_found_exactly_where_there_is_one(seed: int, radius: float):
    space = noise(16, seed, 0.4)
    start, goal = free_points(space, 2, seed)
    fill = filled(space, start, goal, radius)
    reachable = space.connected(start, goal)
    if radius > 0.0:
        reachable = space.region_reachable(start, goal, radius)
    assert fill.solved == reachable
    if reachable:
        path = space.from_kernel(fill.path)
        assert path_collisions(path, space.blocked, 1.0) == []
        np.testing.assert_allclose(path[0], start, atol=1e-12)
        assert math.dist(path[-1], goal) <= radius + 1e-12


def test_both_outcomes_are_among_these_requests():
    for radius in (0.0, RADIUS):
        outcomes = set()
        for seed in range(40):
            space = noise(16, seed, 0.4)
            outcomes.add(filled(space, *free_points(space, 2, seed), radius).solved)
        assert outcomes == {False, True}


def test_the_goal_region_may_lie_around_a_point_outside_the_map():
    space = GridSpace.from_blocked(np.zeros((5, 40), dtype=bool))
    fill = filled(space, np.array([0.5, 2.5]), np.array([1040.0, 2.5]), 1001.0)
    assert fill.solved
    assert math.dist(fill.path[-1] - space.frame.RIM, (1040.0, 2.5)) <= 1001.0
    assert not filled(space, np.array([0.5, 2.5]), np.array([1e9, 2.5]), 1.0).solved


@pytest.mark.parametrize('batch', [1, 13])
def test_the_path_does_not_depend_on_the_size_of_the_batches(batch: int):
    space = noise(40, 1, 0.3)
    start, goal = np.argwhere(space.largest_component())[[0, -1]] + 0.5
    whole = filled(space, start[::-1], goal[::-1])
    fill = FloodFill(make_problem(space, start[::-1], goal[::-1], 0.0))
    n_cells = 0
    while not fill.solved:
        n_cells += fill.advance(batch)
    assert n_cells < space.data.labels.size
    assert fill.advance(batch) == 0
    np.testing.assert_array_equal(fill.path, whole.path)


@pytest.mark.parametrize('seed', range(5))
def test_in_noise_it_spreads_to_few_cells_beside_the_path(seed: int):
    space = noise(400, seed, 0.3)
    cells = np.argwhere(space.largest_component())
    start, goal = space.cell_centres(*cells[[0, -1]].T)
    fill = FloodFill(make_problem(space, start, goal, 0.0))
    n_cells = fill.advance(space.data.labels.size)
    length = np.hypot(*np.diff(fill.path, axis=0).T).sum()
    assert length <= 1.7 * math.dist(start, goal)
    assert n_cells <= 3.0 * length
