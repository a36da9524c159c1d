"""
Draws that repeat: what a stuck chain looks like when only its points are kept.

A walk repeats its point where the chord has no other number (a zero chord), or where it rejects.
"""

from hnr_planner.core.checks import Floats
import numpy as np
from numpy.typing import NDArray


def repeats(draws: Floats) -> NDArray[np.int64]:
    """Return how many draws of each chain (n_chains,) equal the one before them."""
    return _repeated(draws).sum(axis=1)


def longest_stay(draws: Floats) -> NDArray[np.int64]:
    """Return the most draws in a row that each chain (n_chains,) spent on one point."""
    repeated = _repeated(draws)
    number = np.arange(1, repeated.shape[1] + 1)
    arrived = np.maximum.accumulate(np.where(repeated, 0, number), axis=1)
    return 1 + (number - arrived).max(axis=1)


def frozen(draws: Floats) -> NDArray[np.bool_]:
    """Return which coordinates of each chain (n_chains, dim) never change."""
    return (draws == draws[:, :1]).all(axis=1)


def _repeated(draws: Floats) -> NDArray[np.bool_]:
    return (draws[:, 1:] == draws[:, :-1]).all(axis=2)
