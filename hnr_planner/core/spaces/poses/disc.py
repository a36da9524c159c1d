"""
The largest disc in a footprint, and the space of its centre.

Wherever the footprint fits, the disc does: so where no path of the disc joins two places, no path
of the footprint does. The disc moves on cells that are blocked where its centre cannot be. A point
of a cell is at most half the cell's diagonal from the middle of the cell, and half a cell nearer
to the edge of a square than to the middle of that: with a radius that is less by the difference,
no cell is blocked in which the centre can be.
"""

from dataclasses import dataclass
import math

from hnr_planner.core.checks import Floats
from hnr_planner.core.spaces.grid.grid_space import GridSpace
import numpy as np

#: What the radius of the disc is lessened by [cells].
LESS = (math.sqrt(2.0) - 1.0) / 2.0 + 1e-6


@dataclass(frozen=True)
class Disc:
    """
    The largest disc in a footprint, and the space of its centre.

    Attributes
    ----------
    centre : (2,)
        Centre in the robot's frame [m].
    space : GridSpace
        A grid in which every cell is free that the disc's centre can be in.

    """

    centre: Floats
    space: GridSpace

    def place(self, pose: Floats) -> Floats:
        """Return the disc's centre (2,) [m] at a pose (3,) of the robot, map frame."""
        cos, sin = math.cos(pose[2]), math.sin(pose[2])
        turned = np.array([[cos, -sin], [sin, cos]]) @ self.centre
        placed: Floats = pose[:2] + turned
        return placed


def largest_disc(grid: GridSpace, footprint: Floats) -> Disc:
    """Return the largest disc in a footprint (k, 2) [m], and the space of its centre on a grid."""
    from shapely import Polygon
    from shapely.ops import polylabel

    outline, size = Polygon(footprint), float(np.ptp(footprint, axis=0).max())
    centre = polylabel(outline, tolerance=1e-3 * size)
    radius = float(centre.distance(outline.exterior))
    radius = max(radius - LESS * grid.resolution, 0.0)
    space = GridSpace.from_blocked(
        grid.uninflated, grid.resolution, grid.origin, robot_radius=radius
    )
    return Disc(np.array([centre.x, centre.y]), space)
