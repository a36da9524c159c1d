"""
Chains that keep to a part of the set while others are elsewhere.

All draws together are halved, and the halves again, each time at the median of the coordinate in
which the chains differ most. A chain that mixes enters every part; one that never entered a part
with as many draws as it has is confined. This sees what R-hat of single coordinates cannot: parts
that differ only in how coordinates go together. What no chain has entered, no diagnosis sees.
"""

import math

from hnr_planner.core.checks import Floats
import numpy as np
from numpy.typing import NDArray

PARTS_MAX = 16
#: Chains that mix are called confined so rarely.
FALSE_ALARM = 1e-6


def parts_missed(draws: Floats, time: float) -> tuple[NDArray[np.int64], int]:
    """
    Return how many parts each chain (n_chains,) never entered, and how many parts there are.

    Parameters
    ----------
    draws : (n_chains, n_draws, dim)
        Finite.
    time : float
        Autocorrelation time within the chains [draws]: the longer, the fewer parts can be told.

    """
    n_chains, n_draws, dim = draws.shape
    n_parts = _parts_to_tell(n_draws / time, n_chains)
    points = draws.reshape(-1, dim)
    chain = np.repeat(np.arange(n_chains), n_draws)
    parts = [np.arange(len(points))]
    while len(parts) < n_parts:
        parts = [half for part in parts for half in _halves(part, points, chain)]
    visits = np.array([np.bincount(chain[part], minlength=n_chains) for part in parts])
    return (visits == 0).sum(axis=0), n_parts


def _parts_to_tell(size: float, n_chains: int) -> int:
    """Return the most parts that n_chains of so many independent draws all enter."""
    n_parts = PARTS_MAX
    while n_parts > 1 and n_parts * n_chains * math.exp(-size / n_parts) > FALSE_ALARM:
        n_parts //= 2
    return n_parts


def _halves(part: NDArray, points: Floats, chain: NDArray) -> tuple[NDArray, NDArray]:
    """Cut a part (row numbers of points) at the median of its most telling coordinate."""
    inside = points[part]
    inside = inside - inside.mean(axis=0)
    count = np.maximum(np.bincount(chain[part]), 1)
    sums = np.array([np.bincount(chain[part], weights) for weights in inside.T])
    between = (sums**2 / count).sum(axis=1)
    total = (inside**2).sum(axis=0)
    told = np.divide(between, total, out=np.zeros_like(total), where=total > 0.0)
    order = np.argsort(inside[:, told.argmax()], kind='stable')
    middle = len(part) // 2
    return part[order[:middle]], part[order[middle:]]
