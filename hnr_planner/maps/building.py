"""Generate a map like that of a real building: an office floor, surveyed by a simulated laser."""

from __future__ import annotations

from hnr_planner.maps.floor_plan import draw_floor_plan
from hnr_planner.maps.furniture import furnish
from hnr_planner.maps.occupancy import OccupancyMap
from hnr_planner.maps.survey import survey
import numpy as np


def building(seed: int, *, resolution: float = 0.05, margin: float = 1.5) -> OccupancyMap:
    """
    Generate an office floor of 40 m x 25 m as a survey would show it.

    Corridors, offices, meeting rooms, storage rooms and a hall with columns, furnished, with
    doors of 0.9 m to 1.2 m; a robot of radius 0.22 m gets into every room. Walls are ragged,
    cells that no ray reached are unknown.

    Parameters
    ----------
    seed : int
        The same seed gives the same map.
    resolution, margin : float
        Side of a cell, and width of the strip around the building that belongs to the map [m].
        The building's lower left corner is the map frame's (0, 0).

    """
    rng = np.random.default_rng(seed)
    plan = draw_floor_plan(rng)
    furnish(rng, plan)
    return survey(rng, plan, resolution, margin)
