"""Warnings about a map that can be used, but hardly in the way that was meant."""

from hnr_planner.maps import OccupancyMap
from hnr_planner.server.settings import Settings
import numpy as np

#: The value of a cell of Nav2's costmaps in which the centre of the robot must not be.
INSCRIBED = 99


class MapAdvice:
    """Makes each kind of warning once."""

    def __init__(self) -> None:
        self._given: set[str] = set()

    def warnings(self, occupancy: OccupancyMap, settings: Settings) -> list[str]:
        """Return the warnings about a map that have not been given yet."""
        found = {
            'radius': _about_radius(occupancy, settings),
            'frame': _about_frame(occupancy),
        }
        new = {name: text for name, text in found.items() if text and name not in self._given}
        self._given |= set(new)
        return list(new.values())


def _about_radius(occupancy: OccupancyMap, settings: Settings) -> str:
    """Return a warning where paths are those of a point on a map that is not inflated."""
    if settings.robot_radius > 0.0 or settings.occupied_threshold >= INSCRIBED:
        return ''
    if np.any(occupancy.data == INSCRIBED):
        return ''
    return (
        'robot_radius is 0 m and the map is not an inflated costmap: paths are those of a point '
        'and may touch obstacles; set robot_radius to the circumscribed radius of the robot'
    )


def _about_frame(occupancy: OccupancyMap) -> str:
    """Return a warning where a map has no frame."""
    if occupancy.frame:
        return ''
    return (
        'the map has an empty frame_id: paths, samples and markers have none either, and a start '
        'or goal in any named frame is refused as BAD_FRAME'
    )
