"""Sizes of the coordinates of a polytope: factors that bring its numbers near 1."""

from typing import Any

from hnr_planner.core.checks import Floats
import numpy as np

#: Factor by which the sizes of coordinates may differ before they are scaled.
UNEVEN = 1e3
#: Rounds in which rows and columns are scaled alternately; the sizes need not be exact.
SCALINGS = 20


def sizes_to_try(normals: Any, offsets: Floats) -> list[Floats]:
    """
    Return the sizes (dim,) of coordinates to try, in order.

    Ones come first, unless the numbers in the columns of ``normals`` (m, dim), sparse, differ by
    more than ``UNEVEN``.
    """
    scaled = sizes_of(normals, offsets)
    even = _column_factors(normals)
    if even.max() > UNEVEN * even.min():
        return [scaled]
    return [np.ones(normals.shape[1]), scaled]


def sizes_of(matrix: Any, right: Floats) -> Floats:
    """Return the sizes (dim,) of coordinates x in ``matrix x < right`` or ``matrix x = right``."""
    from scipy import sparse

    factors = _column_factors(sparse.hstack([matrix, right[:, np.newaxis]]))
    return factors[:-1] / factors[-1]


def _column_factors(matrix: Any) -> Floats:
    """
    Return factors (columns,) that scale the nonzero numbers of a sparse ``matrix`` to about 1.

    They do so together with factors of rows, which are not returned.
    """
    numbers = matrix.tocoo()
    nonzero = numbers.data != 0.0
    row, column = numbers.row[nonzero], numbers.col[nonzero]
    logs = np.log(np.abs(numbers.data[nonzero]))
    m, n = matrix.shape
    n_in_rows = np.maximum(np.bincount(row, minlength=m), 1)
    n_in_columns = np.maximum(np.bincount(column, minlength=n), 1)
    columns = np.zeros(n)
    for _ in range(SCALINGS):
        rows = -np.bincount(row, logs + columns[column], minlength=m) / n_in_rows
        columns = -np.bincount(column, logs + rows[row], minlength=n) / n_in_columns
    return np.asarray(np.exp(columns - columns.mean()))
