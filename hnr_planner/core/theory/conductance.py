"""
Conductance Phi of Hit-and-Run: the relative flow across the narrowest cut of a set.

Definition (paper, Section 3.1): the infimum over subsets A of at most half the volume of the
probability that a step from a point drawn uniformly from A ends outside A.

A step from a uniform point amounts to a uniform line and two independent uniform points of one of
its chords. So the flow from A to B in one step is a mean over lines: the sum over the line's
chords of |chord in A| |chord in B| / |chord|. The measure on lines is invariant under motions, and
the flow is symmetric.
"""

import math
from typing import NamedTuple

from hnr_planner.core.checks import check_count, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.theory.rays import lengths_within, pieces
import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

#: The plastic number. Its inverse powers, times k modulo 1, are the coordinates of line k:
#: Roberts's quasirandom sequence R2.
PLASTIC = 1.324717957244746
#: Number of lines in one call of the kernel.
BATCH = 1 << 18


class CellFlow(NamedTuple):
    """
    Flow of one stationary step between the cells of a lattice over a set.

    Attributes
    ----------
    area : (m,)
        Area of the set in each cell [m^2]; cells without any are omitted, so that m is the
        number of cells left.
    flow : (m, m)
        Flow between cells in one step [m^2]: symmetric, with ``area`` as its row sums.
    centre : (m, 2)
        Centre of each cell [m].

    """

    area: Floats
    flow: Floats
    centre: Floats

    @property
    def kernel(self) -> Floats:
        """Transition probabilities (m, m): row i is for a step from a uniform point of cell i."""
        return self.flow / self.area[:, None]

    @property
    def relaxation_time(self) -> float:
        """
        Relaxation time [steps]: 1 / spectral gap of the chain of cells.

        This chain forgets its position within the cell at every step. Its kernel is a projection
        of the true one, so that its relaxation time is never above the true one, and nearer to
        it the finer the cells.
        """
        return 1.0 / (1.0 - _second_eigenpair(self)[0])


class Cut(NamedTuple):
    """
    A partition of a set in two sides, and its conductance.

    Attributes
    ----------
    inside : (m,) bool
        Whether each cell, in the order of ``CellFlow.area``, is on the first side.
    conductance : float
        Flow across the cut over the area of the smaller side.

    """

    inside: NDArray[np.bool_]
    conductance: float


class Estimate(NamedTuple):
    """An estimate from random draws, and its standard error, in the unit of the estimate."""

    value: float
    error: float


def cell_flow(space: Space, shape: tuple[int, int], n_lines: int = 1 << 20) -> CellFlow:
    """
    Return the flow of one step between the cells of a lattice over a set in the plane.

    Parameters
    ----------
    space : Space
        The set.
    shape : (rows, columns)
        Number of cells that the bounds are divided into.
    n_lines : int
        Number of lines of the quadrature over angle and offset.

    """
    if space.dim != 2:
        raise RequestError(f'cells are for the plane, the space has {space.dim} axes')
    rows, columns = (check_count('shape', count, 1) for count in shape)
    check_count('n_lines', n_lines, 1)
    lower, upper = space.bounds
    side = (upper - lower) / (columns, rows)
    reach = float(np.linalg.norm(upper - lower)) / 2.0
    flow, area = np.zeros((rows * columns, rows * columns)), np.zeros(rows * columns)
    for first in range(0, n_lines, BATCH):
        k = np.arange(first, min(first + BATCH, n_lines))
        angle = math.pi * ((0.5 + k / PLASTIC) % 1.0)
        offset = reach * (2.0 * ((0.5 + k / PLASTIC**2) % 1.0) - 1.0)
        along = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        across = np.stack([-along[:, 1], along[:, 0]], axis=1)
        points = (lower + upper) / 2.0 + offset[:, None] * across
        ends = np.full(len(k), reach)
        line, begin, end = pieces(space, points, along, -ends, ends)
        grid_points = (points[line] - lower) / side
        _add_chords(grid_points, along[line] / side, begin, end, rows, columns, flow, area)
    # Lines have measure angle x offset = pi x 2 reach, and each direction has weight 1 / pi.
    weight = 2.0 * reach / n_lines
    used = area > 0.0
    centres = np.stack(
        np.meshgrid(np.arange(columns) + 0.5, np.arange(rows) + 0.5), axis=-1
    ).reshape(-1, 2)
    return CellFlow(
        area[used] * weight, flow[np.ix_(used, used)] * weight, lower + centres[used] * side
    )


