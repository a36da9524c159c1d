"""Obstacles of a map: its occupied cells, and the cells that their inflation blocks."""

from dataclasses import dataclass

from hnr_planner.core.spaces.grid.cells import Bools
from hnr_planner.core.spaces.grid.fields import inflate
import numpy as np
from numpy.typing import ArrayLike, NDArray

#: Value of the cells of a Nav2 costmap that inflation blocks; obstacles have 100. A map whose
#: ``occupied_threshold`` is this value is taken for such a costmap.
COSTMAP_INFLATED = 99


def costmap_inflation(data: ArrayLike, occupied_threshold: int) -> Bools | None:
    """
    Return which cells (rows, cols) of a Nav2 costmap are inflation; None for other maps.

    A map is taken for a costmap if ``occupied_threshold`` is ``COSTMAP_INFLATED``, 99.
    """
    return np.asarray(data) == COSTMAP_INFLATED if occupied_threshold == COSTMAP_INFLATED else None


@dataclass(frozen=True, eq=False)
class Obstacles:
    """
    The occupied cells of a map, as distinguished from those that inflation blocks.

    Attributes
    ----------
    distance : (rows + 2, cols + 2) uint8
        Chebyshev distance [cells] from each cell to the nearest occupied cell, at most 255, with a
        rim of one cell that does not count as occupied.
    radius : float
        Radius of the inflation of occupied cells [cells].
    costmap_inflation : (rows, cols) bool or None
        Which occupied cells are themselves the inflation of a costmap; None if the map is no
        costmap.
    closed : (rows, cols) bool
        Which cells are blocked because they are unknown.

    """

    distance: NDArray[np.uint8]
    radius: float
    costmap_inflation: Bools | None
    closed: Bools

    @property
    def occupied(self) -> Bools:
        """Which cells (rows, cols) are occupied in the map, before inflation."""
        return self.distance[1:-1, 1:-1] == 0

    @property
    def uninflated(self) -> Bools:
        """Which cells (rows, cols) are obstacles or unknown and closed, without any inflation."""
        occupied = self.occupied
        if self.costmap_inflation is not None:
            occupied = occupied & ~self.costmap_inflation
        return occupied | self.closed

    def is_obstacle(self, row: int, column: int) -> bool:
        """Return whether cell [row, column] is occupied, and not as inflation in a costmap."""
        return bool(self.distance[row + 1, column + 1] == 0) and not (
            self.costmap_inflation is not None and self.costmap_inflation[row, column]
        )

    def inflated(self, rows: slice, columns: slice) -> Bools:
        """
        Return which cells of a window of rows and columns only inflation blocks.

        The inflation is that by the robot's radius or that of a costmap. Cells [row, column] are
        counted in the map, without the rim.
        """
        reach = int(min(self.radius, max(self.distance.shape))) + 1
        top, left = max(rows.start - reach, 0), max(columns.start - reach, 0)
        around = slice(top, rows.stop + reach), slice(left, columns.stop + reach)
        occupied = self.distance[1:-1, 1:-1][around] == 0
        inner = (
            slice(rows.start - top, rows.stop - top),
            slice(columns.start - left, columns.stop - left),
        )
        inflated = inflate(occupied, self.radius)[inner] & ~occupied[inner]
        if self.costmap_inflation is not None:
            inflated |= self.costmap_inflation[rows, columns]
        return inflated

    def why_blocked(self, row: int, column: int, robot_radius: float) -> str:
        """Return the reason why cell [row, column] is blocked; name ``robot_radius`` [m] in it."""
        cell = f'cell [{row}, {column}]'
        if self.is_obstacle(row, column):
            return f'inside an obstacle: {cell} is occupied'
        if self.distance[row + 1, column + 1] == 0:
            return f'within the inflation of the costmap around an obstacle, in {cell}'
        if self.inflated(slice(row, row + 1), slice(column, column + 1)).item():
            return f'within the robot radius of {robot_radius:g} m of an obstacle, in {cell}'
        return f'in unknown space: {cell} is unknown'
