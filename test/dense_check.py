"""
An independent checker of paths in any space: many points along every segment, one by one.

It shares no code with the planner: whether a point is free says a function written with NumPy.
"""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray


def collisions(
    path: ArrayLike, is_free: Callable[[NDArray], NDArray[np.bool_]], step: float
) -> list[str]:
    """
    Return every segment of a path that is not free, in words; an empty list is a free path.

    Parameters
    ----------
    path : (m, dim)
        At least one point.
    is_free : callable
        From points (k, dim) to (k,) bool.
    step : float
        Distance between two points that are looked at, at most.

    """
    points = np.asarray(path, dtype=float)
    if points.ndim != 2 or len(points) == 0 or not np.isfinite(points).all():
        return [f'a path is finite points (m, dim) with m >= 1, got {path!r}']
    found = []
    for number, (a, b) in enumerate(pairwise(np.vstack([points, points[-1:]]))):
        n = 2 + int(np.linalg.norm(b - a) / step)
        free = is_free(a + np.linspace(0.0, 1.0, n)[:, np.newaxis] * (b - a))
        if not free.all():
            found.append(f'{np.count_nonzero(~free)} of {n} points of segment {number} are hit')
    return found
