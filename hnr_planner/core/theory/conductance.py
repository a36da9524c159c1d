"""
Conductance: how narrow the narrowest passage of Hit-and-Run is (paper, Section 3.1, Phi).

A step from a uniform point draws a line, and two points of one chord of it. So the flow from A to
B in one step is a mean over lines: of |chord in A| |chord in B| / |chord|, summed over the line's
chords. Its measure on lines is invariant, which makes the flow symmetric, and easy to sum up.
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

#: Steps of the lattice of lines: its two coordinates are multiples of these modulo 1 (the powers
#: of the inverse of the plastic number: Roberts's R2, a lattice without resonances).
PLASTIC = 1.324717957244746
#: Lines cut at once.
BATCH = 1 << 18


class CellFlow(NamedTuple):
    """
    Flow of one step between the cells of a lattice over a set, in the stationary law.

    Attributes
    ----------
    area : (m,)
        Area of the set in each cell; empty cells are left out.
    flow : (m, m)
        Area that goes from cell to cell in a step: symmetric, with ``area`` as its row sums.
    centre : (m, 2)
        Centre of each cell.

    """

    area: Floats
    flow: Floats
    centre: Floats

    @property
    def kernel(self) -> Floats:
        """Probability (m, m) of a step to each cell from a uniform point of each."""
        return self.flow / self.area[:, None]

    @property
    def relaxation_time(self) -> float:
        """
        Steps that the slowest deviation from uniformity takes to fade: 1 / spectral gap.

        That of the chain that forgets its place within the cell at every step: never more than
        the true one, and nearer to it the finer the cells (its kernel is a projection of the true
        one).
        """
        return 1.0 / (1.0 - _slowest(self)[0])


class Cut(NamedTuple):
    """
    A cut of a set in two and the conductance across it.

    Attributes
    ----------
    inside : (m,) bool
        Cells on one side.
    conductance : float
        Flow across, by the area of the smaller side.

    """

    inside: NDArray[np.bool_]
    conductance: float


class Estimate(NamedTuple):
    """A mean over random draws, with its standard error."""

    value: float
    error: float


def cell_flow(space: Space, shape: tuple[int, int], n_lines: int = 1 << 20) -> CellFlow:
    """
    Return the flow between the cells of a lattice over a set in the plane.

    Parameters
    ----------
    space : Space
        The set.
    shape : (rows, columns)
        Cells that the bounds are cut into.
    n_lines : int
        Lines of the quadrature, on a lattice over angle and offset.

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
    Return the best cut along the slowest eigenvector: a bound on the conductance from above.

    Together with half the spectral gap, from below, this is the bracket of Cheeger's inequality:
    gap / 2 <= Phi <= cut (Lawler and Sokal 1988).
    """
    _, vector = _slowest(flow)
    order = np.argsort(vector)
    ordered = flow.flow[np.ix_(order, order)]
    # Across the cut after k cells: what leaves the first k in all, less what stays among them.
    area = np.cumsum(flow.area[order])[:-1]
    stays = np.cumsum(np.cumsum(ordered, axis=0), axis=1).diagonal()[:-1]
    sweep = (area - stays) / np.minimum(area, flow.area.sum() - area)
    k = int(np.argmin(sweep))
    inside = np.zeros(len(order), dtype=np.bool_)
    inside[order[: k + 1]] = True
    return Cut(inside, float(sweep[k]))


def cut_conductance(space: Space, side: Space, n_lines: int, seed: int) -> Estimate:
    """
    Estimate the conductance of the cut of a space of any dimension by another.

    Parameters
    ----------
    space : Space
        The set.
    side : Space
        Its part in the space is one side of the cut.
    n_lines : int
        Lines through the ball around the bounds.
    seed : int
        Of the lines.

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


def _slowest(flow: CellFlow) -> tuple[float, Floats]:
    """Second largest eigenvalue of the kernel, and its right eigenvector (m,)."""
    root = np.sqrt(flow.area)
    values, vectors = np.linalg.eigh(flow.flow / np.outer(root, root))
    return float(values[-2]), vectors[:, -2] / root


@kernel
def _add_chords(points, directions, begin, end, rows, columns, flow, area):
    """Add the chords ``point + s direction``, begin < s < end, in units of cells."""
    flow, area = borrowed(flow), borrowed(area)
    cells = np.empty(2 * (rows + columns) + 4, dtype=np.int64)
    lengths = np.empty(len(cells))
    for k in range(len(begin)):
        n_cells = _cross_cells(
            points[k], directions[k], begin[k], end[k], rows, columns, cells, lengths
        )
        whole = end[k] - begin[k]
        for i in range(n_cells):
            area[cells[i]] += lengths[i]
            for j in range(n_cells):
                flow[cells[i], cells[j]] += lengths[i] * lengths[j] / whole


@kernel
def _cross_cells(x, u, begin, end, rows, columns, cells, lengths):
    """Write down which cells a chord crosses, and how long it is in each; return how many."""
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
