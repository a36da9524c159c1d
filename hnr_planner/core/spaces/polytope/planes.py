"""
The compiled planes of a polytope, in the layouts for the primitives and for walks.

The kernels for walks are in the module ``chain_cache`` of this folder.
"""

import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.curves.curve import along, first_exit_on_curve
from hnr_planner.core.spaces.curves.surfaces import (
    add_crossings,
    add_level_crossings,
    first_exit_between_surfaces,
)
from hnr_planner.core.spaces.primitives import contains, first_entry, first_exit, touches
import numpy as np
from numpy.typing import NDArray

#: Number of rows from which a matrix is stored densely if at least one in ``SPARSE`` of its
#: numbers is not zero.
LONG = 32
SPARSE = 4
#: Number of rows from which a matrix is stored densely if at least one in ``FULL`` of its numbers
#: is not zero: a loop over so few rows takes about as long as half as many lookups.
SHORT = 12
FULL = 2
#: Products of unit vectors below this are rounding errors of 0.
SPURIOUS = 1e-13


class Layout(NamedTuple):
    """
    A matrix (m, dim) as walks read it: its columns, or its nonzero numbers by columns and rows.

    Attributes
    ----------
    dense, dense_inverses : (dim, m)
        The transposed matrix, and the inverses of its numbers, inf for 0; (0, 0) in the sparse
        layout, which has the other fields. They are empty in the dense layout.
    column_starts : (dim, 3) uint64
        Indices in ``rows``, ``values`` and ``inverses`` at which the positive numbers of each
        column begin, at which the negative ones do, and at which they end.
    rows, values, inverses : (k,)
        Row (uint64) of each nonzero number, column by column, the number and its inverse.
    row_starts : (m + 1,) uint64
        Indices in ``columns`` and ``row_values`` at which the numbers of each row begin, and the
        end of the last.
    columns, row_values : (k,)
        Column (uint64) of each nonzero number, row by row, and the number.

    """

    dense: Floats
    dense_inverses: Floats
    column_starts: NDArray[np.uint64]
    rows: NDArray[np.uint64]
    values: Floats
    inverses: Floats
    row_starts: NDArray[np.uint64]
    columns: NDArray[np.uint64]
    row_values: Floats


class PolytopeData(NamedTuple):
    """
    A compiled polytope.

    Attributes
    ----------
    normals : (m, dim)
        Unit vectors across the planes, pointing out of the polytope.
    offsets : (m,)
        Right-hand sides of the inequalities ``normals x < offsets``, kernel frame.
    layout : Layout
        The normals as walks read them.
    axes : (k, dim)
        Directions of coordinate walks; (0, dim) for the axes of the frame.
    along_axes : Layout
        The products ``normals axes^T`` (m, k) as coordinate walks read them: ``layout`` itself
        for the axes of the frame.
    doubt : float
        Bound on the rounding error of a distance to a plane that a walk updates.

    """

    normals: Floats
    offsets: Floats
    layout: Layout
    axes: Floats
    along_axes: Layout
    doubt: float


def layout_of(matrix: Floats) -> Layout:
    """
    Return a matrix (m, dim) in the dense or the sparse layout.

    The layout is dense if the matrix has at least ``LONG`` rows, and at least one in ``SPARSE`` of
    its numbers is not zero; and with at least ``SHORT`` rows if one in ``FULL`` is not.
    """
    m, dim = matrix.shape
    nonzero = np.count_nonzero(matrix)
    is_long = m >= LONG and nonzero * SPARSE >= matrix.size
    if is_long or (m >= SHORT and nonzero * FULL >= matrix.size):
        none, empty = np.empty(0, np.uint64), np.empty(0)
        starts = np.empty((0, 3), np.uint64)
        dense = matrix.T.copy()
        inverses = np.full_like(dense, np.inf)
        np.divide(1.0, dense, out=inverses, where=dense != 0.0)
        return Layout(dense, inverses, starts, none, empty, empty, none, none, empty)
    by_sign = [np.flatnonzero(sign) for column in matrix.T for sign in (column > 0, column < 0)]
    ends = np.cumsum([0, *map(len, by_sign)])
    column_starts = np.stack([ends[:-2:2], ends[1:-1:2], ends[2::2]], axis=1)
    rows = np.concatenate(by_sign)
    values = matrix[rows, np.repeat(np.arange(dim), column_starts[:, 2] - column_starts[:, 0])]
    at_row, columns = np.nonzero(matrix)
    return Layout(
        np.empty((0, 0)),
        np.empty((0, 0)),
        column_starts.astype(np.uint64),
        rows.astype(np.uint64),
        values,
        1.0 / values,
        np.searchsorted(at_row, np.arange(m + 1)).astype(np.uint64),
        columns.astype(np.uint64),
        matrix[at_row, columns],
    )


