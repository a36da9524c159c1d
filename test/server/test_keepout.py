"""Keepout zones block, whatever grid their mask has, and let a robot out that stands in one."""

from dataclasses import replace
import math
from test.brute_force import path_collisions
from test.server.test_requests import ask, RESOLUTION, SETTINGS, store

from hnr_planner.maps import OccupancyMap
from hnr_planner.server.map.keepout import zones_on
from hnr_planner.server.map.map_store import MapStore
from hnr_planner.server.map.received_maps import MapError
from hnr_planner.server.parameters.settings import Settings
from hnr_planner.server.requests.outcomes import Outcome
import numpy as np
import pytest

#: A free room of 4 m x 2 m, and a zone amid it that leaves a way below [m].
SHAPE = (20, 40)
LEFT, RIGHT, BOTTOM = 1.5, 2.5, 0.5


def mask(resolution: float = RESOLUTION, yaw: float = 0.0) -> OccupancyMap:
    """Return a mask of the zone alone, with its corner at the corner of the zone."""
    shape = (round((2.0 - BOTTOM) / resolution), round((RIGHT - LEFT) / resolution))
    data = np.full(shape, 100, dtype=np.int8)
    return OccupancyMap(data, resolution, (LEFT, BOTTOM, yaw), 'map')


def zone() -> np.ndarray:
    """Return the cells of the map in the zone."""
    cells = np.zeros(SHAPE, dtype=bool)
    cells[5:, 15:25] = True
    return cells


def zoned(*masks: OccupancyMap, settings: Settings = SETTINGS) -> MapStore:
    """Return a store with the room, in which some cells are unknown, and masks."""
    data = np.zeros(SHAPE, dtype=np.int8)
    data[18:, :5] = -1
    maps = store(data, settings)
    for number, one in enumerate(masks):
        maps.receive_mask(str(number), lambda one=one: one)
    return maps


@pytest.mark.parametrize('resolution', [0.1, 0.05, 0.25, 0.5])
def test_zone_is_the_same_from_masks_of_any_resolution(resolution: float) -> None:
    here = OccupancyMap(np.zeros(SHAPE, dtype=np.int8), RESOLUTION, (0.0, 0.0, 0.0), 'map')
    assert np.array_equal(zones_on(here, [mask(resolution)], 65), zone())


def test_zone_of_a_turned_mask_holds_each_cell_whose_centre_is_in_it() -> None:
    here = OccupancyMap(np.zeros((60, 60), dtype=np.int8), RESOLUTION, (-3.0, -3.0, 0.2), 'map')
    turned = mask(0.07, yaw=0.6)
    found = zones_on(here, [turned], 65)
    assert found is not None

    def places(grid: OccupancyMap) -> np.ndarray:
        rows, cols = np.indices(grid.data.shape).reshape(2, -1)
        z = (cols + 0.5 + 1j * (rows + 0.5)) * grid.resolution * np.exp(1j * grid.origin[2])
        return z + complex(*grid.origin[:2])

    def cells(grid: OccupancyMap, z: np.ndarray) -> np.ndarray:
        local = (z - complex(*grid.origin[:2])) * np.exp(-1j * grid.origin[2]) / grid.resolution
        return np.floor(np.stack([local.imag, local.real])).astype(int)

    expected = np.zeros(here.data.shape, dtype=bool)
    expected[tuple(cells(here, places(turned)))] = True
    row, col = cells(turned, places(here))
    inside = (row >= 0) & (col >= 0) & (row < turned.data.shape[0]) & (col < turned.data.shape[1])
    assert np.array_equal(found, expected | inside.reshape(found.shape))


def test_values_that_are_no_zone_say_nothing() -> None:
    data = np.array([[-1, 0, 64, 101, 65]], dtype=np.int8)
    one = OccupancyMap(data, 0.1, (0.0, 0.0, 0.0), 'map')
    here = replace(one, data=np.zeros((1, 5), dtype=np.int8))
    found = zones_on(here, [one], 65)
    assert found is not None and found.tolist() == [[False] * 4 + [True]]
    assert zones_on(here, [], 65) is None


