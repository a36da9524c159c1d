"""Checks of the values of an occupancy map: which cells are occupied, and which are unknown."""

from typing import Any

from hnr_planner.core.errors import SpaceError
import numpy as np
from numpy.typing import ArrayLike, NDArray

Bools = NDArray[np.bool_]


def check_cells(cells: ArrayLike) -> NDArray[Any]:
    """Return ``cells`` (rows, cols) as a non-empty array, or raise SpaceError."""
    try:
        array = np.asarray(cells)
    except ValueError:
        raise SpaceError('a grid needs rows of the same length') from None
    if array.ndim != 2 or array.size == 0:
        raise SpaceError(f'a grid needs rows and columns, got an array of shape {array.shape}')
    return array


def read_blocked(blocked: ArrayLike) -> Bools:
    """
    Return ``blocked`` (rows, cols) as a fresh bool array, or raise SpaceError.

    The values have to be truth values, or whole numbers 0 and 1.
    """
    values = check_cells(blocked)
    if values.dtype.kind not in 'biu' or not np.isin(values, (0, 1)).all():
        raise SpaceError(f'blocked must be true or false, got an array of {values.dtype}')
    return values.astype(bool)


def read_occupancy(data: ArrayLike, occupied_threshold: int, unknown: str) -> tuple[Bools, Bools]:
    """
    Return which cells (rows, cols) are occupied, and which are blocked because they are unknown.

    Values outside 0..100 are unknown, whatever the threshold. With ``unknown`` 'free' the second
    array is false everywhere.

    Raises
    ------
    SpaceError
        When ``data`` is no grid of whole numbers, ``occupied_threshold`` is not in 1..100, or
        ``unknown`` is not 'blocked' or 'free'.

    """
    values = check_cells(data)
    if not np.issubdtype(values.dtype, np.integer):
        raise SpaceError(f'data must be whole numbers, got an array of {values.dtype}')
    if not isinstance(occupied_threshold, (int, np.integer)):
        raise SpaceError(f'occupied_threshold must be a whole number, got {occupied_threshold!r}')
    if not 1 <= occupied_threshold <= 100:
        raise SpaceError(f'occupied_threshold must be in 1..100, got {occupied_threshold!r}')
    if unknown not in ('blocked', 'free'):
        raise SpaceError(f"unknown must be 'blocked' or 'free', got {unknown!r}")
    is_unknown = (values < 0) | (values > 100)
    occupied = (values >= occupied_threshold) & ~is_unknown
    return occupied, is_unknown if unknown == 'blocked' else np.zeros_like(occupied)
