"""
Grid search, as most robots plan today: A* and a wavefront over the whole map, compiled.

Paths lead from cell centre to cell centre, to one of eight neighbours at each step, and cut no
corner: a diagonal step needs all four cells free. ``free_distance`` is that of a compiled grid,
0 where a cell is blocked, with a blocked rim.
"""

from heapq import heappop, heappush
import math

from hnr_planner.core.kernels import kernel
from hnr_planner.core.spaces.primitives import sees
import numpy as np

DIAGONAL = math.sqrt(2.0)
STEPS = ((0, 1), (1, 0), (0, -1), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1))
#: A wave spreads this far [cells] before its late cells are looked at.
WAVE = 2.0


@kernel
def a_star(grid, start, goal):
    """Find a shortest path (m, 2) over neighbouring cells; the heuristic is their distance."""
    free_distance = grid.free_distance
    columns = free_distance.shape[1]
    source, target = _cell(start, columns), _cell(goal, columns)
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
            if closed[near] or not _may_step(free_distance, cell, down, right):
                continue
            length = cost[cell] + (DIAGONAL if down != 0 and right != 0 else 1.0)
            if length < cost[near]:
                cost[near] = length
                parent[near] = cell
                heappush(queue, (length + _octile(near, target, columns), near))
    return _trace(parent, source, target, columns)


@kernel
def pull_string(grid, path):
    """Keep of a path (m, 2) only vertices that do not see the one before their last."""
    kept = np.empty_like(path)
    kept[0] = path[0]
    n_kept = 1
    for k in range(2, len(path)):
        if not sees(grid, kept[n_kept - 1], path[k]):
            kept[n_kept] = path[k - 1]
            n_kept += 1
    kept[n_kept] = path[-1]
    return kept[: n_kept + 1]


@kernel
def wavefront(grid, start, goal):
    """
    Find a path (m, 2) down the potential of the goal over the whole map.

    The potential is a distance: at each cell a plane through its lower neighbours, raised by one
    cell. It spreads in waves, and each wave holds its late cells back for the next one.
    """
    free_distance = grid.free_distance
    columns = free_distance.shape[1]
    potential = np.full(free_distance.size, np.inf, dtype=np.float32)
    source, target = _cell(start, columns), _cell(goal, columns)
    _spread(free_distance.ravel(), columns, target, potential)
    path = [source]
    while path[-1] != target:
        path.append(_lowest_neighbour(free_distance, potential, path[-1]))
    cells = np.array(path)
    return np.stack((cells % columns + 0.5, cells // columns + 0.5), axis=1)


@kernel
def _spread(free, columns, target, potential):
    queues = (np.empty(free.size, dtype=np.int32), np.empty(free.size, dtype=np.int32))
    waiting = np.zeros(free.size, dtype=np.bool_)
    late = np.empty(free.size, dtype=np.int32)
    potential[target] = 0.0
    n_now, n_late, limit, turn = 0, 0, WAVE, 0
    for offset in (1, -1, columns, -columns):
        n_now = _wait(free, waiting, queues[0], n_now, target + offset)
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
                    n_next = _wait(free, waiting, following, n_next, near)
                else:
                    n_late = _wait(free, waiting, late, n_late, near)
        if n_next == 0:
            following[:n_late] = late[:n_late]
            n_next, n_late, limit = n_late, 0, limit + WAVE
        n_now, turn = n_next, 1 - turn


@kernel
def _wait(free, waiting, queue, n_queued, cell):
    """Put a free cell that does not wait yet into a queue; return the queue's length."""
    if free[cell] == 0 or waiting[cell]:
        return n_queued
    waiting[cell] = True
    queue[n_queued] = cell
    return n_queued + 1


@kernel
def _raised(potential, cell, columns):
    """Potential of a cell from the lower one of its neighbours in each direction."""
    a = min(potential[cell - 1], potential[cell + 1])
    b = min(potential[cell - columns], potential[cell + columns])
    if abs(a - b) >= 1.0:
        return min(a, b) + 1.0
    return 0.5 * (a + b + math.sqrt(2.0 - (a - b) * (a - b)))


@kernel
def _lowest_neighbour(free_distance, potential, cell):
    columns = free_distance.shape[1]
    lowest, steepest = cell, 0.0
    for down, right in STEPS:
        near = cell + down * columns + right
        if not _may_step(free_distance, cell, down, right):
            continue
        length = DIAGONAL if down != 0 and right != 0 else 1.0
        slope = (potential[cell] - potential[near]) / length
        if slope > steepest:
            lowest, steepest = near, slope
    return lowest


@kernel
def _may_step(free_distance, cell, down, right):
    row, column = cell // free_distance.shape[1], cell % free_distance.shape[1]
    if free_distance[row + down, column + right] == 0:
        return False
    if down == 0 or right == 0:
        return True
    return free_distance[row + down, column] != 0 and free_distance[row, column + right] != 0


@kernel
def _cell(point, columns):
    return int(point[1]) * columns + int(point[0])


@kernel
def _octile(a, b, columns):
    rows_apart = abs(a // columns - b // columns)
    columns_apart = abs(a % columns - b % columns)
    shorter = min(rows_apart, columns_apart)
    return max(rows_apart, columns_apart) + (DIAGONAL - 1.0) * shorter


@kernel
def _trace(parent, source, target, columns):
    cells = [target]
    while cells[-1] != source:
        cells.append(parent[cells[-1]])
    path = np.empty((len(cells), 2))
    for k in range(len(cells)):
        cell = cells[len(cells) - 1 - k]
        path[k] = cell % columns + 0.5, cell // columns + 0.5
    return path
