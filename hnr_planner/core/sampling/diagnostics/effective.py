"""
Effective sample size, R-hat and what follows from them, for one quantity of several chains.

``chains`` is (n_chains, n_draws), with 4 draws or more. Every chain is cut in two halves, so that
a drift within one shows as a difference between two. The formulas are those of Vehtari et al.
(2021), with Geyer's initial monotone sequence, and give the numbers of arviz. They part from it
where nothing varies: arviz takes constant chains for independent draws, and here they count as a
single one.
"""

import math

from hnr_planner.core.checks import Floats
from hnr_planner.core.sampling.diagnostics.ranks import folded, rank_normalised
import numpy as np

#: The tails are what lies beyond these quantiles.
TAILS = (0.05, 0.95)


def r_hat(chains: Floats) -> float:
    """
    Return how much wider all chains are together than each by itself; 1 for chains that agree.

    The larger of two: of the rank-normalised values, and of their folded ones, which tell chains
    that agree on the mean and not on the spread. inf where no chain moves.
    """
    halves = split(chains)
    return max(_r_hat(rank_normalised(halves)), _r_hat(rank_normalised(folded(halves))))


def ess_bulk(chains: Floats) -> float:
    """Return how many independent draws would tell as much about the middle of the law."""
    return effective_size(rank_normalised(split(chains)))


def ess_tail(chains: Floats) -> float:
    """Return how many independent draws would tell as much about the worse of the two tails."""
    quantiles = np.quantile(chains, TAILS)
    return min(effective_size(split((chains <= q).astype(float))) for q in quantiles)


def ess_mean(chains: Floats) -> float:
    """Return how many independent draws would tell as much about the mean."""
    return effective_size(split(chains))


def time_within(chains: Floats) -> float:
    """
    Return the autocorrelation time [draws] that the chains show, each by itself.

    Chains that are confined to different parts look as quick as they are in their part.
    """
    covariances = _autocovariances(_rescaled(split(chains)))
    if covariances[0] == 0.0:
        return math.inf
    return _autocorrelation_time(covariances / covariances[0], chains.size)


def split(chains: Floats) -> Floats:
    """Return the first halves, then the second halves; the middle one of an odd number is left."""
    half = chains.shape[1] // 2
    return np.concatenate([chains[:, :half], chains[:, -half:]])


def effective_size(chains: Floats) -> float:
    """Return the effective sample size for the mean of chains (m, n), which are not split."""
    m, n = chains.shape
    chains = _rescaled(chains)
    if not chains.any():
        return 1.0
    covariances = _autocovariances(chains)
    within = covariances[0] * n / (n - 1)
    total = covariances[0] + (chains.mean(axis=1).var(ddof=1) if m > 1 else 0.0)
    return chains.size / _autocorrelation_time(1.0 - (within - covariances) / total, chains.size)


def _rescaled(chains: Floats) -> Floats:
    """Return values between -1 and 1, about 0, whose squares are neither lost nor infinite."""
    centred = chains - chains.mean()
    largest = np.abs(centred).max()
    return centred / largest if np.ptp(chains) > 0.0 else np.zeros_like(chains)


def _r_hat(chains: Floats) -> float:
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
    Return the sum of the autocorrelations over all lags, before and after, as far as it is seen.

    Sums over two neighbouring lags are positive and falling for a reversible chain: what comes
    after the first that is not positive is noise (Geyer, "Practical Markov chain Monte Carlo",
    1992, section 3.3). Chains whose draws repel each other are not credited with more than
    n log10(n) draws.
    """
    n = len(autocorrelations)
    last = max((n - 3) // 2, 0)
    even, odd = autocorrelations[: 2 * last + 2].reshape(-1, 2).T.copy()
    even[0] = 1.0
    pairs = even + odd
    ended = np.flatnonzero(pairs <= 0.0)
    end = int(ended[0]) if len(ended) else last
    falling = np.minimum.accumulate(pairs[:end])
    time = -1.0 + 2.0 * falling.sum() + max(even[end], 0.0)
    return max(float(time), 1.0 / math.log10(n_draws))
