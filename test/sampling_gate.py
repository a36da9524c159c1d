"""
Statistical tests of a walk on a region.

A walk is a function ``step(points (n, dim), rng) -> (n, dim)`` that moves every point by one step.
A test returns a p-value: uniform for a right walk, tiny for a wrong one. Tests T1, T2, T3 and T5
look at one step from a fixed point, at the law that a step keeps, at its reversibility, and at
the ends of the chord. Stationarity alone certifies little: several wrong walks keep the law.
"""

from collections.abc import Callable
from test.regions import Points, Region

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats

Step = Callable[[Points, np.random.Generator], Points]

SQUARES = 16
"""The unit square of (direction, position) is cut into so many squares each way."""

N_AXES = 3
"""Above two dimensions, directions are looked at along so many random axes."""

ALPHA = 1e-6 / 150
"""Right walks have fewer p-values than 150: with fresh seeds, one run in 1e6 would fail."""


N_ONE_STEP = 300_000
"""Steps from one point: with so many, T1 and T5 catch every mutant of the gate."""

N_LAW = 50_000
"""Points of T2, of T3, and of a ball walk's step: so many catch the mutants named for them."""


def one_step(
    region: Region, step: Step, point: ArrayLike, n: int, seed: int
) -> tuple[Points, Points]:
    """
    Return what n steps from one point were: directions (n, dim) and positions (n,) on the chord.

    Directions are unit vectors, turned so that their largest coordinate is positive.
    """
    points = np.tile(np.asarray(point, dtype=float), (n, 1))
    moves = step(points, np.random.default_rng(seed)) - points
    directions = moves / np.linalg.norm(moves, axis=1, keepdims=True)
    largest = np.abs(directions).argmax(axis=1)[:, None]
    directions *= np.sign(np.take_along_axis(directions, largest, 1))
    lower, upper = region.chords(points, directions)
    position = ((moves * directions).sum(axis=1) - lower) / (upper - lower)
    return directions, position


def t1_uniform_on_the_square(directions: Points, position: Points) -> float:
    """
    T1: p-value of the chi-square test over SQUARES x SQUARES squares.

    One side is the position on the chord. The other is the angle of the direction or, above two
    dimensions, the square of its coordinate along a random axis, whose law is
    Beta(1/2, (dim - 1)/2): the least of the p-values for N_AXES axes, times their number.
    """
    if not ((position > 0) & (position < 1)).all():
        return 0.0
    rows = _sixteenths(directions)
    column = (position * SQUARES).astype(int)
    counts = [np.bincount(row * SQUARES + column, minlength=SQUARES**2) for row in rows]
    return float(min(1.0, len(rows) * min(stats.chisquare(each).pvalue for each in counts)))


def _sixteenths(directions: Points) -> list[NDArray[np.int64]]:
    """Sort directions (n, dim) into SQUARES equally likely lots, in one way or in N_AXES."""
    dim = directions.shape[1]
    if dim == 2:
        angles = np.arctan2(directions[:, 1], directions[:, 0]) / np.pi % 1.0
        return [(angles * SQUARES).astype(int) % SQUARES]
    axes = np.random.default_rng(0).normal(size=(N_AXES, dim))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    edges = stats.beta.ppf(np.linspace(0, 1, SQUARES + 1)[1:-1], 0.5, (dim - 1) / 2)
    return [np.searchsorted(edges, along**2) for along in axes @ directions.T]


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
    """T2: p-value that n exactly uniform points, after some steps, fall as n others that stay."""
    rng = np.random.default_rng(seed)
    points = region.uniform(n, rng)
    for _ in range(n_steps):
        points = step(points, rng)
    return same_law(region.cell_of(points), region.cell_of(region.uniform(n, rng)))


def t3_reversibility(region: Region, step: Step, n: int, seed: int) -> float:
    """T3 (Bowker): p-value that moves between two cells are as frequent forth as back."""
    rng = np.random.default_rng(seed)
    points = region.uniform(n, rng)
    pairs = region.cell_of(points) * region.n_cells + region.cell_of(step(points, rng))
    moves = np.bincount(pairs, minlength=region.n_cells**2).reshape(region.n_cells, -1)
    both = moves + moves.T
    seen = np.triu(both > 0, k=1)
    statistic = ((moves - moves.T)[seen] ** 2 / both[seen]).sum()
    return float(stats.chi2.sf(statistic, seen.sum()))


def ball_step(region: Region, radius: float, *, segment_visible: bool) -> Step:
    """Return the ball walk by its definition: to a uniform point of a ball, if it may, or stay."""

    def step(points: Points, rng: np.random.Generator) -> Points:
        n, dim = points.shape
        directions = rng.normal(size=(n, dim))
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        length = radius * rng.random(n) ** (1 / dim)
        moved = points + length[:, None] * directions
        free = region.depth(moved) > 0
        if segment_visible:
            free &= length < region.chords(points, directions)[1]
        return np.where(free[:, None], moved, points)

    return step


def same_ball_step(
    step: Step, other: Step, point: ArrayLike, radius: float, n: int, seed: int
) -> float:
    """Return the p-value that n steps from a point in a ball follow one law, stays included."""
    points = np.tile(np.asarray(point, dtype=float), (n, 1))
    rng = np.random.default_rng(seed)
    lots = [_ball_cells((walk(points, rng) - points) / radius) for walk in (step, other)]
    return same_law(*lots)


def _ball_cells(moves: Points) -> NDArray[np.int64]:
    """Sort moves in the unit ball by direction and by share of its volume; 0 for none."""
    length = np.linalg.norm(moves, axis=1)
    moves = moves / np.where(length > 0, length, 1.0)[:, None]
    share = np.minimum(length ** moves.shape[1] * SQUARES, SQUARES - 1).astype(int)
    return np.where(length > 0, 1 + _sixteenths(moves)[0] * SQUARES + share, 0)


def same_law(cells: NDArray[np.int64], others: NDArray[np.int64]) -> float:
    """Return the p-value that two lots of draws fall into cells by one law (chi-square)."""
    n_cells = max(cells.max(), others.max()) + 1
    counts = np.array([np.bincount(lot, minlength=n_cells) for lot in (cells, others)])
    return float(stats.chi2_contingency(counts[:, counts.any(axis=0)]).pvalue)