def compiled_polytope(
    normals: Floats, offsets: Floats, doubt: float, axes: Floats | None = None
) -> PolytopeData:
    """
    Return the compiled polytope ``normals x < offsets``.

    ``axes`` (k, dim) are directions of coordinate walks, by default the axes of the frame. Their
    products with the normals that are rounding errors of 0 count as 0.
    """
    layout = layout_of(normals)
    if axes is None:
        none = np.empty((0, normals.shape[1]))
        return PolytopeData(normals, offsets, layout, none, layout, doubt)
    products = normals @ axes.T
    products[np.abs(products) < SPURIOUS] = 0.0
    return PolytopeData(normals, offsets, layout, axes, layout_of(products), doubt)


first_exit_on_curve.register(PolytopeData)(first_exit_between_surfaces)


@contains.register(PolytopeData)
@kernel
def _contains(polytope, x):
    """Return whether ``x`` (dim,) is strictly inside every plane."""
    return _holds(polytope, x, False)


@touches.register(PolytopeData)
@kernel
def _touches(polytope, x):
    """Return whether ``x`` (dim,) is inside every plane or on it."""
    return _holds(polytope, x, True)


@first_exit.register(PolytopeData)
@kernel
def _first_exit(polytope, x, u, t, horizon):
    """Return the upper end of the interval of the line inside if it contains ``t``; else ``t``."""
    lower, upper = _span(polytope, x, u, False)
    return upper if lower < t < upper else t


@first_entry.register(PolytopeData)
@kernel
def _first_entry(polytope, x, u, t):
    """Return the first parameter from ``t`` on at which the line is in the closure, or inf."""
    lower, upper = _span(polytope, x, u, True)
    return max(t, lower) if t <= upper else math.inf


@kernel
def _holds(polytope, x, closed):
    """Return whether every inequality holds at ``x``, strictly unless ``closed``."""
    for k in range(len(polytope.offsets)):
        slack = _slack(polytope, k, x)
        if not (slack > 0.0 or (closed and slack == 0.0)):
            return False
    return True


@kernel
def _span(polytope, x, u, closed):
    """Return the interval of the line ``x + s u`` inside every plane; (inf, -inf) for none."""
    first, last = -math.inf, math.inf
    for k in range(len(polytope.offsets)):
        slack, rate = _slack(polytope, k, x), _rate(polytope, k, u)
        if rate > 0.0:
            last = min(last, slack / rate)
        elif rate < 0.0:
            first = max(first, slack / rate)
        elif not (slack > 0.0 or (closed and slack == 0.0)):
            return math.inf, -math.inf
    if first < last or (closed and first == last):
        return first, last
    return math.inf, -math.inf


@kernel
def _slack(polytope, k, x):
    """Return the distance from ``x`` (dim,) to plane ``k``; it is below 0 outside of the plane."""
    return polytope.offsets[k] - _rate(polytope, k, x)


@kernel
def _rate(polytope, k, u):
    """Return the rate at which a line along ``u`` approaches plane ``k``."""
    layout = polytope.layout
    rate = 0.0
    if len(layout.dense) > 0:
        for i in range(len(u)):
            rate += polytope.normals[k, i] * u[i]
        return rate
    for i in range(layout.row_starts[k], layout.row_starts[k + 1]):
        rate += layout.row_values[i] * u[layout.columns[i]]
    return rate


@add_crossings.register(PolytopeData)
@kernel
def _add_crossings(polytope, curve, end, crossings, n):
    """
    Append to ``crossings``, from index ``n``, the parameters where a curve meets the planes.

    Return ``n`` plus their number, also of those that do not fit.
    """
    for k in range(len(polytope.offsets)):
        f = along(curve, polytope.normals[k])
        n = add_level_crossings(f, polytope.offsets[k], end, crossings, n)
    return n
