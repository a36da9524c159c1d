"""Warnings about maps that can be used, but hardly in the way that was meant."""

from dataclasses import replace
from test.server.test_requests import rooms

from hnr_planner.maps import OccupancyMap
from hnr_planner.server.map.map_advice import MapAdvice
from hnr_planner.server.parameters.settings import DEFAULTS, Settings
import pytest

MAP = OccupancyMap(rooms(), 0.1)
ROBOT = replace(DEFAULTS, robot_radius=0.2)


def costmap() -> OccupancyMap:
    """Return a map with the values of Nav2's costmaps."""
    data = rooms()
    data[:, 17] = 99
    return OccupancyMap(data, 0.1)


def test_point_robot_on_a_map_is_warned_about_once() -> None:
    advice = MapAdvice()
    (warning,) = advice.warnings(MAP, DEFAULTS)
    assert 'robot_radius is 0' in warning
    assert advice.warnings(MAP, DEFAULTS) == []
    assert advice.warnings(MAP, ROBOT) == []
    assert advice.warnings(MAP, DEFAULTS) == []


@pytest.mark.parametrize(
    ('occupancy', 'settings'),
    [
        (MAP, ROBOT),
        (costmap(), DEFAULTS),
        (MAP, replace(DEFAULTS, occupied_threshold=99)),
    ],
)
def test_robot_or_costmap_is_not_warned_about(occupancy: OccupancyMap, settings: Settings) -> None:
    assert MapAdvice().warnings(occupancy, settings) == []


def test_map_without_a_frame_is_warned_about_with_what_follows() -> None:
    nameless = replace(MAP, frame='')
    (warning,) = MapAdvice().warnings(nameless, ROBOT)
    assert 'frame_id' in warning and 'BAD_FRAME' in warning
