"""
Chains confined to fine patterns are distinguished, and chains of one law are not.

False alarms. ``FALSE_ALARM`` bounds their probability for independent draws of any number; the
bound is held to exact hypergeometric tails, and to frequencies at a level that shows in few runs.
Every simulation has a fixed seed and states its size.
"""

from collections.abc import Callable
from itertools import product
from test.core.sampling.diagnostics.chains import autoregressive
from test.sweeps import sweep_but

from hnr_planner.core import BallWalk, diagnose, GridSpace, sample
from hnr_planner.core.sampling.diagnostics import separation
from hnr_planner.core.sampling.diagnostics.separation import (
    assignments,
    compare_pairs,
    FALSE_ALARM,
    log_tail,
    split,
)
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy import stats

Floats = NDArray[np.float64]


def on_a_board(n_squares: int, n_draws: int, dim: int = 2, seed: int = 0) -> Floats:
    """Return four chains of independent draws: two on the black squares, two on the white."""
    draws = np.random.default_rng(seed).random((4, 4 * n_draws, dim))
    colour = np.floor(draws[:, :, :2] * n_squares).sum(axis=2) % 2
    chosen = [draws[k][colour[k] == (k >= 2)][:n_draws] for k in range(4)]
    return np.stack(chosen)


def independent(seed: int, n_chains: int = 4, n_draws: int = 400) -> Floats:
    return np.random.default_rng(seed).random((n_chains, n_draws, 2))


# -- what is caught


@pytest.mark.parametrize(
    ('n_squares', 'n_draws', 'dim'),
    [(2, 400, 2), (8, 500, 2), (8, 5000, 2), (32, 5000, 2), (64, 5000, 2), (8, 5000, 3)],
)
def test_chains_on_squares_of_two_colours_are_not_converged(n_squares, n_draws, dim):
    """No marginal differs, and half of the draws of each chain have an equal in the other."""
    found = diagnose(on_a_board(n_squares, n_draws, dim))
    assert found.r_hat.max() < 1.01
    assert not found.cells_missed.any() or n_squares == 2
    assert not found.converged
    assert found.separated[:2, 2:].any()
    assert not found.separated[:2, :2].any() and not found.separated[2:, 2:].any()
    np.testing.assert_array_equal(found.separated, found.separated.T)


def test_the_message_names_the_pair_that_differs_most():
    message = diagnose(on_a_board(8, 5000)).message
    assert 'keep to different regions: 9' in message
    assert '(4 of 6 pairs of chains differ)' in message


def test_slow_chains_on_squares_are_caught_as_well():
    """The draws of every chain are held for two steps each: half as many count."""
    held = np.repeat(on_a_board(8, 2500), 2, axis=1)
    assert diagnose(held).separated[:2, 2:].all()


def test_squares_smaller_than_the_distance_of_draws_are_not_seen():
    """As the page says: 65,536 squares for 10,000 training draws."""
    assert not diagnose(on_a_board(256, 5000)).separated.any()


# -- false alarms


def test_the_bound_is_above_the_exact_tail():
    """All tables of two chains of 12 draws, and 2,000 larger ones."""
    rng = np.random.default_rng(0)
    small = [(a, 12 - a, b, 12 - b) for a, b in product(range(13), repeat=2)]
    large = rng.integers(0, 300, (2000, 4)).tolist()
    n_close = 0
    for a, b, c, d in [*small, *large]:
        bound = log_tail(np.array([[a, b], [c, d]]))
        exact = stats.hypergeom.logsf(a - 1, a + b + c + d, a + b, a + c)
        assert bound[0, 1] == bound[1, 0] >= exact - 1e-9
        n_close += -20.0 < bound[0, 1] < exact + 5.0
    assert n_close > 20, 'a bound that is never near the tail would prove nothing'


