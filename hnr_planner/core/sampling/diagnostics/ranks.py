"""Rank normalisation, which makes diagnostics independent of scale and of heavy tails."""

from functools import lru_cache
from statistics import NormalDist

from hnr_planner.core.checks import Floats
import numpy as np


def rank_normalised(values: Floats) -> Floats:
    """
    Return the standard normal quantile of every value's rank, in the same shape.

    Equal values share their average rank (Vehtari, Gelman, Simpson, Carpenter and Buerkner,
    "Rank-normalization, folding, and localization", 2021, section 4.1).
    """
    _, index, count = np.unique(values.ravel(), return_inverse=True, return_counts=True)
    twice_the_rank = 2 * np.cumsum(count) - count + 1
    return _scores(values.size)[twice_the_rank - 2][index].reshape(values.shape)


def folded(values: Floats) -> Floats:
    """Return the distance of every value from the median of all values, in the same shape."""
    return np.abs(values - np.median(values))


@lru_cache(maxsize=1)
def _scores(n: int) -> Floats:
    """Return the normal quantiles (2 n - 1,) of ranks 1, 1.5, ..., n; cache the last result."""
    below = (np.arange(1.0, (n + 1) / 2 + 0.25, 0.5) - 0.375) / (n + 0.25)
    lower = np.fromiter(map(NormalDist().inv_cdf, below.tolist()), float, len(below))
    scores = np.concatenate([lower, -lower[-2::-1]])
    scores.flags.writeable = False
    return scores
