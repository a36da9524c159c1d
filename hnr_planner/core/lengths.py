"""Lengths of vectors and of paths, in the units of their coordinates."""

import math

from hnr_planner.core.kernels.kernel import kernel


@kernel
def norm(u):
    """Return the length of a vector (dim,)."""
    squared = 0.0
    for i in range(len(u)):
        squared += u[i] * u[i]
    return math.sqrt(squared)


@kernel
def distance(a, b):
    """Return the distance between two points (dim,)."""
    squared = 0.0
    for i in range(len(a)):
        squared += (b[i] - a[i]) ** 2
    return math.sqrt(squared)


@kernel
def path_length(path):
    """Return the length of a path (m, dim): the sum over its segments; 0 for a single point."""
    total = 0.0
    for k in range(1, len(path)):
        total += distance(path[k - 1], path[k])
    return total
