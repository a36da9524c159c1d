"""Random starts and goals on any map, far from each other."""

from __future__ import annotations

from hnr_planner.core import GridSpace
import numpy as np
from numpy.typing import NDArray

#: Least distance of start and goal, as a fraction of the diagonal of the free space's bounds.
MIN_DISTANCE = 0.4


def far_pairs(space: GridSpace, n_pairs: int, seed: int) -> NDArray[np.float64]:
    """
    Draw distant pairs of start and goal (n_pairs, 2, 2) [m] in the caller's frame.

    The points are centres of cells in the largest component of the free space. Start and goal are
    at least ``MIN_DISTANCE`` of the diagonal of that component's bounds apart.
    """
    rng = np.random.default_rng(seed)
    rows, columns = np.nonzero(space.largest_component())
    diagonal = np.hypot(np.ptp(rows), np.ptp(columns))
    pairs: list[NDArray[np.float64]] = []
    while len(pairs) < n_pairs:
        k = rng.integers(len(rows), size=2)
        if np.hypot(*(np.diff(rows[k]), np.diff(columns[k]))) >= MIN_DISTANCE * diagonal:
            pairs.append(space.cell_centres(rows[k], columns[k]))
    return np.array(pairs)
