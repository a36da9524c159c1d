"""Lengths of vectors and of paths."""

import math

from hnr_planner.core.kernels import kernel


@kernel
def norm(u):
    """Length of a vector (dim,)."""
    squared = 0.0
    for i in range(len(u)):
        squared += u[i] * u[i]
    return math.sqrt(squared)


@kernel
def path_length(path):
    """Length of a path (m, dim)."""
    total = 0.0
    for k in range(1, len(path)):
        total += norm(path[k] - path[k - 1])
    return total
