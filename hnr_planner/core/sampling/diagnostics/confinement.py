"""
Chains confined to a region of the set that others leave.

All draws together are divided into cells with equal numbers of draws, by repeated cuts at the
median of the coordinate in which the chains differ most. A chain that mixes enters every cell; a
chain that never entered a cell although it made enough draws is confined. This test detects what
the R-hat of single coordinates cannot: regions that differ only in how coordinates go together. It
cannot detect a region that no chain has entered, nor a region smaller than a cell.
"""

import math

from hnr_planner.core.checks import Floats
import numpy as np
from numpy.typing import NDArray

#: Largest number of cells.
CELLS_MAX = 16
#: Probability that any chain of independent draws misses a cell.
FALSE_ALARM = 1e-6


def count_missed_cells(draws: Floats, time: float) -> tuple[NDArray[np.int64], int]:
    """
    Return how many cells each chain never entered (n_chains,), and how many cells there are.

    There are at most ``CELLS_MAX`` cells, and as few as it takes for chains of independent draws
    to enter all of them, but for the probability ``FALSE_ALARM``.

    Parameters
    ----------
    draws : (n_chains, n_draws, dim)
        Finite draws.
    time : float
        Autocorrelation time within the chains [draws]: the longer, the fewer and larger cells.

    """
    n_chains, n_draws, dim = draws.shape
    n_cells = _number_of_cells(n_draws / time, n_chains)
    points = draws.reshape(-1, dim)
    chain = np.repeat(np.arange(n_chains), n_draws)
    cells = [np.arange(len(points))]
    while len(cells) < n_cells:
        cells = [half for cell in cells for half in _halves(cell, points, chain)]
    visits = np.array([np.bincount(chain[cell], minlength=n_chains) for cell in cells])
    return (visits == 0).sum(axis=0), n_cells


def _number_of_cells(n_independent: float, n_chains: int) -> int:
    """
    Return the largest number of cells, a power of two, that every mixing chain enters.

    The probability that one of ``n_chains`` chains of ``n_independent`` independent draws misses
    a cell is at most ``FALSE_ALARM``. The number is at most ``CELLS_MAX``.
    """
    n_cells = CELLS_MAX
    while n_cells > 1 and n_cells * n_chains * math.exp(-n_independent / n_cells) > FALSE_ALARM:
        n_cells //= 2
    return n_cells


def _halves(cell: NDArray, points: Floats, chain: NDArray) -> tuple[NDArray, NDArray]:
    """
    Cut a cell at the median of the coordinate that separates chains most; return both halves.

    ``cell`` and its halves are indices into ``points`` (n, dim), the draws of all chains, and into
    ``chain`` (n,), the number of the chain of each draw.
    """
    inside = points[cell]
    inside = inside - inside.mean(axis=0)
    count = np.maximum(np.bincount(chain[cell]), 1)
    sums = np.array([np.bincount(chain[cell], weights) for weights in inside.T])
    between = (sums**2 / count).sum(axis=1)
    total = (inside**2).sum(axis=0)
    explained = np.divide(between, total, out=np.zeros_like(total), where=total > 0.0)
    order = np.argsort(inside[:, explained.argmax()], kind='stable')
    middle = len(cell) // 2
    return cell[order[:middle]], cell[order[middle:]]
