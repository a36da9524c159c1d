"""
Total variation distance and relaxation time, from draws sorted into cells of a set.

Each draw is given by the index 0, 1, ... of its cell; the caller chooses the cells, which divide
the set.
"""

import math
from typing import NamedTuple

from hnr_planner.core.checks import check_count, Floats
from hnr_planner.core.errors import RequestError
import numpy as np
from numpy.typing import ArrayLike, NDArray

#: A spectral gap below this is rounding.
NO_GAP = 1e-12


class TotalVariation(NamedTuple):
    """
    Estimates of the total variation distance between the distribution of draws and a known one.

    The distance compares the probabilities of the cells: it is 0 for equal probabilities, and at
    most 1.

    Attributes
    ----------
    plug_in : float
        Distance of the observed frequencies of the cells, an estimate that is biased upwards.
    floor : float
        Mean that ``plug_in`` has for n draws of the known distribution itself; the standard
        deviation of ``plug_in`` is then about .30 / sqrt(n). For cells of equal probability the
        floor is sqrt((n_cells - 1) / (2 pi n)).
    lower_bound : float
        Cross-fitted estimate, which is biased downwards: one half of the draws selects the cells
        with more draws than expected, the other half measures the excess of these cells. The
        estimate may be below 0.

    """

    plug_in: float
    floor: float
    lower_bound: float


def total_variation(cells: ArrayLike, shares: ArrayLike) -> TotalVariation:
    """
    Estimate the total variation distance of independent draws from a known distribution.

    The ends of many chains are independent draws; consecutive draws of one chain are not.

    Parameters
    ----------
    cells : (n,) int
        Cell of every draw, n at least 2.
    shares : (n_cells,)
        Known probability of every cell; for the uniform distribution, the cell's fraction of the
        set's volume.

    Raises
    ------
    RequestError
        When the shares are not probabilities, or an entry of ``cells`` is no index into them.

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

    The relaxation time is 1 / (1 - lambda), where lambda is the second largest eigenvalue of the
    walk: the slowest mode decays by the factor lambda at each draw. lambda is computed from the
    counts of moves over ``lag`` draws, in both directions, and taken to the power 1 / lag.

    The error has a known sign: the functions that are constant on cells are a subspace, so that
    apart from noise the estimate is never above the true time. It comes nearer with finer cells
    and a longer lag. The autocorrelation of one function may miss the slowest mode, and is
    dominated by noise at long lags.

    Parameters
    ----------
    cells : (n_chains, n_draws) int
        Cell of every draw, in the order of the chains.
    lag : int
        Draws between the two ends of a move; well below the relaxation time.

    Returns
    -------
    float
        At least 1; inf when no chain moved between two groups of cells, or all stayed in one cell.

    Raises
    ------
    RequestError
        When an argument is malformed, or the chains are not longer than the lag.

    """
    numbers, lag = _check_cells(cells, 2), check_count('lag', lag, 1)
    if numbers.shape[1] <= lag or not len(numbers):
        raise RequestError(f'cells must have chains longer than lag {lag}, got {numbers.shape}')
    visited = np.unique(numbers)
    n, index = len(visited), np.searchsorted(visited, numbers)
    pairs = index[:, :-lag] * n + index[:, lag:]
    moves = np.bincount(pairs.ravel(), minlength=n * n).reshape(n, n)
    both = moves + moves.T
    root = np.sqrt(both.sum(axis=1))
    used = root > 0.0
    both, root = both[np.ix_(used, used)], root[used]
    if len(root) < 2:
        return math.inf
    second = np.linalg.eigvalsh(both / np.outer(root, root))[-2]
    gap = 1.0 - max(float(second), 0.0) ** (1.0 / lag)
    return math.inf if gap < NO_GAP else 1.0 / gap


def _check_cells(cells: ArrayLike, ndim: int) -> NDArray[np.int64]:
    """
    Return ``cells`` as an array of int64 with ``ndim`` dimensions.

    Raises
    ------
    RequestError
        When the cells are not integers of at least 0, or have another number of dimensions.

    """
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
    """Return probabilities (n_cells,); raise RequestError unless they are >= 0 and sum to 1."""
    law = np.asarray(shares, dtype=np.float64)
    if law.ndim != 1 or not (law >= 0.0).all() or not abs(law.sum() - 1.0) < 1e-9:
        raise RequestError(
            f'shares must be probabilities (n_cells,), got shape {law.shape} and sum {law.sum():g}'
        )
    return law
