"""
Trees as arrays of parents: entry ``k`` is the row of the parent of row ``k``.

The parent of a root is ``NONE``, -1. One array can hold several trees.
"""

from hnr_planner.core.kernels.copies import copy_into
from hnr_planner.core.kernels.kernel import kernel
import numpy as np

#: No row: the parent of a root, or the root of a tree that does not exist.
NONE = -1


@kernel
def rows_to(parents, k):
    """
    Return the rows (m,) from the root of the tree of row ``k`` to ``k``, both included.

    The array is empty, (0,), where ``k`` is ``NONE``, -1.
    """
    length, row = 0, k
    while row != NONE:
        length, row = length + 1, parents[row]
    rows, row = np.empty(length, dtype=np.int64), k
    for i in range(length - 1, -1, -1):
        rows[i] = row
        row = parents[row]
    return rows


@kernel
def branch(samples, parents, k):
    """
    Return the samples (m, dim) from the root of the tree of sample ``k`` to ``k``.

    Both ends are included. The array is empty, (0, dim), where ``k`` is ``NONE``, -1.
    """
    rows = rows_to(parents, k)
    points = np.empty((len(rows), samples.shape[1]))
    for i in range(len(rows)):
        copy_into(points[i], samples[rows[i]])
    return points
