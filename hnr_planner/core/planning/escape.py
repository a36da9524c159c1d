"""
Escape from a start that is not free: a short segment to free space, never through an obstacle.

The position of a robot may be blocked in the map: a little too near to a wall, or in an unknown
cell. The escape is a straight segment to free space that crosses nothing but free cells, cells
that only inflation blocks, and the cell of the start itself. From a start in an obstacle there is
no escape.
"""

from hnr_planner.core.checks import Floats
from hnr_planner.core.spaces.grid.grid_space import GridSpace
import numpy as np
from numpy.typing import NDArray


def escape_point(space: GridSpace, start: Floats, goal: Floats, radius: float) -> Floats | None:
    """
    Return the free point (2,) [m] to which a start escapes; None when there is none.

    It is the nearest point of free space, at most ``radius`` away, that a straight segment from
    the start reaches through cells that are free or only inflated, or hold the start. Any point
    from which the goal can be reached comes before all others. Tested are the centre of each free
    cell and the point of the cell nearest to the start. A start in an obstacle has no such point,
    nor has one outside the map: what lies between it and the map is unknown.

    Parameters
    ----------
    space : GridSpace
        The map.
    start, goal : (2,)
        Start and goal of the path to be planned, caller's frame [m].
    radius : float
        Length of the longest escape [m].

    """
    cell = None if not space.reaches_to(start) else _own_cell(space, start)
    if cell is None:
        return None
    reach = radius / space.resolution
    here = space.to_cells(start)
    first = np.maximum(np.minimum(np.floor(here - reach), cell), 0.0).astype(int)
    last = np.maximum(np.minimum(np.ceil(here + reach), space.shape[::-1]), cell + 1).astype(int)
    window = slice(first[1], last[1]), slice(first[0], last[0])
    components = space.components[window]
    passable = (components > 0) | space.inflated(*window)
    passable[cell[1] - first[1], cell[0] - first[0]] = True
    # On the edge of its cell the start may touch an obstacle: the segment begins inside the edge.
    inside = np.clip(here, cell + space.margin, cell + 1.0 - space.margin)
    points, reachable = _free_points(components, first, here, space.margin)
    lengths = np.hypot(*(points - here).T)
    order = np.lexsort([lengths, reachable != space.component_of(goal)])
    allowed = GridSpace.from_blocked(~passable)
    for point in points[order[lengths[order] <= reach]]:
        if allowed.is_path_free(np.stack([inside, point]) - first):
            return space.from_cells(point)
    return None


def _own_cell(space: GridSpace, start: Floats) -> NDArray[np.int64] | None:
    """
    Return the (column, row) of the cell that holds ``start`` (2,) [m], caller's frame.

    It is None where every cell that holds the start is an obstacle or outside the map.
    """
    here = space.to_cells(start)
    rows, columns = space.shape
    # A start on an edge or corner is held by each cell that touches it.
    upper, lower = np.floor(here).astype(int), np.ceil(here).astype(int) - 1
    for x in (upper[0], lower[0]):
        for y in (upper[1], lower[1]):
            if 0 <= x < columns and 0 <= y < rows and not space.is_obstacle(y, x):
                return np.array([x, y])
    return None


def _free_points(
    components: NDArray[np.int32], first: NDArray[np.int64], here: Floats, margin: float
) -> tuple[Floats, NDArray[np.int32]]:
    """
    Return points (k, 2) of the free cells of a window, and the component (k,) of each point.

    For each cell these are the point nearest to ``here`` (2,), ``margin`` inside the cell, and the
    centre. Points and ``here`` are in units of cells, from the corner of the whole grid; ``first``
    is the (column, row) where the window begins. A shortest escape ends where it enters free
    space, so cells all of whose neighbours are free are left out.
    """
    import cv2  # only where it is needed: it takes long to import

    free = components > 0
    amid = cv2.erode(free.view(np.uint8), np.ones((3, 3), dtype=np.uint8), borderValue=0) > 0
    rows, columns = np.nonzero(free & ~amid)
    cells = np.stack([columns, rows], axis=-1) + first
    nearest = np.clip(here, cells + margin, cells + (1.0 - margin))
    return np.concatenate([nearest, cells + 0.5]), np.tile(components[rows, columns], 2)
