"""Polyanya finds the shortest path, by an independent solver in whole numbers."""

import math
from test.brute_force import path_collisions
from test.visibility_graph import SCALE, shortest_length

from hnr_planner.core import BoxSpace, GridSpace, plan, PlannerStatus, Polyanya, RequestError
import numpy as np
import pytest

SEEDS = range(40)
#: What margins at corners add to a length at most [cells].
MARGINS = 1e-6


def exact(space, start, goal, **arguments):
    arguments = {'time_limit': math.inf, 'max_iterations': 100_000, **arguments}
    return plan(space, start, goal, algorithm=Polyanya(), **arguments)


def random_map(rng: np.random.Generator) -> np.ndarray:
    return rng.random(rng.integers(2, 10, size=2)) < rng.choice([0.15, 0.3, 0.45])


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
    blocked = random_map(rng)
    space = GridSpace.from_blocked(blocked)
    for a, b in zip(random_points(rng, blocked, 12), random_points(rng, blocked, 12), strict=True):
        start, goal = (tuple(x / SCALE for x in point) for point in (a, b))
        if not (space.contains(start) and space.contains(goal)):
            continue
        expected, result = shortest_length(blocked, a, b), exact(space, start, goal)
        assert result.length == pytest.approx(expected, abs=MARGINS), (blocked, start, goal)
        if result.status is PlannerStatus.SOLVED:
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


def test_a_space_that_is_no_grid_is_refused():
    with pytest.raises(RequestError, match=r'polyanya plans in a GridSpace, got a BoxSpace'):
        exact(BoxSpace((0.0, 0.0), (1.0, 1.0)), (0.1, 0.1), (0.9, 0.9))
