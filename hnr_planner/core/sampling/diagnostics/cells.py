"""
How far from a known law, and how slow: what shows once a set is cut into cells.

Cells are given by their numbers 0, 1, ..., one for each draw; how a set is cut is the caller's.
"""

import math
from typing import NamedTuple

from hnr_planner.core.checks import check_count, Floats
from hnr_planner.core.errors import RequestError
import numpy as np
from numpy.typing import ArrayLike, NDArray

#: A gap of the spectrum below this is rounding.
NO_GAP = 1e-12


class TotalVariation(NamedTuple):
    """
    Distance of the law of draws from a known law, seen through cells: 0 for equal, at most 1.

    Attributes
    ----------
    plug_in : float
        Distance of the observed shares: too large, because chance alone makes a distance.
    floor : float
        The mean of ``plug_in`` for draws of the known law itself, whose standard deviation is
        about .30 / sqrt(n). For equal cells it is sqrt((n_cells - 1) / (2 pi n)).
    lower_bound : float
        One half of the draws chooses the cells that have too many, the other says by how much.
        Its mean is at most the distance; it may be below 0.

    """

    plug_in: float
    floor: float
    lower_bound: float


def total_variation(cells: ArrayLike, shares: ArrayLike) -> TotalVariation:
    """
    Measure how far from a known law independent draws are, for instance the ends of many chains.

    Parameters
    ----------
    cells : (n,) int
        The cell of every draw; two or more.
    shares : (n_cells,)
        The probability of every cell: its part of the set's volume, for the uniform law.

    Raises
    ------
    RequestError
        When the shares are not probabilities, or a cell is none of theirs.

    """
    law = _check_shares(shares)
    numbers = _check_cells(cells, 1)
    n = len(numbers)
    if n < 2 or numbers.max() >= len(law):
        raise RequestError(
            f'cells must be 2 or more numbers below {len(law)}, got {n} up to '
            f'{numbers.max(initial=0)}'
        )
    observed = [np.bincount(numbers[half::2], minlength=len(law)) for half in (0, 1)]
    plug_in = 0.5 * float(np.abs(sum(observed) / n - law).sum())
    floor = float(np.sqrt(law * (1.0 - law) / (2.0 * math.pi * n)).sum())
    excess = [counts / counts.sum() - law for counts in observed]
    lower_bound = sum(float(excess[1 - half][excess[half] > 0.0].sum()) for half in (0, 1)) / 2.0
    return TotalVariation(plug_in, floor, lower_bound)


def relaxation_time(cells: ArrayLike, lag: int = 1) -> float:
    """
    Estimate the relaxation time [draws] of a reversible walk from its moves between cells.

    It is 1 / (1 - lambda), lambda the second largest eigenvalue of the walk: what decays slowest
    decays by 1 - 1 / time at each draw. The eigenvalue is taken from the moves counted over
    ``lag`` draws, forth and back together. Moves between cells and not an autocorrelation,
    because the error has a known sign: functions that are constant on cells are some of all, so
    but for noise the answer is never above the true time, and it comes nearer with finer cells
    and with a longer lag, whose eigenvalue is taken to its power 1 / lag. An autocorrelation is
    that of one function, which may miss what is slow, and at long lags it is all noise.

    Parameters
    ----------
    cells : (n_chains, n_draws) int
        The cell of every draw, in the order in which the chains made them.
    lag : int
        Draws between the two ends of a move; well below the answer.

    Returns
    -------
    float
        At least 1; inf where some cells were never left for the others.

    Raises
    ------
    RequestError
        When an argument is malformed, or the chains are not longer than the lag.

    """
    numbers, lag = _check_cells(cells, 2), check_count('lag', lag, 1)
    if numbers.shape[1] <= lag or not len(numbers):
        raise RequestError(f'cells must have chains longer than lag {lag}, got {numbers.shape}')
    visited = np.unique(numbers)
    n, place = len(visited), np.searchsorted(visited, numbers)
    pairs = place[:, :-lag] * n + place[:, lag:]
    moves = np.bincount(pairs.ravel(), minlength=n * n).reshape(n, n)
    both = moves + moves.T
    root = np.sqrt(both.sum(axis=1))
    seen = root > 0.0
    both, root = both[np.ix_(seen, seen)], root[seen]
    if len(root) < 2:
        return math.inf
    second = np.linalg.eigvalsh(both / np.outer(root, root))[-2]
    gap = 1.0 - max(float(second), 0.0) ** (1.0 / lag)
    return math.inf if gap < NO_GAP else 1.0 / gap


def _check_cells(cells: ArrayLike, ndim: int) -> NDArray[np.int64]:
    numbers = np.asarray(cells)
    if numbers.ndim != ndim or not np.issubdtype(numbers.dtype, np.integer):
        raise RequestError(
            f'cells must be whole numbers in {ndim} dimension{"s" * (ndim > 1)}, '
            f'got {numbers.dtype} {numbers.shape}'
        )
    if numbers.size and numbers.min() < 0:
        raise RequestError(f'cells must be at least 0, got {numbers.min()}')
    return numbers.astype(np.int64)


def _check_shares(shares: ArrayLike) -> Floats:
    law = np.asarray(shares, dtype=np.float64)
    if law.ndim != 1 or not (law >= 0.0).all() or not abs(law.sum() - 1.0) < 1e-9:
        raise RequestError(
            f'shares must be probabilities (n_cells,), got shape {law.shape} and sum {law.sum():g}'
        )
    return law
