"""
Statistical tests of a walk on a grid of unit cells, with chords found by arithmetic of their own.

A walk is a function ``step(points (n, 2), rng) -> (n, 2)`` that moves every point by one step. A
test returns a p-value: uniform for a right walk, tiny for a wrong one. Tests T1, T2, T3 and T5
look at one step from a fixed point, at the law that a step keeps, at its reversibility, and at
the ends of the chord. Stationarity alone certifies little: several wrong walks keep the law.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numba
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage, stats

Points = NDArray[np.float64]
Step = Callable[[Points, np.random.Generator], Points]

SQUARES = 16
"""The unit square of (direction, position) is cut into so many squares each way."""


@dataclass(frozen=True)
class Region:
    """The largest component of the free cells of a grid, one unit to a cell."""

    occupied: NDArray[np.bool_]

    @cached_property
    def cell_index(self) -> NDArray[np.int64]:
        """Number of every cell of the region (rows, cols), -1 outside."""
        labels, _ = ndimage.label(~self.occupied)
        largest = np.bincount(labels[labels > 0]).argmax()
        index = np.full(self.occupied.shape, -1)
        index[labels == largest] = np.arange((labels == largest).sum())
        return index

    @property
    def n_cells(self) -> int:
        """Number of cells."""
        return int(self.cell_index.max()) + 1

    def uniform(self, n: int, rng: np.random.Generator) -> Points:
        """Draw exactly uniform points (n, 2)."""
        cells = np.argwhere(self.cell_index >= 0)[:, ::-1]
        return cells[rng.integers(len(cells), size=n)] + rng.random((n, 2))

    def cell_of(self, points: Points) -> NDArray[np.int64]:
        """Return the number of the cell of each point; every point must lie in the region."""
        column, row = np.floor(points).astype(int).T
        cells = self.cell_index[row, column]
        assert (cells >= 0).all(), 'a point has left the region'
        return cells

    def chords(self, points: Points, directions: Points) -> tuple[Points, Points]:
        """Return the ends (n,) of the chords through points along directions (both (n, 2))."""
        rows, cols = self.occupied.shape
        return _chords(points, directions, np.argwhere(self.occupied), rows, cols)


@numba.njit
def _chords(points, directions, obstacles, rows, cols):
    """Cut every line with every obstacle, one unit square after the other."""
    lower, upper = np.empty(len(points)), np.empty(len(points))
    for k in range(len(points)):
        x, y = points[k]
        u, v = directions[k]
        lower[k], upper[k] = _cut(x, y, u, v, 0, cols, 0, rows)
        for row, col in obstacles:
            first, last = _cut(x, y, u, v, col, col + 1, row, row + 1)
            if 0 < first <= last:
                upper[k] = min(upper[k], first)
            elif first <= last < 0:
                lower[k] = max(lower[k], last)
    return lower, upper


@numba.njit
def _cut(x, y, u, v, left, right, bottom, top):
    """Return the parameters at which a line enters and leaves a box: the first larger for none."""
    first, last = _cut_slab(x, u, left, right)
    also_first, also_last = _cut_slab(y, v, bottom, top)
    return max(first, also_first), min(last, also_last)


@numba.njit
def _cut_slab(x, u, low, high):
    if u == 0:
        return (-np.inf, np.inf) if low <= x <= high else (np.inf, -np.inf)
    a, b = (low - x) / u, (high - x) / u
    return min(a, b), max(a, b)


def unit(angles: NDArray[np.float64]) -> Points:
    """Return the unit vectors (n, 2) at angles (n,)."""
    return np.stack([np.cos(angles), np.sin(angles)], axis=1)


def one_step(
    region: Region, step: Step, point: tuple[float, float], n: int, seed: int
) -> tuple[Points, Points]:
    """Return (direction / pi, position on the chord), both (n,), of n steps from one point."""
    points = np.tile(np.asarray(point, dtype=float), (n, 1))
    moves = step(points, np.random.default_rng(seed)) - points
    angles = np.arctan2(moves[:, 1], moves[:, 0]) % np.pi
    directions = unit(angles)
    lower, upper = region.chords(points, directions)
    position = ((moves * directions).sum(axis=1) - lower) / (upper - lower)
    return angles / np.pi, position


def t1_uniform_on_the_square(direction: Points, position: Points) -> float:
    """T1: p-value of the chi-square test over SQUARES x SQUARES equal squares."""
    if not ((position > 0) & (position < 1)).all():
        return 0.0
    counts, _, _ = np.histogram2d(direction, position, bins=SQUARES, range=[(0, 1), (0, 1)])
    return float(stats.chisquare(counts.ravel()).pvalue)


def t5_ends(position: Points) -> float:
    """
    T5: p-value that n uniform draws come near the ends of the chord as these do.

    Twice the lesser of two: that none comes nearer than the nearest did, and the chi-square over
    shares of the chord that shrink towards its ends.
    """
    margin = np.minimum(position, 1 - position)
    if margin.min() <= 0:
        return 0.0
    none_nearer = np.exp(len(position) * np.log1p(-2 * margin.min()))
    edges = np.concatenate([[0], 0.5 ** np.arange(12, 0, -1)])
    counts, _ = np.histogram(margin, edges)
    shares = stats.chisquare(counts, 2 * np.diff(edges) * len(position)).pvalue
    return float(min(2 * none_nearer, 2 * shares, 1.0))


def t2_stationarity(region: Region, step: Step, n: int, seed: int, n_steps: int = 3) -> float:
    """T2: from n exactly uniform points, p-value that the cells are uniform after some steps."""
    rng = np.random.default_rng(seed)
    points = region.uniform(n, rng)
    for _ in range(n_steps):
        points = step(points, rng)
    counts = np.bincount(region.cell_of(points), minlength=region.n_cells)
    return float(stats.chisquare(counts).pvalue)


def t3_reversibility(region: Region, step: Step, n: int, seed: int) -> float:
    """T3 (Bowker): p-value that moves between two cells are as frequent forth as back."""
    rng = np.random.default_rng(seed)
    points = region.uniform(n, rng)
    moves = np.zeros((region.n_cells, region.n_cells))
    np.add.at(moves, (region.cell_of(points), region.cell_of(step(points, rng))), 1)
    both = moves + moves.T
    pairs = np.triu(both > 0, k=1)
    statistic = ((moves - moves.T)[pairs] ** 2 / both[pairs]).sum()
    return float(stats.chi2.sf(statistic, pairs.sum()))
