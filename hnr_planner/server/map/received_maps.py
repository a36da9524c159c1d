"""Checks of the numbers of a received map or update, which become an ``OccupancyMap``."""

from dataclasses import replace
import math

from hnr_planner.core.errors import HnrError
from hnr_planner.maps import OccupancyMap
from hnr_planner.server.geometry.orientations import (
    normalised,
    Quaternion,
    tilt_of,
    Vector,
    yaw_of,
)
import numpy as np
from numpy.typing import NDArray

#: Allowed side of a cell [m]; other maps are taken for mistakes, since poses and point clouds
#: could not resolve them.
SMALLEST_RESOLUTION, LARGEST_RESOLUTION = 1e-4, 1e3

#: A map whose origin is rolled or pitched by more than this [rad] is refused.
LARGEST_TILT = 1e-3


class MapError(HnrError, ValueError):
    """A map, or an update of one, that cannot be used; the message says why."""


def as_written(single: float) -> float:
    """
    Return the shortest decimal that equals ``single`` in single precision.

    Messages carry a resolution of 0.05 m as 0.05000000074505806; over many cells the difference
    adds up, so that far cells would not be where the map file has them.
    """
    return float(str(np.float32(single)))


def received_map(
    cells: NDArray[np.int8],
    shape: tuple[int, int],
    resolution: float,
    position: Vector,
    orientation: Quaternion,
    frame: str,
) -> OccupancyMap:
    """
    Check the numbers of a map and return it; its data is a view of ``cells``, not a copy.

    Parameters
    ----------
    cells : (n,) int8
        Values of all cells, row by row.
    shape : (rows, cols)
        Size of the map by its message; it has to agree with the length of ``cells``.
    resolution : float
        Side of a cell in single precision [m]; the map gets the shortest decimal equal to it.
    position, orientation : (3,), (4,)
        Pose of the outer corner of cell [0, 0] in the map frame [m]; the quaternion
        (x, y, z, w) may have any norm, but must not be rolled or pitched by more than
        ``LARGEST_TILT``.
    frame : str
        Name of the map frame.

    Raises
    ------
    MapError
        When size, length, resolution or origin are impossible; the message names the value.

    """
    rows, cols = shape
    if rows == 0 or cols == 0:
        raise MapError(f'the map has no cells: width {cols}, height {rows}')
    if len(cells) != rows * cols:
        raise MapError(
            f'the map has {len(cells)} values, but width {cols} x height {rows} is {rows * cols}'
        )
    written = as_written(resolution)
    if not SMALLEST_RESOLUTION <= written <= LARGEST_RESOLUTION:
        raise MapError(
            f'the resolution must be in {SMALLEST_RESOLUTION:g}..{LARGEST_RESOLUTION:g} m, got '
            f'{written} m'
        )
    return OccupancyMap(cells.reshape(shape), written, _origin(position, orientation), frame)


def updated_map(
    occupancy: OccupancyMap | None,
    cells: NDArray[np.int8],
    corner: tuple[int, int],
    shape: tuple[int, int],
    frame: str,
) -> OccupancyMap:
    """
    Return a copy of ``occupancy`` in which a rectangle has new cells.

    Parameters
    ----------
    occupancy : OccupancyMap, optional
        The last good map; None when there was none.
    cells : (n,) int8
        Values of the new cells, row by row of the rectangle.
    corner, shape : (row, column), (rows, cols)
        Index in ``occupancy.data`` of the rectangle's cell of the lowest row and column, and the
        size of the rectangle in cells.
    frame : str
        Frame of the update; it must be that of ``occupancy``, or empty.

    Raises
    ------
    MapError
        When there is no map yet, the rectangle is not inside the map, ``cells`` has another
        length than the rectangle, or the frame is another; the message names the value.

    """
    if occupancy is None:
        raise MapError('an update of a part came before the map')
    (row, col), (height, width) = corner, shape
    rows, cols = occupancy.data.shape
    last_row, last_col = row + height, col + width
    if row < 0 or col < 0 or last_row > rows or last_col > cols:
        raise MapError(
            f'an update of {width} x {height} cells at column {col}, row {row} is not inside the '
            f'map of {cols} x {rows} cells'
        )
    if len(cells) != width * height:
        raise MapError(
            f'an update has {len(cells)} values, but width {width} x height {height} is '
            f'{width * height}'
        )
    if frame not in ('', occupancy.frame):
        raise MapError(f"an update is in frame '{frame}', the map in '{occupancy.frame}'")
    data = occupancy.data.copy()
    data[row:last_row, col:last_col] = cells.reshape(shape)
    return replace(occupancy, data=data)


def _origin(position: Vector, orientation: Quaternion) -> tuple[float, float, float]:
    """
    Return the pose (x, y, yaw) [m, m, rad] of a map's origin in the map frame.

    Raise MapError when it is not finite, the quaternion is 0, or it is rolled or pitched.
    """
    if not all(math.isfinite(number) for number in position):
        raise MapError(f"the map's origin must be finite, got {position}")
    unit = normalised(orientation)
    if unit is None:
        raise MapError(
            f"the orientation of the map's origin must be a finite quaternion with a norm above "
            f'0, got {list(orientation)}'
        )
    if tilt_of(unit) > LARGEST_TILT:
        raise MapError(
            f"the map's origin must be level, without roll or pitch, got {list(orientation)}"
        )
    return position[0], position[1], yaw_of(unit)
