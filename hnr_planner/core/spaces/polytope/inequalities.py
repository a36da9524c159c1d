"""
Validation of the inequalities ``a x < b`` of a polytope, and their scaling.

Each row of ``a`` and its right-hand side are divided by the length of the row, and rows that every
point satisfies are dropped.
"""

from typing import Any

from hnr_planner.core.checks import check_numbers, Floats
from hnr_planner.core.errors import SpaceError
import numpy as np
from numpy.typing import NDArray


def check_inequalities(a: Any, b: Any) -> tuple[Floats, Floats, NDArray[np.intp]]:
    """
    Return rows of unit length, their right-hand sides and their indices in ``a``.

    Parameters
    ----------
    a : (m, dim)
        One row for each inequality ``a x < b``, dense or a sparse matrix of scipy's.
    b : (m,)
        Right-hand sides; a row with inf limits nothing.

    Returns
    -------
    normals : (k, dim)
        Rows of ``a`` divided by their lengths. Rows that every point satisfies are left out.
    offsets : (k,)
        Right-hand sides divided by the same lengths.
    rows : (k,)
        Index in ``a`` of each row of ``normals``.

    Raises
    ------
    SpaceError
        When the numbers describe no inequalities, or one that no point satisfies.

    """
    offsets = check_numbers('b', b, SpaceError)
    normals = check_numbers('a', a.toarray() if hasattr(a, 'toarray') else a, SpaceError)
    if offsets.ndim != 1 or offsets.size == 0:
        raise SpaceError(f'b must have shape (m,) with m at least 1, got {offsets.shape}')
    if normals.ndim != 2 or len(normals) != len(offsets) or normals.shape[1] == 0:
        raise SpaceError(f'a must have shape ({len(offsets)}, dim) as b has, got {normals.shape}')
    if not np.isfinite(normals).all():
        raise SpaceError('a must be finite, and is not')
    if np.isnan(offsets).any():
        raise SpaceError(f'b must be numbers, but b[{int(np.isnan(offsets).argmax())}] is nan')
    lengths = _lengths(normals)
    no_point = (offsets == -np.inf) | ((lengths == 0.0) & (offsets <= 0.0))
    if no_point.any():
        k = int(no_point.argmax())
        left = '0' if lengths[k] == 0.0 else f'a[{k}] x'
        raise SpaceError(
            f'the polytope must have an inside, but row {k} says {left} < {offsets[k]:g}, which '
            f'no point holds'
        )
    rows = np.flatnonzero((lengths > 0.0) & (offsets < np.inf))
    lengths = lengths[rows]
    return normals[rows] / lengths[:, np.newaxis], offsets[rows] / lengths, rows


def _lengths(normals: Floats) -> Floats:
    """Return the lengths (m,) of rows (m, dim), without overflow or underflow of squares."""
    largest = np.abs(normals).max(axis=1)
    lengths = np.linalg.norm(normals, axis=1)
    extreme = (largest > 1e150) | ((largest < 1e-150) & (largest > 0.0))
    if extreme.any():
        scaled = normals[extreme] / largest[extreme, np.newaxis]
        lengths[extreme] = largest[extreme] * np.linalg.norm(scaled, axis=1)
    return lengths
