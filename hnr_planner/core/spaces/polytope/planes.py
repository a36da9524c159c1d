"""The planes of a polytope, compiled: as they are, and as walks read them."""

from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.spaces.chain_cache import REFRESH
import numpy as np
from numpy.typing import NDArray

#: Columns of at least so many numbers, of which one in SPARSE at least is not zero, are dense.
LONG, SPARSE = 32, 4


class Layout(NamedTuple):
    """
    A matrix (m, dim) as walks read it: its columns, or what is not zero in columns and in rows.

    Attributes
    ----------
    dense : (dim, m)
        One row for each column; (0, 0) where zeros are left out.
    column_starts : (dim, 3) uint64
        Where the positive numbers of each column begin in the arrays below, where the negative
        ones do, and where they end.
    rows, values, inverses : (k,)
        Their rows, uint64, the numbers themselves and their inverses.
    row_starts : (m + 1,) uint64
        Where the numbers of each row begin in the arrays below, and where the last ends.
    columns, row_values : (k,)
        Their columns, uint64, and the numbers themselves.

    """

    dense: Floats
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
        Unit vectors, outward.
    offsets : (m,)
        The inequalities are ``normals x < offsets``.
    layout : Layout
        The normals as walks read them.
    doubt : float
        A distance to a plane that walks remember is right up to this.

    """

    normals: Floats
    offsets: Floats
    layout: Layout
    doubt: float


def layout_of(matrix: Floats) -> Layout:
    """Return a matrix (m, dim) in the form that is read faster."""
    m, dim = matrix.shape
    if m >= LONG and np.count_nonzero(matrix) * SPARSE >= matrix.size:
        none, empty = np.empty(0, np.uint64), np.empty(0)
        starts = np.empty((0, 3), np.uint64)
        return Layout(matrix.T.copy(), starts, none, empty, empty, none, none, empty)
    parts = [np.flatnonzero(part) for column in matrix.T for part in (column > 0, column < 0)]
    ends = np.cumsum([0, *map(len, parts)])
    column_starts = np.stack([ends[:-2:2], ends[1:-1:2], ends[2::2]], axis=1)
    rows = np.concatenate(parts)
    values = matrix[rows, np.repeat(np.arange(dim), column_starts[:, 2] - column_starts[:, 0])]
    at_row, columns = np.nonzero(matrix)
    return Layout(
        np.empty((0, 0)),
        column_starts.astype(np.uint64),
        rows.astype(np.uint64),
        values,
        1.0 / values,
        np.searchsorted(at_row, np.arange(m + 1)).astype(np.uint64),
        columns.astype(np.uint64),
        matrix[at_row, columns],
    )


def doubt(normals: Floats, offsets: Floats, lower: Floats, upper: Floats) -> float:
    """Bound what rounding does to a distance in ``REFRESH`` steps within bounds (dim,)."""
    reach = np.abs(normals) @ np.maximum(np.abs(lower), np.abs(upper)) + np.abs(offsets)
    largest = float(reach.max() + np.linalg.norm(upper - lower))
    return REFRESH * (4 + len(lower)) * float(np.finfo(np.float64).eps) * largest
