"""Clearance on a grid: the distance to occupied squares, of points and along paths."""

from test.laws import maps
from test.laws.grids import FRAMES, GRIDS, in_map_frame

from hnr_planner.core import GridSpace
import numpy as np
import pytest

LONE_CELL = np.zeros((9, 9), dtype=bool)
LONE_CELL[4, 4] = True


def brute_clearance(occupied, cells):
    """Return the distance from points to the nearest occupied square, all in cells."""
    squares = np.argwhere(occupied)[:, ::-1]
    low = squares - cells[:, None]
    apart = np.maximum(np.maximum(low, -low - 1), 0)
    return np.hypot(apart[..., 0], apart[..., 1]).min(axis=1, initial=np.inf)


@pytest.mark.parametrize('frame', FRAMES)
@pytest.mark.parametrize('grid', GRIDS)
def test_clearance_is_the_distance_to_the_raw_occupied_squares(grid, frame):
    """Inside and outside the map, and whatever the robot's radius blocks besides."""
    occupied = GRIDS[grid]
    resolution, origin = FRAMES[frame]
    space = GridSpace.from_blocked(occupied, resolution, origin, robot_radius=1.5 * resolution)
    rng = np.random.default_rng(10)
    cells = rng.uniform(-5, np.array(occupied.shape[::-1]) + 5, (200, 2))
    expected = brute_clearance(occupied, cells) * resolution
    found = space.clearance(in_map_frame(cells, resolution, origin))
    assert found == pytest.approx(expected, abs=1e-9 * resolution)
    assert (found == 0).sum() == (expected == 0).sum()


def test_clearance_far_from_every_wall():
    """A hall wider than any count in one byte."""
    occupied = np.zeros((20, 1500), dtype=bool)
    occupied[3, 2] = True
    space = GridSpace.from_blocked(occupied)
    points = np.array([[1499.5, 10.25], [700.5, 19.5], [2.5, 3.5], [300.0, 3.5]])
    expected = brute_clearance(occupied, points)
    assert space.clearance(points) == pytest.approx(expected)
    assert space.path_clearance(points[[0, 1]]) == pytest.approx(expected[1])
    assert space.path_clearance(points[[0, 3]]) == pytest.approx(297.0)


def test_unknown_cells_and_the_edge_of_the_map_are_no_walls_to_keep_clear_of():
    space = GridSpace.from_occupancy(np.full((4, 4), -1, np.int8), 1.0)
    assert space.clearance([[1.5, 1.5], [0.0, 9.0]]).tolist() == [np.inf, np.inf]
    assert space.path_clearance([[1.5, 1.5], [3.5, 1.5]]) == np.inf


@pytest.mark.parametrize('frame', ['cells', 'turned'])
@pytest.mark.parametrize('grid', GRIDS)
def test_clearance_of_a_path_is_the_least_along_it(grid, frame):
    """
    Against points every few thousandths of a cell: the least of them is above the truth.

    Clearance changes by no more than the distance moved: by less than half a spacing.
    """
    occupied = GRIDS[grid]
    resolution, origin = FRAMES[frame]
    space = GridSpace.from_blocked(occupied, resolution, origin)
    rng = np.random.default_rng(11)
    for _ in range(20):
        path = rng.uniform(-2, np.array(occupied.shape[::-1]) + 2, (int(rng.integers(1, 5)), 2))
        if rng.random() < 0.3:
            path = np.round(path)
        dense = np.concatenate([path[:1], *map(_dense, path[:-1], path[1:])])
        spacing = max((np.linalg.norm(np.diff(dense, axis=0), axis=1)), default=0.0)
        expected = brute_clearance(occupied, dense).min()
        found = space.path_clearance(in_map_frame(path, resolution, origin)) / resolution
        if np.isinf(expected):
            assert np.isinf(found)
            continue
        assert expected - spacing / 2 - 1e-9 <= found <= expected + 1e-9


def _dense(a, b):
    return np.linspace(a, b, 2000)


def test_clearance_of_a_segment_beside_one_square():
    """Every position of a segment relative to a square: past corners, along edges, across."""
    space = GridSpace.from_blocked(LONE_CELL)
    rng = np.random.default_rng(13)
    for _ in range(400):
        a, b = rng.uniform(0, 9, (2, 2))
        dense = _dense(a, b)
        expected = brute_clearance(LONE_CELL, dense).min()
        found = space.path_clearance([a, b])
        assert expected - np.linalg.norm(dense[1] - dense[0]) / 2 <= found <= expected + 1e-12


def test_clearance_of_a_path_of_one_point_is_the_clearance_of_the_point():
    space = GridSpace.from_blocked(maps.TWO_ROOMS)
    for point in ((1.5, 3.5), (5.5, 6.5), (-2.0, 0.5), (7.5, 2.5)):
        assert space.path_clearance([point]) == space.clearance([point])[0]
        assert space.path_clearance([point, point]) == space.clearance([point])[0]


def test_what_is_no_path_has_no_clearance():
    space = GridSpace.from_blocked(maps.TWO_ROOMS)
    for path in (np.empty((0, 2)), [[1.5, 1.5], [np.nan, 1.5]], [[np.inf, 1.5], [1.5, 1.5]]):
        with pytest.raises(ValueError):
            space.path_clearance(path)
    assert space.clearance(np.empty((0, 2))).shape == (0,)
