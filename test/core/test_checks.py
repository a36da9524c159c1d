"""Checks of arguments: seeds of every kind become a whole number that repeats the run."""

from hnr_planner.core import BoxSpace, RequestError, sample
from hnr_planner.core.checks import check_seed
import numpy as np
import pytest

SEQUENCE = np.random.SeedSequence(5)


def test_a_whole_number_is_its_own_seed():
    assert [check_seed(seed) for seed in (0, 7, np.int32(3), 2**70)] == [0, 7, 3, 2**70]


@pytest.mark.parametrize('made', [None, np.random.PCG64(1), np.random.default_rng(1), SEQUENCE])
def test_a_seed_of_any_kind_becomes_a_whole_number(made):
    seed = check_seed(made)
    assert type(seed) is int
    assert 0 <= seed < 2**63
    assert check_seed(seed) == seed


def test_a_seed_sequence_gives_one_seed_and_its_children_others():
    children = np.random.SeedSequence(5).spawn(100)
    assert check_seed(SEQUENCE) == check_seed(np.random.SeedSequence(5))
    assert len({check_seed(child) for child in [SEQUENCE, *children]}) == 101


def test_a_generator_gives_one_seed_after_the_other_as_its_own_seed_repeats_them():
    first, second = np.random.default_rng(3), np.random.default_rng(3)
    seeds = [check_seed(first) for _ in range(3)]
    assert seeds == [check_seed(second) for _ in range(3)]
    assert len(set(seeds)) == 3
    # A bit generator is the state of a generator.
    assert check_seed(np.random.PCG64(3)) == seeds[0]


def test_the_seed_drawn_from_a_generator_repeats_its_draws():
    box = BoxSpace([0.0], [1.0])
    draws = sample(box, [0.5], 9, seed=np.random.default_rng(8))
    seed = check_seed(np.random.default_rng(8))
    np.testing.assert_array_equal(draws, sample(box, [0.5], 9, seed=seed))


@pytest.mark.parametrize('seed', [-1, 0.5, 'seed', np.random.RandomState(0), [1, 2]])
def test_what_is_no_seed_is_refused(seed):
    with pytest.raises(RequestError, match='seed must be'):
        check_seed(seed)
