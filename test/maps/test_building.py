"""The generated office floor: every room can be entered, and the sample map is what it draws."""

from pathlib import Path
from test.sweeps import sweep

import cv2
from hnr_planner.maps import building, load_map, OccupancyMap
from hnr_planner.maps.__main__ import main, OFFICE_SEED
from hnr_planner.maps.floor_plan import draw_floor_plan, HEIGHT, WIDTH
import numpy as np
from numpy.typing import NDArray
import pytest

OFFICE = Path(__file__).parents[2] / 'config' / 'maps' / 'office.yaml'
ROBOT = 0.22


@pytest.fixture(scope='module', params=[OFFICE_SEED, sweep(0), sweep(1)])
def seed(request: pytest.FixtureRequest) -> int:
    return request.param


@pytest.fixture(scope='module')
def made(seed: int) -> OccupancyMap:
    return building(seed)


def largest_piece(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the largest 4-connected piece of a mask."""
    _, labels = cv2.connectedComponents(mask.astype(np.uint8), connectivity=4)
    return labels == np.bincount(labels[mask]).argmax()


def reachable(occupancy: OccupancyMap) -> NDArray[np.bool_]:
    """Return the largest piece of the cells where the robot's centre may be."""
    radius = ROBOT / occupancy.resolution
    offsets = np.arange(-int(radius), int(radius) + 1)
    disc = offsets[:, None] ** 2 + offsets**2 <= radius**2 + 1e-9
    occupied = (occupancy.data == 100).astype(np.uint8)
    inflated = cv2.dilate(occupied, disc.astype(np.uint8)) > 0
    return largest_piece((occupancy.data == 0) & ~inflated)


def test_robot_gets_into_every_room(made: OccupancyMap, seed: int) -> None:
    plan = draw_floor_plan(np.random.default_rng(seed))
    there = reachable(made)
    offset = np.array(made.origin[:2])
    for room in plan.rooms:
        corners = np.reshape(room.rect, (2, 2))
        (left, bottom), (right, top) = ((corners - offset) / made.resolution).astype(int)
        assert there[bottom:top, left:right].mean() > 0.3, room
    assert {room.kind for room in plan.rooms} >= {'corridor', 'hall', 'meeting', 'office'}
    assert len(plan.rooms) >= 24


def test_nothing_leads_out_of_the_building(made: OccupancyMap) -> None:
    rows, columns = np.nonzero(largest_piece(made.data == 0))
    x = made.origin[0] + (columns + 0.5) * made.resolution
    y = made.origin[1] + (rows + 0.5) * made.resolution
    assert 0 < x.min() < x.max() < WIDTH
    assert 0 < y.min() < y.max() < HEIGHT


def test_survey_leaves_all_three_kinds_of_cells(made: OccupancyMap) -> None:
    shares = [(made.data == value).mean() for value in (-1, 0, 100)]
    assert sum(shares) == pytest.approx(1.0)
    assert shares[0] > 0.15
    assert shares[1] > 0.5
    assert 0.02 < shares[2] < 0.1


def test_margin_around_the_building_is_unknown_but_for_streaks(made: OccupancyMap) -> None:
    outside = np.ones(made.data.shape, bool)
    strip = round(1.4 / made.resolution)
    outside[strip:-strip, strip:-strip] = False
    assert (made.data[outside] == -1).mean() > 0.9
    assert not (made.data[outside] == 100).any()


def test_seed_decides_the_map() -> None:
    first, again, other = (building(seed, resolution=0.25).data for seed in (2, 2, 3))
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)


def test_resolution_and_margin() -> None:
    coarse = building(1, resolution=0.25, margin=1.0)
    assert coarse.data.shape == (108, 168)
    assert (coarse.resolution, coarse.origin) == (0.25, (-1.0, -1.0, 0.0))


def test_sample_map_is_what_the_generator_writes(tmp_path: Path) -> None:
    main(tmp_path)
    fresh, kept = load_map(tmp_path / 'office.yaml'), load_map(OFFICE)
    assert np.array_equal(fresh.data, kept.data)
    assert (fresh.resolution, fresh.origin) == (kept.resolution, kept.origin)
