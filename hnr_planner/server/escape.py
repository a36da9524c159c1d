"""
The way out of a start that is not free: straight, short, and never through an obstacle.

A robot may well stand where the map says it cannot: a little too near to a wall, or in a cell
that a sensor saw wrongly. It is led to free space in a straight line that crosses no occupied
cell. Only an obstacle that the start itself lies in or touches cannot count, and of that only what
has no higher a value than the start: from a costmap's inflation no way leads through the wall.
"""

from typing import NamedTuple

import cv2
from hnr_planner.core import GridSpace
from hnr_planner.core.spaces.primitives import component
from hnr_planner.server.map_store import MapSnapshot
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


def escape_point(
    snapshot: MapSnapshot, start: tuple[float, float], goal: tuple[float, float], radius: float
) -> Floats | None:
    """
    Return the nearest free point (2,) that a straight way leads to; None when there is none.

    Points from which the goal can be reached come first, unless the start lies in an obstacle: the
    nearest point is then most likely on the side that the robot is on. Of each cell its nearest
    point and, where that is hidden behind a corner, its centre are tried. A start outside the map
    has no way in: nothing is known of what lies between.

    Parameters
    ----------
    snapshot : MapSnapshot
        The map.
    start, goal : (x, y)
        In metres, in the frame of the map.
    radius : float
        Longest way out [m].

    """
    space = snapshot.space
    if not space.reaches_to(start):
        return None
    here = space.to_kernel(np.array(start)) - space.frame.RIM
    surroundings = _Surroundings.cut(snapshot, here, radius / space.resolution)
    exits = surroundings.exits(space.margin)
    lengths = np.hypot(*(exits.points - surroundings.here).T)
    elsewhere = exits.parts != component(space.data, space.to_kernel(np.array(goal)))
    if surroundings.in_obstacle:
        elsewhere[:] = False
    order = np.lexsort([lengths, elsewhere])
    within = lengths[order] <= radius / space.resolution
    obstacles = GridSpace.from_blocked(surroundings.obstacles)
    for point in exits.points[order[within]]:
        if obstacles.is_path_free(np.stack([surroundings.here, point])):
            return space.from_kernel(point + surroundings.corner + space.frame.RIM)
    return None


class _Exits(NamedTuple):
    """Points (k, 2) of free cells, and the connected part (k,) of free space each is in."""

    points: Floats
    parts: NDArray[np.int32]


class _Surroundings(NamedTuple):
    """
    A window of the map around a start, with a rim of one open cell; lengths are in cells.

    Attributes
    ----------
    corner : (2,)
        Where the window begins on the map, (column, row).
    here : (2,)
        The start, from that corner.
    parts : (rows, columns) int32
        Connected part of free space that each cell belongs to; 0 where it is not free.
    obstacles : (rows, columns) bool
        Occupied cells, but for those of an obstacle that the start lies in or touches with no
        higher a value than there.
    in_obstacle : bool
        Whether the start lies in an obstacle or touches one.

    """

    corner: Floats
    here: Floats
    parts: NDArray[np.int32]
    obstacles: Bools
    in_obstacle: bool

    @classmethod
    def cut(cls, snapshot: MapSnapshot, here: Floats, reach: float) -> '_Surroundings':
        """Cut out all that is within `reach` of `here`."""
        space = snapshot.space
        first = np.maximum(np.floor(here - reach), 0.0).astype(int)
        last = np.minimum(np.ceil(here + reach), space.shape[::-1]).astype(int)
        window = slice(first[1], last[1]), slice(first[0], last[0])
        parts = np.pad(space.data.labels[1:-1, 1:-1][window], 1)
        occupied = np.pad(space.occupied[window], 1)
        values = np.where(occupied, np.pad(snapshot.grid.data[window], 1), -1)
        here = here - (first - 1)
        around = _cells_around(here)
        _, obstacle = cv2.connectedComponents(occupied.view(np.uint8), connectivity=8)
        own = np.isin(obstacle, obstacle[around]) & (values <= values[around].max())
        in_obstacle = bool(occupied[around].any())
        return cls(first - 1.0, here, parts, occupied & ~own, in_obstacle)

    def exits(self, margin: float) -> _Exits:
        """
        Return free points that some way leads to from here.

        A shortest way enters free space where it ends, so cells amid free ones are left out.
        """
        _, region = cv2.connectedComponents((~self.obstacles).view(np.uint8), connectivity=4)
        around = region[_cells_around(self.here)]
        free = self.parts > 0
        amid = cv2.erode(free.view(np.uint8), np.ones((3, 3), dtype=np.uint8)) > 0
        rows, columns = np.nonzero(free & ~amid & np.isin(region, around[around > 0]))
        cells = np.stack([columns, rows], axis=-1)
        nearest = np.clip(self.here, cells + margin, cells + (1.0 - margin))
        parts = self.parts[rows, columns]
        return _Exits(np.concatenate([nearest, cells + 0.5]), np.tile(parts, 2))


def _cells_around(point: Floats) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the rows and columns of the cells that hold a point, on their edges as well."""
    lower, upper = np.ceil(point).astype(int) - 1, np.floor(point).astype(int)
    columns, rows = np.array([lower, upper]).T
    return np.repeat(rows, 2), np.tile(columns, 2)
