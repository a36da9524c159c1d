"""
Effective sample size (ESS), R-hat and autocorrelation time of one quantity of several chains.

``chains`` is (n_chains, n_draws), with 4 draws or more. Every chain is split in two halves, so
that a drift within one chain shows as a difference between its halves. The formulas are those of
Vehtari et al. (2021), with Geyer's initial monotone sequence, and give arviz's numbers. They
differ from arviz where nothing varies: constant chains count as a single draw here, and as
independent draws in arviz.
"""

import math

from hnr_planner.core.checks import Floats
from hnr_planner.core.sampling.diagnostics.ranks import folded, rank_normalised
import numpy as np

#: Quantiles that the tail ESS is computed for.
TAILS = (0.05, 0.95)


def r_hat(chains: Floats) -> float:
    """
    Return R-hat: the spread of all chains together over that within chains; 1 where they agree.

    It is the larger of two values: that of the rank-normalised draws, and that of the folded
    draws, which detects chains of equal mean and different spread. It is inf when no half of a
    chain moves.
    """
    halves = split(chains)
    return max(_r_hat(rank_normalised(halves)), _r_hat(rank_normalised(folded(halves))))


def ess_bulk(chains: Floats) -> float:
    """Return the bulk ESS: the effective sample size of the rank-normalised draws."""
    return effective_size(rank_normalised(split(chains)))


def ess_tail(chains: Floats) -> float:
    """Return the tail ESS: the smaller effective sample size for the two quantiles ``TAILS``."""
    quantiles = np.quantile(chains, TAILS)
    return min(effective_size(split((chains <= q).astype(float))) for q in quantiles)


def ess_mean(chains: Floats) -> float:
    """Return the effective sample size for the mean of the quantity, over all chains together."""
    return effective_size(split(chains))


def time_within(chains: Floats) -> float:
    """
    Return the autocorrelation time [draws] within chains, each about its own mean.

    For chains confined to different regions it is the time within these regions. It is inf when no
    half of a chain moves.
    """
    covariances = _autocovariances(_rescaled(split(chains)))
    if covariances[0] == 0.0:
        return math.inf
    return _autocorrelation_time(covariances / covariances[0], chains.size)


def split(chains: Floats) -> Floats:
    """
    Return the first halves of all chains, then the second halves: (2 n_chains, n_draws // 2).

    The middle draw of an odd number of draws is left out.
    """
    half = chains.shape[1] // 2
    return np.concatenate([chains[:, :half], chains[:, -half:]])


def effective_size(chains: Floats) -> float:
    """
    Return the effective sample size for the mean of chains (m, n), which are not split here.

    It is 1 when all values are equal.
    """
    m, n = chains.shape
    chains = _rescaled(chains)
    if not chains.any():
        return 1.0
    covariances = _autocovariances(chains)
    within = covariances[0] * n / (n - 1)
    total = covariances[0] + (chains.mean(axis=1).var(ddof=1) if m > 1 else 0.0)
    return chains.size / _autocorrelation_time(1.0 - (within - covariances) / total, chains.size)


def _rescaled(chains: Floats) -> Floats:
    """Return the values less their mean, scaled into [-1, 1]; zeros if all values are equal."""
    centred = chains - chains.mean()
    largest = np.abs(centred).max()
    return centred / largest if np.ptp(chains) > 0.0 else np.zeros_like(chains)


def _r_hat(chains: Floats) -> float:
    """Return the R-hat of chains (m, n), neither split nor normalised; inf if none varies."""
    n = chains.shape[1]
    within = chains.var(axis=1, ddof=1).mean()
    if within == 0.0:
        return math.inf
    between = chains.mean(axis=1).var(ddof=1)
    return math.sqrt(between / within + (n - 1) / n)


def _autocovariances(chains: Floats) -> Floats:
    """Return the autocovariances (n,) at lags 0, 1, ..., averaged over chains (m, n)."""
    n = chains.shape[1]
    size = 1 << (2 * n - 1).bit_length()
    spectrum = np.fft.rfft(chains - chains.mean(axis=1, keepdims=True), size)
    power = (spectrum.real**2 + spectrum.imag**2).mean(axis=0)
    return np.fft.irfft(power, size)[:n] / n


def _autocorrelation_time(autocorrelations: Floats, n_draws: int) -> float:
    """
    Return the sum of the autocorrelations over all lags, negative ones included [draws].

    For a reversible chain the sums over two neighbouring lags are positive and decreasing: the
    first sum that is not positive, and all later sums, are noise (Geyer, "Practical Markov chain
    Monte Carlo", 1992, Section 3.3). The effective size of antithetic chains is limited to
    n log10(n) draws.
    """
    n = len(autocorrelations)
    last = max((n - 3) // 2, 0)
    even, odd = autocorrelations[: 2 * last + 2].reshape(-1, 2).T.copy()
    even[0] = 1.0
    pairs = even + odd
    noise = np.flatnonzero(pairs <= 0.0)
    end = int(noise[0]) if len(noise) else last
    decreasing = np.minimum.accumulate(pairs[:end])
    time = -1.0 + 2.0 * decreasing.sum() + max(even[end], 0.0)
    return max(float(time), 1.0 / math.log10(n_draws))
