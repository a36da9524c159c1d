"""ESS, R-hat and standard errors: arviz's numbers, and the truth where it is known."""

import math
from test.core.sampling.diagnostics.chains import autoregressive

from hnr_planner.core import diagnose
from hnr_planner.core.sampling.diagnostics.effective import (
    ess_bulk,
    ess_mean,
    ess_tail,
    r_hat,
    time_within,
)
import numpy as np
import pytest

RNG = np.random.default_rng(1)


def chains(phi, n_chains, n_draws, seed=0):
    return autoregressive(phi, n_chains, n_draws, 1, seed)[:, :, 0]


@pytest.mark.parametrize(
    'values',
    [
        chains(0.0, 4, 1000),
        chains(0.9, 4, 1000),
        chains(0.999, 4, 1000),
        chains(-0.7, 4, 1001),
        chains(-0.99, 4, 1000),
        chains(0.3, 20, 50),
        chains(0.5, 3, 300).round(),
        chains(0.0, 4, 500) + np.arange(4)[:, None],
        chains(0.0, 4, 500) * np.arange(1, 5)[:, None],
        np.cumsum(chains(0.0, 2, 400), axis=1),
        RNG.standard_cauchy((4, 500)),
        *(RNG.normal(size=(2, n_draws)) for n_draws in range(4, 12)),
    ],
    ids=str,
)
def test_the_figures_are_those_of_arviz(values, arviz):
    found = diagnose(values[:, :, None])
    assert found.ess_bulk[0] == pytest.approx(arviz.ess(values, method='bulk'), rel=1e-12)
    assert found.ess_tail[0] == pytest.approx(arviz.ess(values, method='tail'), rel=1e-12)
    assert found.mcse_mean[0] == pytest.approx(arviz.mcse(values, method='mean'), rel=1e-12)
    assert found.r_hat[0] == pytest.approx(arviz.rhat(values), rel=1e-12)


@pytest.mark.parametrize('phi', [-0.5, 0.0, 0.5, 0.9])
def test_the_autocorrelation_time_is_the_known_one(phi):
    """
    Four chains of 250000 draws: (1 + phi) / (1 - phi), to a twentieth.

    That is 7 standard deviations or more in 200 repetitions of every case.
    """
    values = chains(phi, 4, 250_000)
    known = (1 + phi) / (1 - phi)
    assert values.size / ess_mean(values) == pytest.approx(known, rel=0.05)
    assert values.size / ess_bulk(values) == pytest.approx(known, rel=0.05)
    assert time_within(values) == pytest.approx(known, rel=0.05)


def test_the_standard_error_is_how_far_means_are_from_the_truth():
    """200 means of correlated draws, in their standard errors: a spread of 1 to a fifth."""
    values = autoregressive(0.8, 4, 2_000, 200, seed=3)
    scores = values.mean(axis=(0, 1)) / diagnose(values).mcse_mean
    assert scores.std() == pytest.approx(1.0, abs=0.2)


@pytest.mark.parametrize('scale', [1e-140, 1e-20, 1e140])
def test_units_do_not_matter(scale):
    values = autoregressive(0.5, 4, 500, 2, seed=4)
    ours, scaled = diagnose(values), diagnose(values * scale)
    np.testing.assert_allclose(scaled.ess_bulk, ours.ess_bulk)
    np.testing.assert_allclose(scaled.autocorrelation_time, ours.autocorrelation_time)
    np.testing.assert_allclose(scaled.r_hat, ours.r_hat)
    np.testing.assert_allclose(scaled.mcse_mean, ours.mcse_mean * scale)


def test_r_hat_detects_chains_that_differ_in_their_spread_only():
    values = chains(0.0, 4, 1000)
    values[0] *= 3.0
    assert values.mean(axis=1) == pytest.approx(0.0, abs=0.2)
    assert r_hat(values) > 1.05


def test_heavy_tails_hide_no_chain_that_is_elsewhere(arviz):
    """Draws without mean or variance; a variance of the draws themselves detects nothing."""
    values = np.random.default_rng(5).standard_cauchy((4, 1000))
    assert r_hat(values) < 1.01
    values[0] += 3.0
    assert arviz.rhat(values, method='split') < 1.01
    assert r_hat(values) > 1.1


def test_chains_that_never_move_are_worth_one_draw(arviz):
    """Arviz takes them for independent draws."""
    still = np.full((4, 1000), 0.3)
    assert arviz.ess(still) == still.size
    assert ess_bulk(still) == ess_tail(still) == ess_mean(still) == 1.0
    assert r_hat(still) == math.inf
    assert time_within(still) == math.inf


def test_tails_in_which_nothing_varies_are_worth_one_draw():
    """A tenth of the draws lie on the largest value: the upper tail tells nothing."""
    values = np.minimum(chains(0.0, 4, 1000), 1.2)
    assert ess_bulk(values) > 3000
    assert ess_tail(values) == 1.0
