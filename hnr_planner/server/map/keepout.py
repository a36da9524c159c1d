"""
Keepout zones: areas that the centre of the robot must not enter, given by masks.

A zone blocks the cells that it touches and is not inflated. A start inside one is led out in a
straight line that passes no cell that is blocked without the zones.
"""

from collections.abc import Iterable

from hnr_planner.core import GridSpace
from hnr_planner.core.checks import Floats
from hnr_planner.core.spaces.grid.frame import GridFrame
from hnr_planner.maps import OccupancyMap
from hnr_planner.maps.occupancy import UNKNOWN
from hnr_planner.server.map.received_maps import MapError
import numpy as np
from numpy.typing import NDArray


def zones_on(
    occupancy: OccupancyMap, masks: Iterable[OccupancyMap], threshold: int
) -> NDArray[np.bool_] | None:
    """
    Return which cells (rows, cols) of a map are in a zone; None where there are no masks.

    A cell of a mask is in a zone when its value is ``threshold`` or more, up to 100. A cell of the
    map is when its centre lies in such a cell, or the centre of such a cell lies in it.

    Raises
    ------
    MapError
        When a mask is in another frame than the map.

    """
    zones = None
    for mask in masks:
        if mask.frame not in ('', occupancy.frame):
            raise MapError(
                f"a keepout mask is in frame '{mask.frame}', the map in '{occupancy.frame}'"
            )
        zones = np.zeros(occupancy.data.shape, dtype=bool) if zones is None else zones
        zones |= _zone_of(mask, threshold, occupancy)
    return zones


def with_zones(
    data: NDArray[np.int8], zones: NDArray[np.bool_], unknown: str, threshold: int
) -> NDArray[np.int8]:
    """
    Return the cells of a map in which those in a zone are unknown, so that they block.

    They are for a space in which unknown cells are blocked. Where ``unknown`` is 'free', unknown
    cells outside the zones become free. Occupied cells, of ``threshold`` or more, stay so.
    """
    occupied = (data >= threshold) & (data <= 100)
    cells = data.copy()
    if unknown == 'free':
        cells[(data < 0) | (data > 100)] = 0
    cells[zones & ~occupied] = UNKNOWN
    return cells


def nearest_exit(
    space: GridSpace, outside_zones: GridSpace, start: Floats, goal: Floats
) -> Floats | None:
    """
    Return the free point (2,) [m] to which a start in a zone is led; None where there is none.

    It is the nearest one that a straight segment from the start reaches without a cell that is
    blocked in ``outside_zones``, the space of the same map without zones. Points from which the
    goal can be reached come before all others.
    """
    rows, cols = _rim(space.components > 0)
    here = space.to_cells(start)
    cells = np.stack([cols, rows], axis=1)
    points = np.clip(here, cells + space.margin, cells + (1.0 - space.margin))
    reachable = space.components[rows, cols] == space.component_of(goal)
    for point in points[np.lexsort([np.hypot(*(points - here).T), ~reachable])]:
        target = space.from_cells(point)
        if outside_zones.is_motion_valid(start, target) and space.contains(target):
            return target
    return None


def _rim(free: NDArray[np.bool_]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return rows and columns of the free cells that touch one that is not free."""
    import cv2  # only where it is needed: it takes long to import

    amid = cv2.erode(free.view(np.uint8), np.ones((3, 3), dtype=np.uint8), borderValue=0) > 0
    rows, cols = np.nonzero(free & ~amid)
    return rows, cols


def _zone_of(mask: OccupancyMap, threshold: int, occupancy: OccupancyMap) -> NDArray[np.bool_]:
    """Return which cells (rows, cols) of a map are in a zone of one mask."""
    zone = np.zeros(occupancy.data.shape, dtype=bool)
    inside = (mask.data >= threshold) & (mask.data <= 100)
    if not inside.any():
        return zone
    here, there = _frame(occupancy), _frame(mask)
    # The cells of the map that hold a centre of the zone.
    centres = np.argwhere(inside)[:, ::-1].astype(np.float64) + 0.5
    found = _converted(centres, there, here)
    x, y = _cells_in(zone.shape, found).T
    zone[y, x] = True
    # The cells of the map whose centres are in the zone, looked for around these.
    around = 1.0 + 1.5 * mask.resolution / occupancy.resolution
    low = np.maximum(np.floor(found.min(axis=0) - around), 0).astype(int)
    high = np.minimum(np.ceil(found.max(axis=0) + around), zone.shape[::-1]).astype(int)
    columns, rows = np.meshgrid(np.arange(low[0], high[0]), np.arange(low[1], high[1]))
    cells = np.stack([columns.ravel(), rows.ravel()], axis=1)
    middles: Floats = cells.astype(np.float64) + 0.5
    there_cells = np.floor(_converted(middles, here, there)).astype(int)
    on_mask = _is_in(inside.shape, there_cells)
    (x, y), (mask_x, mask_y) = cells[on_mask].T, there_cells[on_mask].T
    zone[y, x] |= inside[mask_y, mask_x]
    return zone


def _frame(occupancy: OccupancyMap) -> GridFrame:
    return GridFrame.checked(occupancy.resolution, occupancy.origin, occupancy.data.shape)


def _converted(cells: Floats, a: GridFrame, b: GridFrame) -> Floats:
    """Return places (k, 2) [cells] of the grid ``a`` in cells of the grid ``b``."""
    return b.to_kernel(a.from_kernel(cells + a.RIM)) - b.RIM


def _cells_in(shape: tuple[int, ...], places: Floats) -> NDArray[np.int64]:
    """Return the cells (column, row) (k, 2) that hold those of ``places`` that are on a grid."""
    cells = np.floor(places).astype(np.int64)
    return cells[_is_in(shape, cells)]


def _is_in(shape: tuple[int, ...], cells: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Return which (column, row) of ``cells`` (k, 2) are cells of a grid."""
    return np.logical_and.reduce((cells >= 0) & (cells < shape[::-1]), axis=1)
