"""
Warnings about a map that can be used, but suggests a mistake in the setup.

The mistakes are a robot without a radius on a map that is not inflated, a footprint on a map that
is, and a map without a frame.
"""

from hnr_planner.maps import OccupancyMap
from hnr_planner.server.parameters.settings import Settings
import numpy as np

#: The value, in an ``OccupancyGrid`` of a Nav2 costmap, of a cell that the centre of the robot
#: must not enter.
INSCRIBED = 99


class MapAdvice:
    """Gives warnings about maps, each kind only once in its lifetime."""

    def __init__(self) -> None:
        self._given: set[str] = set()

    def warnings(self, occupancy: OccupancyMap, settings: Settings) -> list[str]:
        """Return the warnings about ``occupancy`` of those kinds that were not returned before."""
        found = {
            'radius': _about_radius(occupancy, settings),
            'footprint': _about_footprint(occupancy, settings),
            'frame': _about_frame(occupancy),
        }
        new = {name: text for name, text in found.items() if text and name not in self._given}
        self._given |= set(new)
        return list(new.values())


def _about_radius(occupancy: OccupancyMap, settings: Settings) -> str:
    """
    Return a warning if paths would be those of a point robot on a map that is not inflated.

    Empty when there is a footprint, the radius is above 0, the occupied threshold is that for a
    costmap, or any cell has the value ``INSCRIBED`` of an inflated costmap.
    """
    if (
        settings.vertices
        or settings.robot_radius > 0.0
        or settings.occupied_threshold >= INSCRIBED
    ):
        return ''
    if np.any(occupancy.data == INSCRIBED):
        return ''
    return (
        'robot_radius is 0 m and the map is not an inflated costmap: paths are those of a point '
        'and may touch obstacles; set robot_radius to the circumscribed radius of the robot'
    )


def _about_footprint(occupancy: OccupancyMap, settings: Settings) -> str:
    """Return a warning if a footprint is held against an inflated costmap; else an empty text."""
    if not settings.vertices or settings.occupied_threshold > INSCRIBED:
        return ''
    if not np.any(occupancy.data == INSCRIBED):
        return ''
    return (
        'the map is an inflated costmap, and the footprint is held against its inflation too: set '
        'occupied_threshold to 100, so that obstacles alone count'
    )


def _about_frame(occupancy: OccupancyMap) -> str:
    """Return a warning if the frame of the map is empty; otherwise an empty text."""
    if occupancy.frame:
        return ''
    return (
        'the map has an empty frame_id: paths, samples and markers have none either, and a start '
        'or goal in any named frame is refused as BAD_FRAME'
    )
