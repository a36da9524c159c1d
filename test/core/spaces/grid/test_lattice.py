"""Rough paths over the lattice of a grid: free, with the right ends, and round the short way."""

import math
from test.brute_force import path_collisions
from test.laws import maps

from hnr_planner.core import GridSpace, plan, simplify
from hnr_planner.core.lengths import path_length
from hnr_planner.core.spaces.grid.lattice import BLOCKS_MAX, SIDE_MIN
from hnr_planner.maps import spiral
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest


def rough(space: GridSpace, start, goal):
    """Rough path between two points of the map frame, in the map frame; None for none."""
    path = space.rough_path(space.to_kernel(np.array(start)), space.to_kernel(np.array(goal)))
    return None if path is None else space.from_kernel(path)


@settings(max_examples=60, deadline=None)
@given(
    rows=st.integers(1, 70),
    columns=st.integers(1, 70),
    density=st.sampled_from([0.0, 0.02, 0.2, 0.5]),
    seed=st.integers(0, 10**6),
)
def test_rough_paths_are_free_on_any_map(rows: int, columns: int, density: float, seed: int):
    blocked = maps.speckle(rows, columns, density, seed)
    space = GridSpace.from_blocked(blocked)
    free, rng = np.argwhere(~blocked), np.random.default_rng(seed)
    for _ in range(5 if len(free) else 0):
        start, goal = (space.cell_centres(*free[rng.integers(len(free))]) for _ in range(2))
        path = rough(space, start, goal)
        if path is not None:
            assert path_collisions(path, blocked, 1.0) == []
            np.testing.assert_allclose(path[[0, -1]], [start, goal], atol=1e-9)


@pytest.mark.parametrize('seed', range(5))
def test_there_is_one_through_every_door_that_is_as_wide_as_a_block(seed: int):
    blocked = np.kron(maps.rooms(60, 80, 10, seed), np.ones((SIDE_MIN, SIDE_MIN), dtype=bool))
    space = GridSpace.from_blocked(blocked)
    free, rng = np.argwhere(space.largest_component()), np.random.default_rng(seed)
    for _ in range(20):
        start, goal = space.cell_centres(*free[rng.integers(len(free), size=2)].T)
        path = rough(space, start, goal)
        assert path is not None
        assert path_collisions(path, blocked, 1.0) == []


def test_where_no_path_leads_there_is_none():
    blocked = np.zeros((40, 40), dtype=bool)
    blocked[:, 20] = True
    space = GridSpace.from_blocked(blocked)
    assert rough(space, (5.0, 5.0), (35.0, 5.0)) is None
    assert rough(space, (5.0, 5.0), (20.5, 5.0)) is None


def test_pulled_taut_it_goes_the_short_way_round():
    """A wall with a way round at both ends; the middle of the wall is past the middle."""
    blocked = np.zeros((60, 60), dtype=bool)
    blocked[10:55, 30] = True
    space = GridSpace.from_blocked(blocked)
    for start_y, corner in ((20.0, 10.0), (48.0, 55.0)):
        start, goal = (10.0, start_y), (50.0, start_y)
        shortest = 2 * math.hypot(20.0, abs(start_y - corner)) + 1
        taut = simplify(space, rough(space, start, goal), seed=0)
        assert path_length(taut) <= 1.02 * shortest


def test_a_large_map_has_no_more_blocks_than_a_small_one():
    path = rough(
        GridSpace.from_blocked(np.zeros((2000, 1500), bool)), (1.5, 1.5), (1498.5, 1998.5)
    )
    assert path is not None
    assert len(path) <= 2 * BLOCKS_MAX


@pytest.mark.parametrize('seed', range(3))
def test_an_optimized_path_is_never_longer_than_the_first(seed: int):
    problem = spiral(1.2)
    space = GridSpace.from_blocked(problem.blocked, problem.resolution)
    first = plan(space, problem.start, problem.goal, seed=seed)
    better = plan(space, problem.start, problem.goal, seed=seed, optimize_iterations=1)
    assert better.length <= first.length
    assert path_collisions(better.path, problem.blocked, problem.resolution) == []
    np.testing.assert_array_equal(better.path[[0, -1]], [problem.start, problem.goal])
