"""Occupancy grids, as map files hold them and planners take them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

#: Values of cells.
FREE, OCCUPIED, UNKNOWN = 0, 100, -1


@dataclass(frozen=True, eq=False)
class OccupancyMap:
    """
    An occupancy grid and its pose in the map frame.

    Attributes
    ----------
    data : (rows, cols) int8
        -1 for unknown, else the probability in percent (0..100) that the cell is occupied. Row 0
        is the row nearest the origin, column 0 the column nearest it, as in ``OccupancyGrid``.
    resolution : float
        Side of a cell [m].
    origin : (x, y, yaw)
        Pose of the outer corner of cell [0, 0] in the map frame [m, m, rad].

    """

    data: NDArray[np.int8]
    resolution: float
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
