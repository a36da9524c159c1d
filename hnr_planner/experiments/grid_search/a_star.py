"""A* search over the eight neighbours of a cell."""

from heapq import heappop, heappush

from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.experiments.grid_search.cells import cell_of, DIAGONAL, may_step, STEPS, trace
import numpy as np


@kernel
def a_star(grid, start, goal):
    """
    Return a shortest path (m, 2) over centres of neighbouring cells, by the octile heuristic.

    ``start`` and ``goal`` (x, y) are in the kernel frame of ``grid`` (units of cells); a path
    between their cells must exist.
    """
    free_distance = grid.free_distance
    columns = free_distance.shape[1]
    source, target = cell_of(start, columns), cell_of(goal, columns)
    cost = np.full(free_distance.size, np.inf, dtype=np.float32)
    parent = np.full(free_distance.size, -1, dtype=np.int32)
    closed = np.zeros(free_distance.size, dtype=np.bool_)
    cost[source] = 0.0
    queue = [(_octile(source, target, columns), source)]
    while len(queue) > 0:
        cell = heappop(queue)[1]
        if cell == target:
            break
        if closed[cell]:
            continue
        closed[cell] = True
        for down, right in STEPS:
            near = cell + down * columns + right
            if closed[near] or not may_step(free_distance, cell, down, right):
                continue
            length = cost[cell] + (DIAGONAL if down != 0 and right != 0 else 1.0)
            if length < cost[near]:
                cost[near] = length
                parent[near] = cell
                heappush(queue, (length + _octile(near, target, columns), near))
    return trace(parent, source, target, columns)


@kernel
def _octile(a, b, columns):
    """Return the length of a shortest path between two cells without obstacles [cells]."""
    rows_apart = abs(a // columns - b // columns)
    columns_apart = abs(a % columns - b % columns)
    shorter = min(rows_apart, columns_apart)
    return max(rows_apart, columns_apart) + (DIAGONAL - 1.0) * shorter
