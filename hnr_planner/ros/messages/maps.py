"""`nav_msgs/OccupancyGrid` to and from arrays, without a loop in Python."""

import array
from dataclasses import replace
import math
from typing import Any

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point, Pose, Quaternion
from hnr_planner.ros.messages.orientations import normalised, quaternion_of, tilt_of, yaw_of
from hnr_planner.server.map_store import Grid, MapError
from nav_msgs.msg import MapMetaData, OccupancyGrid
import numpy as np
from std_msgs.msg import Header

SMALLEST_RESOLUTION, LARGEST_RESOLUTION = 1e-4, 1e3
"""A map with smaller or larger cells [m] is a mistake: poses and clouds could not show it."""
LARGEST_TILT = 1e-3
"""A map whose origin is rolled or pitched by more than this [rad] is refused."""


def as_written(single: float) -> float:
    """
    Return the shortest decimal that is `single` in single precision.

    Messages carry a resolution of 0.05 m as 0.05000000074505806; a few thousand cells further
    that is no longer the place that the map file means.
    """
    return float(str(np.float32(single)))


def grid_from_message(message: OccupancyGrid) -> Grid:
    """
    Return the map in `message`; its data is a view, not a copy.

    Raises
    ------
    MapError
        When size, length, resolution or origin are impossible; the message names the value.

    """
    info = message.info
    if info.width == 0 or info.height == 0:
        raise MapError(f'the map has no cells: width {info.width}, height {info.height}')
    if len(message.data) != info.width * info.height:
        raise MapError(
            f'the map has {len(message.data)} values, but width {info.width} x height '
            f'{info.height} is {info.width * info.height}'
        )
    resolution = as_written(info.resolution)
    if not SMALLEST_RESOLUTION <= resolution <= LARGEST_RESOLUTION:
        raise MapError(
            f'the resolution must be in {SMALLEST_RESOLUTION:g}..{LARGEST_RESOLUTION:g} m, got '
            f'{resolution} m'
        )
    data = np.frombuffer(message.data, dtype=np.int8).reshape(info.height, info.width)
    return Grid(data, resolution, _origin(info.origin), message.header.frame_id)


def updated(grid: Grid | None, message: Any) -> Grid:
    """
    Return `grid` with the part that a `map_msgs/OccupancyGridUpdate` brings; nothing is changed.

    Raises
    ------
    MapError
        When there is no map yet, or the part is not one of it; the message names the value.

    """
    if grid is None:
        raise MapError('an update of a part came before the map')
    rows, cols = grid.data.shape
    x, y, width, height = message.x, message.y, message.width, message.height
    if x < 0 or y < 0 or x + width > cols or y + height > rows:
        raise MapError(
            f'an update of {width} x {height} cells at column {x}, row {y} is not inside the map '
            f'of {cols} x {rows} cells'
        )
    if len(message.data) != width * height:
        raise MapError(
            f'an update has {len(message.data)} values, but width {width} x height {height} is '
            f'{width * height}'
        )
    if message.header.frame_id not in ('', grid.frame):
        raise MapError(
            f"an update is in frame '{message.header.frame_id}', the map in '{grid.frame}'"
        )
    data = grid.data.copy()
    part = np.frombuffer(message.data, dtype=np.int8).reshape(height, width)
    last_row, last_col = y + height, x + width
    data[y:last_row, x:last_col] = part
    return replace(grid, data=data)


def _origin(pose: Pose) -> tuple[float, float, float]:
    """Return (x, y, yaw) of the map's origin, or raise MapError."""
    position, rotation = pose.position, pose.orientation
    place = (position.x, position.y, position.z)
    if not all(math.isfinite(number) for number in place):
        raise MapError(f"the map's origin must be finite, got {place}")
    quaternion = (rotation.x, rotation.y, rotation.z, rotation.w)
    unit = normalised(quaternion)
    if unit is None:
        raise MapError(
            f"the orientation of the map's origin must be a finite quaternion with a norm above "
            f'0, got {list(quaternion)}'
        )
    if tilt_of(unit) > LARGEST_TILT:
        raise MapError(
            f"the map's origin must be level, without roll or pitch, got {list(quaternion)}"
        )
    return position.x, position.y, yaw_of(unit)


def message_from_grid(grid: Grid, stamp: Time) -> OccupancyGrid:
    """Return the message for a map."""
    rows, cols = grid.data.shape
    x, y, yaw = grid.origin
    qx, qy, qz, qw = quaternion_of(yaw)
    origin = Pose(
        position=Point(x=float(x), y=float(y), z=0.0),
        orientation=Quaternion(x=qx, y=qy, z=qz, w=qw),
    )
    info = MapMetaData(
        map_load_time=stamp,
        resolution=float(grid.resolution),
        width=int(cols),
        height=int(rows),
        origin=origin,
    )
    message = OccupancyGrid(header=Header(stamp=stamp, frame_id=grid.frame), info=info)
    cells = array.array('b')
    cells.frombytes(np.ascontiguousarray(grid.data, dtype=np.int8).tobytes())
    message.data = cells
    return message
