"""Build the cells of compiled polygons: the edges near each cell, the polygon at its corner."""

import math

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.polygon.edges import AROUND, is_right, line, PolygonData
import numpy as np
from numpy.typing import NDArray

#: Number of cells in the bounds, divided by the number of edges.
CELLS_FOR_AN_EDGE = 2.0


def edges_in_cells(edges: Floats, numbers: NDArray[np.int32], rounding: float) -> PolygonData:
    """
    Return compiled polygons: sort edges into a grid of cells.

    Parameters
    ----------
    edges : (m, 4)
        Ends (x, y, x, y) of each edge, kernel frame, with the inside of its polygon on the left.
    numbers : (m,) int32
        Number of the polygon of each edge, from 1.
    rounding : float
        Distance to an edge up to which a point counts as on the edge.

    """
    corners = edges.reshape(-1, 2)
    lower, extent = corners.min(axis=0), np.ptp(corners, axis=0)
    side = math.sqrt(extent.prod() / (CELLS_FOR_AN_EDGE * len(edges)))
    # A long thin polygon gets fewer cells, in a single row.
    side = max(side, extent.max() / (CELLS_FOR_AN_EDGE * len(edges)))
    columns, rows = (extent / side).astype(int) + 1
    levels = np.zeros((rows, columns), dtype=np.int32)
    _level(edges, numbers, lower, side, levels)
    first = np.zeros(rows * columns + 1, dtype=np.int32)
    _enlist(edges, lower, side, (rows, columns), first[1:], np.empty(0, dtype=np.int32))
    first = np.cumsum(first, dtype=np.int32)
    near = np.empty(first[-1], dtype=np.int32)
    _enlist(edges, lower, side, (rows, columns), first[:-1].copy(), near)
    return PolygonData(edges, numbers, rounding, lower, side, levels, first, near)


@kernel
def _enlist(edges, lower, side, shape, filled, near):
    """
    Append each edge to the lists of the cells near the edge, or only count the entries.

    ``filled`` (cells,) is the index in ``near`` (entries,) at which the list of each cell ends; it
    is advanced by the appended edges. With an empty ``near`` it is advanced, and nothing written.
    """
    rows, columns = shape
    for k in range(len(edges)):
        ax, ay = (edges[k, 0] - lower[0]) / side, (edges[k, 1] - lower[1]) / side
        bx, by = (edges[k, 2] - lower[0]) / side, (edges[k, 3] - lower[1]) / side
        lowest, highest = min(ay, by) - AROUND, max(ay, by) + AROUND
        for row in range(max(math.floor(lowest), 0), min(math.floor(highest) + 1, rows)):
            s, t = 0.0, 1.0
            if ay != by:
                s, t = (row - AROUND - ay) / (by - ay), (row + 1 + AROUND - ay) / (by - ay)
                s, t = max(min(s, t), 0.0), min(max(s, t), 1.0)
            x, y = ax + s * (bx - ax), ax + t * (bx - ax)
            leftmost, rightmost = min(x, y) - AROUND, max(x, y) + AROUND
            for column in range(
                max(math.floor(leftmost), 0), min(math.floor(rightmost) + 1, columns)
            ):
                at = row * columns + column
                if len(near) > 0:
                    near[filled[at]] = k
                filled[at] += 1


@kernel
def _level(edges, numbers, lower, side, levels):
    """
    Add to ``levels`` the number of the polygon at the upper right corner of each cell.

    ``levels`` (rows, columns) has to be 0; it stays 0 where the corner is outside of all polygons.
    """
    rows, columns = levels.shape
    for k in range(len(edges)):
        ax, ay, bx, by = edges[k]
        first = max(math.floor((min(ay, by) - lower[1]) / side) - 1, 0)
        last = min(math.floor((max(ay, by) - lower[1]) / side) + 1, rows - 1)
        for row in range(first, last + 1):
            y = line(lower[1], side, row + 1)
            if (ay > y) == (by > y):
                continue
            # Differences from column to column, summed up from the right below.
            crossed = ax + (y - ay) / (by - ay) * (bx - ax)
            column = min(math.floor((crossed - lower[0]) / side) + 1, columns - 1)
            while column >= 0 and not is_right(edges, k, line(lower[0], side, column + 1), y):
                column -= 1
            if column >= 0:
                levels[row, column] += numbers[k] if by > y else -numbers[k]
    for row in range(rows):
        for column in range(columns - 2, -1, -1):
            levels[row, column] += levels[row, column + 1]
