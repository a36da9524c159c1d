"""Draws of all free space: uniform over all components, and a walk within each."""

from collections.abc import Callable
from test.brute_force import path_collisions
from test.laws import maps
from test.sweeps import sweep, sweep_but
import threading

from hnr_planner.core import (
    BoxSpace,
    Cancelled,
    DifferenceSpace,
    FreeSpaceDraws,
    GridSpace,
    RequestError,
    sample_free_space,
    Space,
    SpaceError,
    WALKS,
)
from hnr_planner.core.sampling import free_space
from hnr_planner.core.sampling.free_space import pick_cells, point_in_cell
import numpy as np
import pytest
from scipy import ndimage, stats

#: Two rooms with a door, two cupboards of 4 cells, and corners that touch.
OCCUPIED = maps.drawn(
    '.....#..#..',
    '.#...#..#..',
    '.....######',
    '...........',
    '.....#.....',
    '..#..#...#.',
    '...#.#.....',
)
RESOLUTION, ORIGIN = 0.1, (1.0, -3.0, 0.6)
SPACE = GridSpace.from_blocked(OCCUPIED, RESOLUTION, ORIGIN)
COMPONENTS, N_COMPONENTS = ndimage.label(~OCCUPIED)
#: Thirteen p-values of correct draws are compared with it: one run in a million would fail.
ALPHA = 1e-6 / 13
N_CHAINS, N_DRAWS = 8_000, 3


def in_cells(points: np.ndarray) -> np.ndarray:
    """Return points (..., 2) of the map frame as (column, row) with fractions."""
    x, y, yaw = ORIGIN
    away = points - (x, y)
    turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    return away @ turn / RESOLUTION


def cells_of(points: np.ndarray) -> np.ndarray:
    """Return the number of the free cell of each point, in the order of rows and columns."""
    column, row = np.moveaxis(np.floor(in_cells(points)).astype(int), -1, 0)
    numbers = np.where(OCCUPIED, -1, np.cumsum(~OCCUPIED).reshape(OCCUPIED.shape) - 1)
    cells = numbers[row, column]
    assert (cells >= 0).all(), 'a point that is not free'
    return cells


def over_cells(points: np.ndarray) -> float:
    """Return the p-value that points, independent of each other, are uniform over the cells."""
    counts = np.bincount(cells_of(points), minlength=(~OCCUPIED).sum())
    return float(stats.chisquare(counts).pvalue)


def within_cells(points: np.ndarray) -> float:
    """Return the lesser p-value, of two, that points are uniform within their cells."""
    column, row = np.moveaxis(in_cells(points) % 1.0, -1, 0)
    return min(float(stats.kstest(inside, 'uniform').pvalue) for inside in (column, row))


def many(**arguments: object) -> FreeSpaceDraws:
    """Return short draws, many times, independent of each other."""
    return sample_free_space(SPACE, N_DRAWS, n_chains=N_CHAINS, seed=11, **arguments)


@pytest.mark.parametrize('walk', sweep_but(['hit_and_run'], WALKS))
def test_every_draw_is_uniform_over_all_components(walk: str) -> None:
    # 8,000 independent chains over 57 cells; the law of the first draw, and of the last.
    draws = many(walk=walk)
    for number in (0, N_DRAWS - 1):
        assert over_cells(draws.points[:, number]) > ALPHA
        assert within_cells(draws.points[:, number]) > ALPHA


def test_components_of_consecutive_draws_are_independent() -> None:
    components = many().components
    pairs = stats.contingency.crosstab(components[:, 0], components[:, 1]).count
    assert stats.chi2_contingency(pairs).pvalue > ALPHA


def the_largest_component_only(free, n_draws, rng):
    """Pick cells of one component."""
    labels = SPACE.data.labels.flat[free]
    return pick_cells(free[labels == np.bincount(labels).argmax()], n_draws, rng)


def each_component_alike(free, n_draws, rng):
    """Pick all components with equal probability, whatever their areas."""
    labels = SPACE.data.labels.flat[free]
    return pick_cells(free[labels == rng.integers(1, labels.max() + 1)], n_draws, rng)


def the_middle(cell, shape, rng):
    """Start in the middle of a cell."""
    return np.floor(point_in_cell(cell, shape, rng)) + 0.5