def best_cut(flow: CellFlow) -> Cut:
    """
    Return the cut of least conductance among those along the second eigenvector.

    Sorted by their value in the second eigenvector, the first k cells are one side of a cut, for
    every k. The conductance of the best cut is an upper bound on the conductance Phi.
    With half the spectral gap as the lower bound this is the bracket of Cheeger's inequality:
    gap / 2 <= Phi <= cut (Lawler and Sokal 1988).
    """
    _, vector = _second_eigenpair(flow)
    order = np.argsort(vector)
    ordered = flow.flow[np.ix_(order, order)]
    # Flow across the cut after k cells: the area of these cells less the flow among them.
    area = np.cumsum(flow.area[order])[:-1]
    within = np.cumsum(np.cumsum(ordered, axis=0), axis=1).diagonal()[:-1]
    sweep = (area - within) / np.minimum(area, flow.area.sum() - area)
    k = int(np.argmin(sweep))
    inside = np.zeros(len(order), dtype=np.bool_)
    inside[order[: k + 1]] = True
    return Cut(inside, float(sweep[k]))


def cut_conductance(space: Space, side: Space, n_lines: int, seed: int) -> Estimate:
    """
    Estimate the conductance of a cut: the flow across it over the volume of its smaller side.

    The intersection of ``space`` with ``side`` is one side of the cut, the rest of ``space`` the
    other. The dimension is any.

    Parameters
    ----------
    space : Space
        The set.
    side : Space
        A set whose intersection with ``space`` is one side of the cut.
    n_lines : int
        Number of random lines through the ball around the bounds.
    seed : int
        Seed of the lines.

    """
    rng = np.random.default_rng(seed)
    lower, upper = space.bounds
    radius = float(np.linalg.norm(upper - lower)) / 2.0
    along = rng.normal(size=(n_lines, space.dim))
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    across = rng.normal(size=(n_lines, space.dim))
    across -= (across * along).sum(axis=1, keepdims=True) * along
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    offset = radius * rng.random(n_lines) ** (1.0 / (space.dim - 1))
    points = (lower + upper) / 2.0 + offset[:, None] * across
    ends = np.full(n_lines, radius)
    line, begin, end = pieces(space, points, along, -ends, ends)
    inside = lengths_within(side, points[line], along[line], begin, end)
    length = end - begin
    crossing = np.bincount(line, inside * (length - inside) / length, n_lines)
    smaller = np.bincount(line, inside, n_lines), np.bincount(line, length - inside, n_lines)
    area = min(smaller, key=np.sum)
    value = crossing.sum() / area.sum()
    error = np.std(crossing - value * area) * math.sqrt(n_lines) / area.sum()
    return Estimate(float(value), float(error))


def _second_eigenpair(flow: CellFlow) -> tuple[float, Floats]:
    """Return the second largest eigenvalue of the kernel, and its right eigenvector (m,)."""
    root = np.sqrt(flow.area)
    second = len(root) - 2
    values, vectors = eigh(flow.flow / np.outer(root, root), subset_by_index=(second, second))
    return float(values[0]), vectors[:, 0] / root


@kernel
def _add_chords(points, directions, begin, end, rows, columns, flow, area):
    """
    Add the flow and area of k chords to ``flow`` and ``area``, which are indexed by cell.

    Chords are ``point + s direction``, begin < s < end, with points and directions (k, 2) in units
    of cells. Cell ``row * columns + column`` is at the given row and column of the lattice.
    """
    flow, area = borrowed(flow), borrowed(area)
    cells = np.empty(2 * (rows + columns) + 4, dtype=np.int64)
    lengths = np.empty(len(cells))
    for k in range(len(begin)):
        n_cells = _cross_cells(
            points[k], directions[k], begin[k], end[k], rows, columns, cells, lengths
        )
        length = end[k] - begin[k]
        for i in range(n_cells):
            area[cells[i]] += lengths[i]
            for j in range(n_cells):
                flow[cells[i], cells[j]] += lengths[i] * lengths[j] / length


@kernel
def _cross_cells(x, u, begin, end, rows, columns, cells, lengths):
    """
    Write the cells that the chord ``x + s u``, begin < s < end, crosses; return their number.

    The number of each cell goes into ``cells``, the length of the chord in this cell, in units of
    s, into ``lengths``; at most ``len(cells)`` are written.
    """
    n_cells = 0
    s = begin
    while s < end and n_cells < len(cells):
        ahead = end
        middle = s + 1e-12 * (end - begin)
        for i in range(2):
            if u[i] != 0.0:
                at = x[i] + middle * u[i]
                line = math.floor(at) + 1 if u[i] > 0.0 else math.ceil(at) - 1
                crossing = (line - x[i]) / u[i]
                if crossing > middle:
                    ahead = min(ahead, crossing)
        middle = (s + ahead) / 2.0
        column = min(max(math.floor(x[0] + middle * u[0]), 0), columns - 1)
        row = min(max(math.floor(x[1] + middle * u[1]), 0), rows - 1)
        cells[n_cells], lengths[n_cells] = row * columns + column, ahead - s
        n_cells += 1
        s = ahead
    return n_cells
