"""Simplified paths: free, with the same ends, never longer, for a bounded amount of work."""

import math
import os
from pathlib import Path
import subprocess
import sys
from test.brute_force import path_collisions
from test.core.planning.searches import plan
from test.laws import maps
from test.sweeps import IN_FULL, sweep

from hnr_planner.core import (
    BallSpace,
    BoxSpace,
    DifferenceSpace,
    GridSpace,
    OracleSpace,
    RequestError,
    simplify,
    Space,
)
from hnr_planner.core.lengths import path_length
from hnr_planner.core.planning.homology import NO_ISLANDS
from hnr_planner.core.planning.postprocessing.shortcuts import pull, skip
from numba import njit
import numpy as np
from numpy.typing import NDArray
import pytest

BLOCKED = maps.rooms(60, 80, 10, seed=4)
ORIGIN = (2.0, -1.0, 0.4)
SPACE = GridSpace.from_blocked(BLOCKED, 0.1, ORIGIN)
START, GOAL = SPACE.cell_centres(2, 2), SPACE.cell_centres(57, 75)


def chain(seed: int) -> NDArray[np.float64]:
    result = plan(SPACE, START, GOAL, algorithm='hit_and_run', seed=seed, simplify=False)
    assert len(result.path) > 5
    return result.path


@pytest.mark.parametrize('seed', range(20))
def test_a_simplified_path_is_free_shorter_and_has_the_same_ends(seed: int):
    path = chain(seed)
    before = path.copy()
    shorter = simplify(SPACE, path, seed=seed)
    np.testing.assert_array_equal(path, before)
    np.testing.assert_array_equal(shorter[[0, -1]], path[[0, -1]])
    assert path_length(shorter) < path_length(path)
    assert path_collisions(shorter, BLOCKED, 0.1, ORIGIN) == []


def test_again_and_again_it_never_gets_longer():
    path = chain(0)
    for seed in range(30):
        shorter = simplify(SPACE, path, seed=seed, max_iterations=200)
        assert path_length(shorter) <= path_length(path)
        path = shorter
    assert path_collisions(path, BLOCKED, 0.1, ORIGIN) == []


def test_a_path_around_one_corner_is_pulled_taut():
    """The shortest path touches the corner of the wall; a simplified path comes within 1 %."""
    blocked = np.zeros((40, 40), dtype=bool)
    blocked[:30, 20] = True
    space = GridSpace.from_blocked(blocked)
    shortest = 2 * math.hypot(15.0, 28.0) + 1.0
    for seed in range(20):
        path = plan(space, (5, 2), (36, 2), algorithm='rrt', seed=seed, simplify=False).path
        assert path_length(simplify(space, path, seed=seed)) <= 1.01 * shortest


def test_a_chain_of_sixty_thousand_vertices_becomes_a_hundred():
    blocked = maps.rooms(400, 400, 20, seed=3)
    space = GridSpace.from_blocked(blocked)
    cells = np.argwhere(space.largest_component())
    ends = space.cell_centres(*cells[[0, -1]].T)
    path = plan(
        space, *ends, algorithm='hit_and_run', seed=4, time_limit=60.0, simplify=False
    ).path
    assert len(path) > 60_000
    shorter = simplify(space, path, seed=0)
    assert len(shorter) < 150
    assert path_length(shorter) < 1000
    assert path_collisions(shorter, blocked, 1.0) == []


def test_a_straight_path_stays_as_it_is():
    straight = np.array([START, START + (0.1, 0.05)])
    np.testing.assert_array_equal(simplify(SPACE, straight, seed=0), straight)


def test_the_same_seed_gives_the_same_path():
    path = chain(1)
    np.testing.assert_array_equal(simplify(SPACE, path, seed=3), simplify(SPACE, path, seed=3))


def test_no_work_and_no_time_leave_the_path_as_it_is():
    path = chain(2)
    np.testing.assert_array_equal(simplify(SPACE, path, seed=0, max_iterations=0), path)
    np.testing.assert_array_equal(simplify(SPACE, path, seed=0, time_limit=0.0), path)


@pytest.mark.parametrize('every', [False, True])
@pytest.mark.parametrize('budget', [0, 1, 10, 100, 1000])
def test_the_number_of_visibility_tests_is_never_exceeded(budget: int, every: bool):
    points = SPACE.to_kernel(chain(3))
    kept = np.zeros(len(points), dtype=np.int64)
    assert skip(SPACE.data, NO_ISLANDS, points, kept, 1, every, budget)[1] <= budget
    assert pull(SPACE.data, NO_ISLANDS, points, 1, SPACE.margin, budget)[2] <= budget


