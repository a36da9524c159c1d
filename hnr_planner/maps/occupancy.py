"""The occupancy grid with its place in the world: what map files hold and planners receive."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

#: Values of cells: the chance in percent that a cell is occupied, and -1 where it is unknown.
FREE, OCCUPIED, UNKNOWN = 0, 100, -1


@dataclass(frozen=True, eq=False)
class OccupancyMap:
    """
    An occupancy grid and its place in the world.

    Attributes
    ----------
    data : (rows, cols) int8
        -1 for unknown, else the chance in percent (0..100) that the cell is occupied. Row 0 is
        the row nearest the origin, column 0 the column nearest it, as in ``OccupancyGrid``.
    resolution : float
        Side of a cell [m].
    origin : (x, y, yaw)
        Pose of the outer corner of cell [0, 0] in the map frame [m, m, rad].
    frame : str
        Name of the map frame.

    """

    data: NDArray[np.int8]
    resolution: float
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    frame: str = 'map'

    def is_same_as(self, other: OccupancyMap | None) -> bool:
        """
        Return whether another map has the same cells at the same place in the same frame.

        Resolution, origin and frame have to be exactly equal. It is False for None.
        """
        return (
            other is not None
            and (self.resolution, self.origin, self.frame)
            == (other.resolution, other.origin, other.frame)
            and np.array_equal(self.data, other.data)
        )

    def __str__(self) -> str:
        """Return the size in cells, the resolution and the frame in words."""
        rows, cols = self.data.shape
        return f"{cols} x {rows} cells of {self.resolution:g} m in frame '{self.frame}'"
