"""
The largest disc in a footprint, and the space of its centre.

Wherever the footprint fits, the disc does: so where no path of the disc joins two places, no path
of the footprint does. The disc moves on cells that are blocked where its centre cannot be. A point
of a cell is at most half the cell's diagonal from the middle of the cell, and half a cell nearer
to the edge of a square than to the middle of that: with a radius that is less by the difference,
no cell is blocked in which the centre can be.
"""

from dataclasses import dataclass
from functools import cached_property
import math

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import inlined
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

    @cached_property
    def kernel_centre(self) -> Floats:
        """Centre (2,) in the robot's frame [cells]."""
        return self.centre / self.space.scale

    def place(self, pose: Floats) -> Floats:
        """Return the disc's centre (2,) [m] at a pose (3,) of the robot, map frame."""
        return np.array(disc_place(self.centre, pose))

    def cell_place(self, pose: Floats) -> Floats:
        """Return the disc's centre (2,) [cells] at a pose (3,) of the robot, kernel frame."""
        return np.array(disc_place(self.kernel_centre, pose))


@inlined
def disc_place(centre, pose):
    """Return where the disc's ``centre`` (2,) in the robot's frame is at a pose (3,): (x, y)."""
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    return (
        pose[0] + cos * centre[0] - sin * centre[1],
        pose[1] + sin * centre[0] + cos * centre[1],
    )


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
