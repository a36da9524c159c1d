"""A wavefront potential over the whole map and the descent along it, as in NavFn."""

import math

from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.experiments.grid_search.cells import cell_of, DIAGONAL, may_step, STEPS
import numpy as np

#: Width of a wave [cells]: cells with a larger potential wait for the next wave.
WAVE = 2.0


@kernel
def wavefront(grid, start, goal):
    """
    Return a path (m, 2) over centres of cells that descends the potential of the goal.

    The potential is a first-order approximation of the distance to the goal, for every cell of the
    map. It is computed in waves of width ``WAVE``; cells beyond the current wave are postponed to
    the next one. ``start`` and ``goal`` (x, y) are in the kernel frame of ``grid``; a path between
    their cells must exist.
    """
    columns = grid.free_distance.shape[1]
    source, target = cell_of(start, columns), cell_of(goal, columns)
    distances = potential(grid, goal)
    path = [source]
    while path[-1] != target:
        path.append(_lowest_neighbour(grid.free_distance, distances, path[-1]))
    cells = np.array(path)
    return np.stack((cells % columns + 0.5, cells // columns + 0.5), axis=1)


@kernel
def potential(grid, goal):
    """
    Return the approximate distance (rows * columns,) [cells] of each cell to the goal.

    Cells are in row-major order; the distance is inf where no path leads to the goal.
    """
    free_distance = grid.free_distance
    columns = free_distance.shape[1]
    distances = np.full(free_distance.size, np.inf, dtype=np.float32)
    _spread(free_distance.ravel(), columns, cell_of(goal, columns), distances)
    return distances


@kernel
def _spread(free, columns, target, potential):
    """Fill ``potential`` (n_cells,) in waves that start at the cell ``target``."""
    queues = (np.empty(free.size, dtype=np.int32), np.empty(free.size, dtype=np.int32))
    waiting = np.zeros(free.size, dtype=np.bool_)
    late = np.empty(free.size, dtype=np.int32)
    potential[target] = 0.0
    n_now, n_late, limit, turn = 0, 0, WAVE, 0
    for offset in (1, -1, columns, -columns):
        n_now = _enqueue(free, waiting, queues[0], n_now, target + offset)
    while n_now > 0:
        now, following, n_next = queues[turn], queues[1 - turn], 0
        for k in range(n_now):
            cell = now[k]
            waiting[cell] = False
            value = _raised(potential, cell, columns)
            if value >= potential[cell] - 1e-3:
                continue
            potential[cell] = value
            for offset in (1, -1, columns, -columns):
                near = cell + offset
                if potential[near] <= value:
                    continue
                if value < limit:
                    n_next = _enqueue(free, waiting, following, n_next, near)
                else:
                    n_late = _enqueue(free, waiting, late, n_late, near)
        if n_next == 0:
            following[:n_late] = late[:n_late]
            n_next, n_late, limit = n_late, 0, limit + WAVE
        n_now, turn = n_next, 1 - turn


@kernel
def _enqueue(free, waiting, queue, n_queued, cell):
    """Append a cell to a queue if it is free and not waiting in one; return the queue's length."""
    if free[cell] == 0 or waiting[cell]:
        return n_queued
    waiting[cell] = True
    queue[n_queued] = cell
    return n_queued + 1


@kernel
def _raised(potential, cell, columns):
    """Return a cell's potential by the eikonal equation, from its lower straight neighbours."""
    a = min(potential[cell - 1], potential[cell + 1])
    b = min(potential[cell - columns], potential[cell + columns])
    if abs(a - b) >= 1.0:
        return min(a, b) + 1.0
    return 0.5 * (a + b + math.sqrt(2.0 - (a - b) * (a - b)))


@kernel
def _lowest_neighbour(free_distance, potential, cell):
    """Return the neighbour of steepest descent of the potential; ``cell`` if none is lower."""
    columns = free_distance.shape[1]
    lowest, steepest = cell, 0.0
    for down, right in STEPS:
        near = cell + down * columns + right
        if not may_step(free_distance, cell, down, right):
            continue
        length = DIAGONAL if down != 0 and right != 0 else 1.0
        slope = (potential[cell] - potential[near]) / length
        if slope > steepest:
            lowest, steepest = near, slope
    return lowest
