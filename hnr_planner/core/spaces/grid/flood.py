"""Flood fill of a grid: find a path through the centres of cells if there is any free path."""

import math

from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.copies import copy_into, copy_rows
from hnr_planner.core.kernels.kernel import kernel
import numpy as np

#: Steps to the cells that share an edge, (rows, columns).
STEPS = ((0, 1), (1, 0), (0, -1), (-1, 0))


@kernel
def flood_path_in_grid(grid, start, goal, goal_radius, margin):
    """
    Return a path (m, 2) found by breadth-first search over free cells; (0, 2) for none.

    All points and lengths are in the kernel frame [cells]. ``start`` has to be free. The path ends
    at ``goal`` for a ``goal_radius`` of 0, else within that radius, at least ``margin`` inside a
    cell.
    """
    grid = borrowed(grid)
    free_distance = grid.free_distance
    rows, columns = free_distance.shape
    #: Number of the step, from 1, by which each cell was reached; 5 for the first cell.
    reached_by = np.zeros((rows, columns), dtype=np.uint8)
    queue = np.empty(rows * columns, dtype=np.int64)
    row, column = math.floor(start[1]), math.floor(start[0])
    reached_by[row, column] = len(STEPS) + 1
    queue[0], done, end = row * columns + column, 0, 1
    nearest = np.empty(2)
    while done < end:
        row, column = queue[done] // columns, queue[done] % columns
        done += 1
        if _reaches(row, column, goal, goal_radius, margin, nearest):
            return _path_through(reached_by, start, row, column, nearest)
        for step in range(len(STEPS)):
            i, j = row + STEPS[step][0], column + STEPS[step][1]
            if free_distance[i, j] > 0 and reached_by[i, j] == 0:
                reached_by[i, j] = step + 1
                queue[end] = i * columns + j
                end += 1
    return np.empty((0, 2))


@kernel
def _reaches(row, column, goal, goal_radius, margin, nearest):
    """
    Return whether a cell reaches the goal, and write the point where to ``nearest`` (2,).

    For a ``goal_radius`` of 0 the cell has to hold the goal. Otherwise its point nearest to the
    goal, ``margin`` inside the cell, has to be within that radius.
    """
    if goal_radius == 0.0:
        copy_into(nearest, goal)
        return row == math.floor(goal[1]) and column == math.floor(goal[0])
    nearest[0] = min(max(goal[0], column + margin), column + 1 - margin)
    nearest[1] = min(max(goal[1], row + margin), row + 1 - margin)
    squared = (nearest[0] - goal[0]) ** 2 + (nearest[1] - goal[1]) ** 2
    return squared <= goal_radius**2


@kernel
def _path_through(reached_by, start, row, column, end):
    """Return the path (m, 2) from the start to the cell [row, column], and on to ``end``."""
    path, n, before = np.empty((64, 2)), 1, 0
    copy_into(path[0], end)
    while True:
        step = reached_by[row, column]
        # A vertex wherever the direction changes, the first and the last cell included.
        if step != before:
            if n + 1 == len(path):
                larger = np.empty((2 * len(path), 2))
                copy_rows(larger[:n], path)
                path = larger
            path[n, 0], path[n, 1] = column + 0.5, row + 0.5
            n += 1
        if step > len(STEPS):
            break
        row, column, before = row - STEPS[step - 1][0], column - STEPS[step - 1][1], step
    copy_into(path[n], start)
    forwards = np.empty((n + 1, 2))
    copy_rows(forwards, path[n::-1])
    return forwards
