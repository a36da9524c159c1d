"""Row-major indices of the cells of a grid, and the steps between neighbouring cells."""

import math

from hnr_planner.core.kernels.kernel import kernel
import numpy as np

#: Length of a diagonal step [cells].
DIAGONAL = math.sqrt(2.0)
#: Steps (rows, columns) to the eight neighbours; the first four are straight.
STEPS = ((0, 1), (1, 0), (0, -1), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1))


@kernel
def may_step(free_distance, cell, down, right):
    """
    Return whether a step from the free cell of index ``cell`` by (``down``, ``right``) is free.

    A straight step needs a free cell at its end, a diagonal step all four cells around it.
    """
    row, column = cell // free_distance.shape[1], cell % free_distance.shape[1]
    if free_distance[row + down, column + right] == 0:
        return False
    if down == 0 or right == 0:
        return True
    return free_distance[row + down, column] != 0 and free_distance[row, column + right] != 0


@kernel
def cell_of(point, columns):
    """Return the row-major index of the cell that contains a point (x, y) in units of cells."""
    return int(point[1]) * columns + int(point[0])


@kernel
def trace(parent, source, target, columns):
    """Return the centres (m, 2) of the cells from ``source`` to ``target``, found by parents."""
    cells = [target]
    while cells[-1] != source:
        cells.append(parent[cells[-1]])
    path = np.empty((len(cells), 2))
    for k in range(len(cells)):
        cell = cells[len(cells) - 1 - k]
        path[k] = cell % columns + 0.5, cell // columns + 0.5
    return path