@pytest.mark.parametrize('unknown', ['blocked', 'free'])
def test_path_goes_around_a_zone_that_is_not_inflated(unknown: str) -> None:
    settings = replace(SETTINGS, unknown=unknown, robot_radius=0.2)
    response = ask(zoned(mask(), settings=settings), (0.5, 1.5), (3.5, 1.5), settings=settings)
    assert response.outcome is Outcome.SOLVED
    assert path_collisions(response.path, zone(), RESOLUTION) == []
    assert response.path[:, 1].min() < BOTTOM
    unknown_goal = ask(
        zoned(mask(), settings=settings), (0.5, 1.5), (0.2, 1.95), settings=settings
    )
    assert unknown_goal.solved == (unknown == 'free')


def test_goal_in_a_zone_is_named_or_gives_way() -> None:
    response = ask(zoned(mask()), (0.5, 1.5), (2.0, 1.5))
    assert response.outcome is Outcome.INVALID_GOAL
    assert 'the goal is in a keepout zone' in response.why
    near = ask(zoned(mask()), (0.5, 1.5), (1.6, 1.5), tolerance=0.5)
    assert near.outcome is Outcome.SOLVED and 0.1 <= near.offset < 0.2


@pytest.mark.parametrize('escape_radius', [0.0, 0.05])
def test_start_in_a_zone_is_led_out_straight(escape_radius: float) -> None:
    settings, start = replace(SETTINGS, escape_radius=escape_radius), (1.7, 1.5)
    response = ask(zoned(mask(), settings=settings), start, (3.5, 1.5), settings=settings)
    assert response.outcome is Outcome.SOLVED
    assert response.path[0].tolist() == list(start)
    assert response.path[1] == pytest.approx([LEFT, 1.5], abs=1e-6)
    assert response.escape == pytest.approx(0.2, abs=1e-6)
    assert 'is in a keepout zone and was led out by 0.2 m' in response.why
    assert path_collisions(response.free_path, zone(), RESOLUTION) == []
    assert response.result is not None and response.result.length == pytest.approx(
        np.hypot(*np.diff(response.path, axis=0).T).sum()
    )


def test_way_out_of_a_zone_passes_no_wall() -> None:
    data = np.zeros(SHAPE, dtype=np.int8)
    data[:, 16] = 100
    data[:2, 16] = 0
    maps = store(data)
    maps.receive_mask('zone', mask)
    response = ask(maps, (1.9, 1.5), (3.5, 1.5))
    assert response.outcome is Outcome.SOLVED
    assert response.path[1] == pytest.approx([RIGHT, 1.5], abs=1e-6), 'not across the wall'
    assert path_collisions(response.path, data >= 65, RESOLUTION) == []


def test_start_that_is_blocked_without_zones_is_not_led_out() -> None:
    data = np.zeros(SHAPE, dtype=np.int8)
    data[15, 20] = 100
    maps = store(data)
    maps.receive_mask('zone', mask)
    assert ask(maps, (2.05, 1.55), (3.5, 1.5)).outcome is Outcome.INVALID_START


def test_zones_come_and_go_with_their_masks() -> None:
    maps = zoned(mask())
    number = maps.newest().number
    assert maps.receive_mask('0', mask) is None and maps.newest().number == number, 'the same'
    assert maps.receive_mask('0', None) is not None
    assert ask(maps, (0.5, 1.5), (2.0, 1.5)).outcome is Outcome.SOLVED
    empty = MapStore(SETTINGS)
    assert empty.receive_mask('early', mask) is None
    empty.receive(lambda: OccupancyMap(np.zeros(SHAPE, np.int8), RESOLUTION, (0, 0, 0), 'map'))
    assert ask(empty, (0.5, 1.5), (2.0, 1.5)).outcome is Outcome.INVALID_GOAL


def test_mask_in_another_frame_is_refused_and_the_last_one_stays() -> None:
    maps = zoned(mask())
    with pytest.raises(MapError, match="in frame 'odom', the map in 'map'"):
        maps.receive_mask('0', lambda: replace(mask(), frame='odom'))
    assert ask(maps, (0.5, 1.5), (2.0, 1.5)).outcome is Outcome.INVALID_GOAL
    assert not math.isnan(ask(maps, (0.5, 1.5), (3.5, 1.5)).clearance)
