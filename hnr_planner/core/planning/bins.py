"""Square bins over the first two coordinates of a box, surrounded by a rim of empty bins."""

import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
import numpy as np


class Bins(NamedTuple):
    """
    Square bins over the first two coordinates of a box, numbered row by row from 0.

    The box is surrounded by a rim of empty bins, one bin wide.

    Attributes
    ----------
    lower : (dim,)
        Corner of the box with the least coordinates, where the bins inside the rim begin.
    side : float
        Length of the side of a bin, in the unit of ``lower``.
    columns : int
        Number of bins in a row, two bins of the rim included.
    rows : int
        Number of rows, two rows of the rim included.

    """

    lower: Floats
    side: float
    columns: int
    rows: int


@kernel
def make_bins(lower, upper, side):
    """Return bins of side ``side`` over the box from ``lower`` to ``upper`` (dim,)."""
    width, height = upper[0] - lower[0], upper[1] - lower[1] if len(lower) > 1 else 0.0
    return Bins(lower, side, int(width / side) + 3, int(height / side) + 3)


@kernel
def bin_of(bins, x):
    """Return the number of the bin that holds ``x`` (dim,), a point of the box."""
    column = 1 + math.floor((x[0] - bins.lower[0]) / bins.side)
    row = 1 + math.floor((x[1] - bins.lower[1]) / bins.side) if len(x) > 1 else 1
    return row * bins.columns + column


@kernel
def bins_of(bins, points):
    """Return the numbers (k,) of the bins that hold ``points`` (k, dim)."""
    numbers = np.empty(len(points), dtype=np.int64)
    for k in range(len(points)):
        numbers[k] = bin_of(bins, points[k])
    return numbers
