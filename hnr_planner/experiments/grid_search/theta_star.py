"""Theta* (Nash, Daniel, Koenig and Felner 2007): A* whose parents may be any visible cell."""

from heapq import heappop, heappush
import math

from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.primitives import segment_is_free
from hnr_planner.experiments.grid_search.cells import cell_of, may_step, STEPS, trace
import numpy as np


@kernel
def theta_star(grid, start, goal):
    """
    Return a short path (m, 2) over centres of cells, with the straight distance as heuristic.

    ``start`` and ``goal`` (x, y) are in the kernel frame of ``grid`` (units of cells); a path
    between their cells must exist.
    """
    free_distance = grid.free_distance
    columns = free_distance.shape[1]
    source, target = cell_of(start, columns), cell_of(goal, columns)
    cost = np.full(free_distance.size, np.inf)
    parent = np.full(free_distance.size, -1, dtype=np.int32)
    closed = np.zeros(free_distance.size, dtype=np.bool_)
    cost[source], parent[source] = 0.0, source
    queue = [(_distance(source, target, columns), source)]
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
            before = parent[cell]
            length = cost[before] + _distance(before, near, columns)
            if length >= cost[near]:
                continue  # a path through this cell is no shorter: skip the visibility test
            if not segment_is_free(grid, _centre(before, columns), _centre(near, columns)):
                before = cell
                length = cost[before] + _distance(before, near, columns)
            if length < cost[near]:
                cost[near] = length
                parent[near] = before
                heappush(queue, (length + _distance(near, target, columns), near))
    return trace(parent, source, target, columns)


@kernel
def _distance(a, b, columns):
    """Return the straight distance between the centres of two cells [cells]."""
    return math.hypot(a % columns - b % columns, a // columns - b // columns)


@kernel
def _centre(cell, columns):
    """Return the centre (x, y) [cells] of the cell of a row-major index."""
    return np.array((cell % columns + 0.5, cell // columns + 0.5))
