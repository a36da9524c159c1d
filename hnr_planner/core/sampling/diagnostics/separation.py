"""
Pairs of chains that occupy different points of the set: a classifier two-sample test.

The first half of every chain trains a nearest-neighbour classifier on the joint coordinates: it
assigns a point to the chain of the nearest draw. The second half tests the classifier. Chains of
the same distribution cannot be distinguished. Where draws of two chains are classified better than
by chance, the chains keep to different regions, even if these are so finely interleaved that no
marginal differs.

False alarms. Let C[i, j] count the test draws of chain i that are assigned to chain j. Given the
classifier, independent draws of one distribution are assigned to i or j independently of their
chain, so that C[i, i], given the row and column sums of the 2 x 2 table of i and j, is
hypergeometric. Hoeffding's bound (1963, Theorems 1 and 4) on its tail, summed over all pairs and
all lags that may be chosen, keeps the probability of any alarm below ``FALSE_ALARM``, for any
number of draws.

What it cannot detect: regions much smaller than the distance between neighbouring draws, which in
many dimensions is a large distance; and regions that all chains enter, or that none enters.
"""

import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
import numpy as np
from numpy.typing import NDArray

#: Bound on the probability that any pair of chains of independent draws is called separated.
FALSE_ALARM = 1e-6
#: Least lag between test draws, in autocorrelation times: their correlation is below .05 then.
LAG = 1.5
#: Dimension up to which a search tree is fast, and largest number of draws below and above it.
DIM_FAST, N_FAST, N_SLOW = 5, 20_000, 2_000


class Separation(NamedTuple):
    """
    Result of the test for every pair of chains.

    Attributes
    ----------
    separated : (n_chains, n_chains) bool
        Whether the draws of chains i and j can be distinguished; symmetric, False for i = j.
    accuracy : (n_chains, n_chains)
        Of the test draws of chains i and j that are assigned to one of these two chains, the
        fraction assigned to their own chain; nan if there are no such draws, and for i = j.

    """

    separated: NDArray[np.bool_]
    accuracy: Floats


def compare_pairs(draws: Floats, time: float) -> Separation:
    """
    Test every pair of chains for separation.

    Parameters
    ----------
    draws : (n_chains, n_draws, dim)
        Finite draws.
    time : float
        Autocorrelation time within the chains [draws]: the longer, the fewer test draws.

    """
    training, testing, n_lags = split(draws, time)
    counts = assignments(training, testing)
    right = np.diag(counts)
    both = right[:, None] + right + counts + counts.T
    np.fill_diagonal(both, 0)
    with np.errstate(divide='ignore', invalid='ignore'):
        accuracy = np.where(both > 0, (right[:, None] + right) / both, np.nan)
    n_tests = max(math.comb(len(draws), 2), 1) * n_lags
    separated = log_tail(counts) < math.log(FALSE_ALARM / n_tests)
    np.fill_diagonal(separated, False)
    return Separation(separated, accuracy)


def split(draws: Floats, time: float) -> tuple[Floats, Floats, int]:
    """
    Return training draws, test draws, and the number of lags that could have been chosen.

    Draws are (n_chains, k, dim), each array with its own k, in units of each coordinate's standard
    deviation over the training draws. The distance between test draws in the chain, the lag, is a
    power of two, so that few lags can be chosen. Coordinates that are constant over the training
    draws are dropped.
    """
    n_chains, n_draws, dim = draws.shape
    n_lags = n_draws.bit_length()
    exponent = math.ceil(math.log2(LAG * time)) if time < n_draws else n_lags
    lag = 2 ** min(max(exponent, 1), n_lags)
    n_most = N_FAST if dim <= DIM_FAST else N_SLOW
    half = n_draws // 2
    first = half + lag
    training, testing = (
        part[:, :: max(1, math.ceil(n_chains * part.shape[1] / n_most))]
        for part in (draws[:, :half], draws[:, first::lag])
    )
    extent = np.ptp(training, axis=(0, 1))
    varying = extent > 0.0
    training, testing = (part[:, :, varying] / extent[varying] for part in (training, testing))
    spread = training.std(axis=(0, 1))
    return training / spread, testing / spread, n_lags


def assignments(training: Floats, testing: Floats) -> NDArray[np.int64]:
    """
    Return counts (n_chains, n_chains): how many test draws of chain i are assigned to chain j.

    All counts are 0 if there are no test draws, or if no coordinate varies.
    """
    from scipy.spatial import KDTree  # a quarter of a second, which other diagnostics do without

    n_chains, n_training, dim = training.shape
    if testing.shape[1] == 0 or dim == 0:
        return np.zeros((n_chains, n_chains), dtype=np.int64)
    _, nearest = KDTree(training.reshape(-1, dim)).query(testing.reshape(-1, dim))
    own = np.repeat(np.arange(n_chains), testing.shape[1])
    pairs = own * n_chains + nearest // n_training
    return np.bincount(pairs, minlength=n_chains**2).reshape(n_chains, n_chains)


def log_tail(counts: NDArray[np.int64]) -> Floats:
    """
    Bound the log probability that chance assigns as many draws of chains i and j rightly.

    ``counts`` are those of ``assignments``; the result is (n_chains, n_chains). The 2 x 2 tables
    of i, j and of j, i bound the same probability; both entries are the smaller bound.
    """
    right = np.diag(counts).astype(np.float64)[:, None]
    of_chain, to_chain = right + counts, right + counts.T
    total = right + right.T + counts + counts.T
    bound = np.minimum(
        _hoeffding(right, of_chain, to_chain, total), _hoeffding(right, to_chain, of_chain, total)
    )
    return np.minimum(bound, bound.T)


def _hoeffding(successes: Floats, n: Floats, marked: Floats, total: Floats) -> Floats:
    """
    Return a bound on log P(X >= successes), for a hypergeometric X, by Hoeffding's inequality.

    X is the number of marked items among ``n`` items drawn from ``total``, of which ``marked`` are
    marked. The bound is -n KL(successes / n, marked / total), and 0 where X is expected to be as
    large.
    """
    with np.errstate(divide='ignore', invalid='ignore'):
        q, p = successes / n, marked / total
        kl = np.where(q > 0.0, q * np.log(q / p), 0.0)
        kl += np.where(q < 1.0, (1.0 - q) * np.log((1.0 - q) / (1.0 - p)), 0.0)
        return np.where((total > 0.0) & (q > p), -n * kl, 0.0)
