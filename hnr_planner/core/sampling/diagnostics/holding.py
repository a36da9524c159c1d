"""
Holding times: numbers of consecutive draws of a chain that are the same point.

Every argument ``draws`` is (n_chains, n_draws, dim). A walk repeats its point where the chord
contains no other number (a zero chord), and where it rejects a move. Long holding times are the
sign of a stuck chain in draws alone.
"""

from hnr_planner.core.checks import Floats
import numpy as np
from numpy.typing import NDArray


def repeats(draws: Floats) -> NDArray[np.int64]:
    """Return the number of draws of each chain (n_chains,) that equal the draw before."""
    return _repeated(draws).sum(axis=1)


def longest_holding_time(draws: Floats) -> NDArray[np.int64]:
    """Return the largest number of consecutive draws on one point, of each chain (n_chains,)."""
    repeated = _repeated(draws)
    number = np.arange(1, repeated.shape[1] + 1)
    arrival = np.maximum.accumulate(np.where(repeated, 0, number), axis=1)
    return 1 + (number - arrival).max(axis=1)


def frozen(draws: Floats) -> NDArray[np.bool_]:
    """Return (n_chains, dim) bool: whether a coordinate has one value in all draws of a chain."""
    return (draws == draws[:, :1]).all(axis=1)


def _repeated(draws: Floats) -> NDArray[np.bool_]:
    """Return (n_chains, n_draws - 1) bool: whether draw k + 1 of a chain equals draw k."""
    return (draws[:, 1:] == draws[:, :-1]).all(axis=2)