COMPILING = """
import numpy as np
from hnr_planner.core import GridSpace, simplify
blocked = np.zeros((40, 40), bool)
blocked[:30, 20] = True
space = GridSpace.from_blocked(blocked)
path = [(5, 2), (2, 38), (38, 38), (36, 2)]
first, second = (simplify(space, path, seed=0, time_limit=0.5) for _ in range(2))
assert len(first) > 2 and np.array_equal(first, second), (first, second)
"""


@pytest.mark.sweep
def test_compilation_does_not_count_in_the_time_limit(tmp_path: Path):
    environment = dict(os.environ, NUMBA_CACHE_DIR=str(tmp_path))
    done = subprocess.run(
        [sys.executable, '-c', COMPILING],
        env=environment,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ('path', 'words'),
    [
        ([START], 'at least two points'),
        ([START, GOAL], 'segment 0'),
        ([START, START, GOAL], 'segment 1'),
        ([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]], 'shape'),
        ([START, (np.nan, 0.0)], 'finite'),
    ],
)
def test_a_path_that_is_none_is_refused(path, words: str):
    with pytest.raises(RequestError, match=words):
        simplify(SPACE, path, seed=0)


# -- spaces that sample their segments, and more dimensions --------------------------------------


def shortcuts_of_vertices(space: Space, path: NDArray, seed: int, n_tries: int = 1000) -> NDArray:
    """Shorten by plain random shortcuts: drop what lies between two vertices if that is free."""
    rng = np.random.default_rng(seed)
    for _ in range(n_tries):
        i, j = sorted(rng.integers(len(path), size=2))
        if j - i > 1 and space.is_motion_valid(path[i], path[j]):
            path = np.concatenate([path[: i + 1], path[j:]])
    return path


@njit
def _is_beside_wall(x):
    return not (0.4 < x[0] < 0.6 and x[1] < 0.8)


def wall(dim: int) -> OracleSpace:
    """Return a unit cube with a wall that ends below its upper face."""
    return OracleSpace(
        _is_beside_wall,
        [0.0] * dim,
        [1.0] * dim,
        resolution=0.01,
    )


def balls(dim: int) -> DifferenceSpace:
    """Return a cube with a large ball in its middle and small ones around."""
    rng = np.random.default_rng(dim)
    centres = rng.uniform(1.0, 9.0, (20, dim))
    centres[0] = 5.0
    obstacles = [BallSpace(x, 4.0 if k == 0 else 1.5) for k, x in enumerate(centres)]
    return DifferenceSpace(BoxSpace([0.0] * dim, [10.0] * dim), *obstacles)


#: Seeds of the searches; interpreted, they take less time than their kernels to compile.
SEEDS = range(8) if IN_FULL else range(2)


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ('build', 'dim', 'start', 'goal'),
    [
        (wall, 2, [0.1, 0.1], [0.9, 0.1]),
        (wall, 3, [0.1, 0.1, 0.1], [0.9, 0.1, 0.1]),
        sweep(wall, 7, [0.1] * 7, [0.9] + [0.1] * 6),
        (balls, 3, [0.5] * 3, [9.5] * 3),
        (balls, 5, [0.5] * 5, [9.5] * 5),
    ],
    ids=['wall 2', 'wall 3', 'wall 7', 'balls 3', 'balls 5'],
)
def test_no_path_is_left_raw_or_longer_than_by_plain_shortcuts(build, dim: int, start, goal):
    space = build(dim)
    for seed in SEEDS:
        request = {'seed': seed, 'time_limit': math.inf}
        raw = plan(space, start, goal, simplify=False, **request).path
        result = plan(space, start, goal, **request)
        assert space.is_path_free(result.path)
        assert 'no shortcut is free' not in result.message
        plain = path_length(shortcuts_of_vertices(space, raw, seed))
        assert result.length <= 1.02 * plain
        assert result.length < path_length(raw)


def test_a_path_without_a_free_shortcut_is_said_to_have_none():
    """A corridor so narrow that every vertex of its path is needed."""
    blocked = np.ones((5, 5), dtype=bool)
    blocked[1, 1:4] = blocked[1:4, 3] = False
    space = GridSpace.from_blocked(blocked)
    taut = simplify(space, [(1.5, 1.5), (3.5, 1.5), (3.5, 3.5)], seed=0)
    assert path_length(taut) < 4.0
    result = plan(space, (1.5, 1.5), (3.5, 3.5), seed=0, time_limit=math.inf)
    assert ('no shortcut is free' in result.message) == (
        result.length == result.first_solution.length
    )
