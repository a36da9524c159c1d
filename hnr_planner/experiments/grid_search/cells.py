"""Cells and the steps between them."""

import math

from hnr_planner.core.kernels.kernel import kernel
import numpy as np

DIAGONAL = math.sqrt(2.0)
STEPS = ((0, 1), (1, 0), (0, -1), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1))


@kernel
def may_step(free_distance, cell, down, right):
    """Say whether a step cuts no corner: a diagonal one needs all four cells free."""
    row, column = cell // free_distance.shape[1], cell % free_distance.shape[1]
    if free_distance[row + down, column + right] == 0:
        return False
    if down == 0 or right == 0:
        return True
    return free_distance[row + down, column] != 0 and free_distance[row, column + right] != 0


@kernel
def cell_of(point, columns):
    """Return the number of the cell that holds a point (x, y)."""
    return int(point[1]) * columns + int(point[0])


@kernel
def trace(parent, source, target, columns):
    """Return the path (m, 2) over cell centres along the parents."""
    cells = [target]
    while cells[-1] != source:
        cells.append(parent[cells[-1]])
    path = np.empty((len(cells), 2))
    for k in range(len(cells)):
        cell = cells[len(cells) - 1 - k]
        path[k] = cell % columns + 0.5, cell // columns + 0.5
    return path
