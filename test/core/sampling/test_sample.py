"""Draws: inside, repeatable, counted as asked, and refused where they cannot be."""

from itertools import pairwise
import pickle
from test.laws import maps
from test.laws.spaces import SPACES

from hnr_planner.core import (
    begin_chains,
    BoxSpace,
    GridSpace,
    OracleSpace,
    RequestError,
    sample,
    WALKS,
)
from hnr_planner.core.kernels import modes
import joblib
import numpy as np
import pytest

SPACE = GridSpace.from_blocked(maps.rooms(40, 40, 10, seed=2), 0.1, (1.0, -3.0, 0.6))
START = SPACE.cell_centres(1, 1)


@pytest.mark.parametrize('walk', WALKS)
def test_every_draw_is_free_and_in_the_start_s_component(walk: str):
    draws = sample(SPACE, START, 500, walk=walk, n_chains=3, seed=1)
    assert draws.shape == (3, 500, 2)
    assert SPACE.contains(draws.reshape(-1, 2)).all()
    assert all(SPACE.connected(START, draw) for draw in draws[:, ::50].reshape(-1, 2))


def test_hit_and_run_moves_along_free_segments():
    draws = sample(SPACE, START, 300, seed=2)[0]
    assert SPACE.is_motion_valid(START, draws[0])
    for a, b in pairwise(draws):
        assert SPACE.is_motion_valid(a, b)


def test_coordinate_hit_and_run_moves_along_the_axes():
    space = GridSpace.from_blocked(maps.TWO_ROOMS)
    draws = sample(space, (0.5, 3.5), 300, walk='coordinate_hit_and_run', seed=2)[0]
    assert ((np.diff(draws, axis=0) == 0.0).sum(axis=1) == 1).all()


@pytest.mark.parametrize('walk', WALKS)
def test_the_same_seed_gives_the_same_draws_whatever_the_number_of_chains(walk: str):
    few = sample(SPACE, START, 100, walk=walk, n_chains=2, seed=5)
    many = sample(SPACE, START, 100, walk=walk, n_chains=7, seed=5)
    np.testing.assert_array_equal(few, many[:2])
    assert (many[0] != many[1]).any()
    assert (sample(SPACE, START, 100, walk=walk, seed=6)[0] != few[0]).any()


def test_burn_in_and_thin_leave_out_steps_and_change_none():
    every = sample(SPACE, START, 30, seed=3)
    np.testing.assert_array_equal(sample(SPACE, START, 10, thin=3, seed=3), every[:, 2::3])
    np.testing.assert_array_equal(sample(SPACE, START, 20, burn_in=10, seed=3), every[:, 10:])


@pytest.mark.parametrize('draw', [sample, begin_chains], ids=['sample', 'begin_chains'])
def test_a_seed_is_a_number_a_sequence_or_a_generator(draw):
    def drawn(seed):
        found = (
            draw(SPACE, START, 5, seed=seed) if draw is sample else draw(SPACE, START, seed=seed)
        )
        return found if draw is sample else found.streams

    sequence = np.random.SeedSequence(8)
    np.testing.assert_array_equal(drawn(sequence), drawn(sequence))
    first, second = sequence.spawn(2)
    assert (drawn(first) != drawn(second)).any()
    generator, twin = np.random.default_rng(8), np.random.default_rng(8)
    once = drawn(generator)
    np.testing.assert_array_equal(once, drawn(twin))
    assert (once != drawn(generator)).any(), 'a generator goes on'
    assert (drawn(None) != drawn(None)).any()


def test_no_draws_are_no_error():
    assert sample(SPACE, START, 0, n_chains=2).shape == (2, 0, 2)


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        ({'start': (-50.0, 0.0)}, r'start \[-50.0, 0.0\] is outside the map'),
        ({'start': (np.nan, 0.0)}, 'start must be finite'),
        ({'n_draws': -1}, 'n_draws must be at least 0, got -1'),
        ({'n_draws': 2.5}, 'n_draws must be a whole number, got 2.5'),
        ({'n_chains': 0}, 'n_chains must be at least 1, got 0'),
        ({'burn_in': -1}, 'burn_in must be at least 0, got -1'),
        ({'thin': 0}, 'thin must be at least 1, got 0'),
        ({'walk': 'drunk'}, "walk must be one of .*, got 'drunk'"),
        ({'seed': -3}, 'seed must be at least 0, got -3'),
    ],
)
def test_a_malformed_argument_is_refused(arguments, words: str):
    request = {'start': START, 'n_draws': 10, **arguments}
    with pytest.raises(RequestError, match=words):
        sample(SPACE, **request)


@pytest.mark.interpreted
@pytest.mark.parametrize('name', SPACES)
def test_every_space_can_be_pickled_for_other_processes(name):
    space = SPACES[name]()
    again = pickle.loads(pickle.dumps(space))
    lower, upper = space.bounds
    points = np.random.default_rng(1).uniform(lower, upper, (50, space.dim))
    np.testing.assert_array_equal(again.contains(points), space.contains(points))


def test_jobs_of_joblib_give_the_same_draws():
    space = BoxSpace((0.0, 0.0), (1.0, 2.0))
    options = {'n_chains': 3, 'burn_in': 7, 'thin': 2, 'seed': 1}
    expected = sample(space, (0.5, 0.5), 20, **options)
    with joblib.parallel_config(backend='threading'):
        draws = sample(space, (0.5, 0.5), 20, n_jobs=2, **options)
    np.testing.assert_array_equal(draws, expected)
    draws = sample(space, (0.5, 0.5), 20, n_jobs=2, **options)  # in processes
    np.testing.assert_array_equal(draws, expected)


def test_threads_of_chains_run_kernels_in_the_mode_of_the_caller():
    seen = set()

    def contains(_):
        seen.add(modes.mode())
        return True

    with modes.mode_of_thread(modes.Mode.INTERPRETED):
        space = OracleSpace(contains, (0.0, 0.0), (1.0, 1.0), resolution=0.1)
        sample(space, (0.5, 0.5), 2, n_chains=2, seed=1)
    assert seen == {modes.Mode.INTERPRETED}