@pytest.mark.parametrize('law', ['independent', 'lattice'])
def test_alarms_are_no_more_frequent_than_the_level(law: str, monkeypatch: pytest.MonkeyPatch):
    """1,000 runs at a level of .2: more than 265 alarms have probability 3e-7 at most."""
    monkeypatch.setattr(separation, 'FALSE_ALARM', 0.2)
    alarms = 0
    for seed in range(1000):
        draws = independent(seed, n_draws=100)
        if law == 'lattice':
            draws = np.floor(draws * 5.0)
        alarms += compare_pairs(draws, 1.0).separated.any()
    assert alarms <= 265


def correlated(phi: float) -> Callable[[int], Floats]:
    return lambda seed: autoregressive(phi, 4, 2000, 2, seed)


def ball_walk(seed: int) -> Floats:
    hall = GridSpace.from_blocked(np.zeros((20, 20), bool))
    starts = np.random.default_rng(seed).uniform(0.0, 20.0, (4, 2))
    return sample(hall, starts, 2000, walk=BallWalk(5.0), seed=seed)


CHAINS = {'independent': independent, '.5': correlated(0.5), '.95': correlated(0.95)}
RUNS = 100


def n_alarms(chains: Callable[[int], Floats]) -> int:
    """Return how many of ``RUNS`` runs of chains of one law have separated pairs."""
    return sum(bool(diagnose(chains(seed)).separated.any()) for seed in range(RUNS))


@pytest.mark.parametrize('name', sweep_but(['independent', '.95'], CHAINS))
def test_chains_of_one_law_are_not_separated(name: str):
    """For independent draws two alarms in 100 runs have probability 5e-9 at most."""
    assert FALSE_ALARM * RUNS <= 1e-4
    assert n_alarms(CHAINS[name]) <= 1


def test_walks_that_mix_are_not_separated():
    assert not any(diagnose(ball_walk(seed)).separated.any() for seed in range(10))


# -- mutants


def test_training_on_the_neighbours_in_time_of_test_draws_is_caught(
    monkeypatch: pytest.MonkeyPatch,
):
    """Every other draw for training: in a chain of short steps the nearest draw is the next."""

    def alternate(draws: Floats, time: float) -> tuple[Floats, Floats, int]:
        return draws[:, ::2], draws[:, 1::2], split(draws, time)[2]

    monkeypatch.setattr(separation, 'split', alternate)
    local = correlated(0.999)
    assert sum(bool(compare_pairs(local(seed), 1.0).separated.any()) for seed in range(20)) > 15


def test_a_test_of_correlated_draws_is_caught(monkeypatch: pytest.MonkeyPatch):
    """No lag between the test draws: they count many times over."""

    def without_lag(draws: Floats, time: float) -> tuple[Floats, Floats, int]:
        return split(draws, 0.1)

    monkeypatch.setattr(separation, 'split', without_lag)
    slow = correlated(0.995)
    assert sum(bool(compare_pairs(slow(seed), 400.0).separated.any()) for seed in range(20)) > 5


def test_a_classifier_that_sees_marginals_only_is_caught(monkeypatch: pytest.MonkeyPatch):
    """It cannot distinguish black squares from white ones."""

    def of_one_coordinate(training: Floats, testing: Floats) -> NDArray[np.int64]:
        return assignments(training[:, :, :1], testing[:, :, :1])

    monkeypatch.setattr(separation, 'assignments', of_one_coordinate)
    assert not diagnose(on_a_board(8, 5000)).separated.any()


def test_a_bound_without_the_number_of_tests_is_caught(monkeypatch: pytest.MonkeyPatch):
    """At a level of .2 for each pair, of 120 pairs, most runs of 16 chains raise an alarm."""
    monkeypatch.setattr(separation, 'FALSE_ALARM', 0.2 * 120 * (400).bit_length())
    alarms = sum(compare_pairs(independent(seed, 16), 1.0).separated.any() for seed in range(200))
    assert alarms > 200 * 0.26
