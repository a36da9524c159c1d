"""Conversion of ``nav_msgs/OccupancyGrid`` to and from ``OccupancyMap``, without Python loops."""

import array
from typing import Any

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point, Pose, Quaternion
from hnr_planner.maps import OccupancyMap
from hnr_planner.server.geometry.orientations import quaternion_of
from hnr_planner.server.map.received_maps import received_map, updated_map
from nav_msgs.msg import MapMetaData, OccupancyGrid
import numpy as np
from std_msgs.msg import Header


def map_from_message(message: OccupancyGrid) -> OccupancyMap:
    """
    Return the map in ``message``; its data is a view of the data of ``message``, not a copy.

    Raises
    ------
    MapError
        When size, length, resolution or origin are impossible; the message names the value.

    """
    info = message.info
    position, rotation = info.origin.position, info.origin.orientation
    return received_map(
        np.frombuffer(message.data, dtype=np.int8),
        (info.height, info.width),
        info.resolution,
        (position.x, position.y, position.z),
        (rotation.x, rotation.y, rotation.z, rotation.w),
        message.header.frame_id,
    )


def map_with_update(occupancy: OccupancyMap | None, message: Any) -> OccupancyMap:
    """
    Return a copy of ``occupancy`` with the cells of a ``map_msgs/OccupancyGridUpdate``.

    Raises
    ------
    MapError
        When there is no map yet (``occupancy`` is None), or the update does not fit into it by
        place, size or frame; the message names the value.

    """
    return updated_map(
        occupancy,
        np.frombuffer(message.data, dtype=np.int8),
        (message.y, message.x),
        (message.height, message.width),
        message.header.frame_id,
    )


def message_from_map(occupancy: OccupancyMap, stamp: Time) -> OccupancyGrid:
    """Return the message for a map; ``stamp`` is the time of its header and of its loading."""
    rows, cols = occupancy.data.shape
    x, y, yaw = occupancy.origin
    qx, qy, qz, qw = quaternion_of(yaw)
    origin = Pose(
        position=Point(x=float(x), y=float(y), z=0.0),
        orientation=Quaternion(x=qx, y=qy, z=qz, w=qw),
    )
    info = MapMetaData(
        map_load_time=stamp,
        resolution=float(occupancy.resolution),
        width=int(cols),
        height=int(rows),
        origin=origin,
    )
    message = OccupancyGrid(header=Header(stamp=stamp, frame_id=occupancy.frame), info=info)
    cells = array.array('b')
    cells.frombytes(np.ascontiguousarray(occupancy.data, dtype=np.int8).tobytes())
    message.data = cells
    return message
