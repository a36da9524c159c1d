"""Corridors, each with a request from one end to the other."""

from __future__ import annotations

from typing import NamedTuple

from hnr_planner.maps.occupancy import FREE, OccupancyMap, OCCUPIED
import numpy as np
from numpy.typing import NDArray


class Corridor(NamedTuple):
    """
    A corridor and a request from one end to the other.

    ``blocked`` is (rows, cols) bool with row 0 at the bottom, its cells of the side
    ``resolution`` [m]. ``start`` and ``goal`` (x, y) [m] lie in the middle of the corridor, half
    its width from its ends; the paper's goal region around the goal has the radius
    ``goal_radius`` [m], half the corridor's width.
    """

    blocked: NDArray[np.bool_]
    resolution: float
    start: tuple[float, float]
    goal: tuple[float, float]
    goal_radius: float

    @property
    def occupancy(self) -> OccupancyMap:
        """The corridor as a map."""
        data = np.where(self.blocked, OCCUPIED, FREE).astype(np.int8)
        return OccupancyMap(data, self.resolution)
