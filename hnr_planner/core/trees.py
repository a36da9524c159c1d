"""Trees in tables: each row has the row of its parent, and a root has none."""

from hnr_planner.core.kernels import kernel
import numpy as np

#: No row: the parent of a root, or a tree that is not there.
NONE = -1


@kernel
def branch(samples, parents, k):
    """Return the samples (m, dim) from the root of sample ``k`` to ``k``; (0, dim) for NONE."""
    length, row = 0, k
    while row != NONE:
        length, row = length + 1, parents[row]
    points, row = np.empty((length, samples.shape[1])), k
    for i in range(length - 1, -1, -1):
        points[i] = samples[row]
        row = parents[row]
    return points