@pytest.mark.parametrize(
    ('name', 'wrong'),
    [
        sweep('pick_cells', the_largest_component_only),
        ('pick_cells', each_component_alike),
        ('point_in_cell', the_middle),
    ],
    ids=['the largest component only', 'each component alike', 'the middle'],
)
def test_wrong_starts_are_caught(
    name: str, wrong: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(free_space, name, wrong)
    first = many().points[:, 0]
    assert min(over_cells(first), within_cells(first)) < ALPHA


@pytest.mark.parametrize('walk', WALKS)
def test_every_draw_is_free_and_in_the_component_it_names(walk: str) -> None:
    points, components, _ = sample_free_space(SPACE, 500, walk=walk, n_chains=2, seed=1)
    assert points.shape == (2, 500, 2) and components.shape == (2, 500)
    column, row = np.moveaxis(np.floor(in_cells(points)).astype(int), -1, 0)
    truth = COMPONENTS[row, column]
    assert len(set(zip(truth.flat, components.flat, strict=True))) == N_COMPONENTS


def test_draws_of_a_component_follow_each_other_along_free_segments() -> None:
    draws = sample_free_space(SPACE, 400, seed=2)
    (points,), (previous,) = draws.points, draws.previous
    assert (previous == -1).sum() == N_COMPONENTS
    assert (previous < np.arange(400)).all()
    assert len(np.unique(previous[previous >= 0])) == 400 - N_COMPONENTS, 'none follows twice'
    for number in np.flatnonzero(previous >= 0):
        segment = [points[previous[number]], points[number]]
        assert not path_collisions(segment, OCCUPIED, RESOLUTION, ORIGIN)


def test_fewer_draws_and_chains_are_the_first_of_more() -> None:
    more = sample_free_space(SPACE, 60, n_chains=3, seed=4).points
    np.testing.assert_array_equal(
        sample_free_space(SPACE, 20, n_chains=2, seed=4).points, more[:2, :20]
    )
    assert (more[0] != more[1]).any()
    assert (sample_free_space(SPACE, 60, seed=5).points != more[0]).any()


def test_thin_leaves_out_steps_and_changes_none() -> None:
    one_component = GridSpace.from_blocked(maps.U_SHAPE)
    every = sample_free_space(one_component, 31, seed=3).points
    np.testing.assert_array_equal(
        sample_free_space(one_component, 11, thin=3, seed=3).points, every[:, ::3]
    )


def test_steps_at_once_change_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    at_once = sample_free_space(SPACE, 100, seed=6).points
    monkeypatch.setattr(free_space, 'STEPS_AT_ONCE', 7)
    np.testing.assert_array_equal(sample_free_space(SPACE, 100, seed=6).points, at_once)


def test_without_a_seed_the_draws_differ_but_can_be_had_again() -> None:
    one, two = sample_free_space(SPACE, 20), sample_free_space(SPACE, 20)
    assert (one.points != two.points).any()
    again = sample_free_space(SPACE, 20, seed=one.seed)
    np.testing.assert_array_equal(again.points, one.points)


def test_cancelled_work_ends_soon() -> None:
    cancel = threading.Event()
    threading.Timer(0.2, cancel.set).start()
    with pytest.raises(Cancelled):  # 10^12 steps otherwise
        sample_free_space(SPACE, 1_000_000, thin=1_000_000, cancel=cancel)


def test_a_sequence_or_a_generator_is_a_seed() -> None:
    for seed in (np.random.SeedSequence(7), np.random.default_rng(7)):
        draws = sample_free_space(SPACE, 20, seed=seed)
        again = sample_free_space(SPACE, 20, seed=draws.seed)
        np.testing.assert_array_equal(again.points, draws.points)


@pytest.mark.parametrize(
    'space',
    [
        BoxSpace([0.0], [1.0]),
        DifferenceSpace(BoxSpace([0] * 3, [1] * 3), BoxSpace([0.4, -1, -1], [0.6, 2, 2])),
    ],
)
def test_a_space_that_is_no_grid_is_refused(space: Space) -> None:
    name = type(space).__name__
    with pytest.raises(RequestError, match=f'needs a GridSpace, .* got a {name}: sample'):
        sample_free_space(space, 100, seed=1)


def test_nothing_free_is_refused() -> None:
    solid = GridSpace.from_blocked(np.ones((3, 3), dtype=bool))
    with pytest.raises(SpaceError, match='no cell is free'):
        sample_free_space(solid, 10)


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        ({'n_draws': 0}, 'n_draws must be at least 1, got 0'),
        ({'n_chains': 0}, 'n_chains must be at least 1, got 0'),
        ({'thin': 0}, 'thin must be at least 1, got 0'),
        ({'walk': 'drunk'}, "walk must be one of .*, got 'drunk'"),
        ({'seed': -3}, 'seed must be at least 0, got -3'),
    ],
)
def test_a_malformed_argument_is_refused(arguments: dict, words: str) -> None:
    with pytest.raises(RequestError, match=words):
        sample_free_space(SPACE, **{'n_draws': 10, **arguments})
