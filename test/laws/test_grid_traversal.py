"""
Skipping empty space changes nothing: every ray ends at the same number as by plain traversal.

The plain traversal below is written from the definition. The line x + s u meets the grid line X at
s = (X - x) / u; in the order of these numbers the ray goes from cell to cell, and it ends at the
first crossing at which it touches a blocked cell.
"""

import os
from pathlib import Path
from test.laws import maps
from test.sweeps import sweep, sweep_but

import cv2
from hnr_planner.core import GridSpace
from hnr_planner.core.spaces.primitives import first_exit
import numba
import numpy as np
import pytest

N_RAYS = 100_000
"""Rays of each of the three families below, on each of the maps."""

RIM = 1
"""Cells around the map in the frame of the kernels."""

KINDS = {
    'dense speckle': maps.speckle(200, 250, 0.2, seed=1),
    'sparse speckle': maps.speckle(250, 200, 0.002, seed=2),
    'rooms': maps.rooms(220, 220, 31, seed=3),
    'spiral': maps.spiral(240, 24),
    'wide hall': maps.wide_hall(600, 700),
    'single cells and diagonals': maps.single_cells_and_diagonals(200),
    'no obstacle': np.zeros((150, 300), dtype=bool),
}


def real_maps():
    """Return the files of the folder HNR_MAPS, if it is there."""
    folder = os.environ.get('HNR_MAPS')
    files = sorted(Path(folder).iterdir()) if folder else []
    return [file for file in files if file.suffix in ('.pgm', '.png', '.map')]


def read_real_map(file):
    """Return what is not plainly free as blocked."""
    if file.suffix == '.map':
        rows = file.read_text().split('map\n', 1)[1].split()
        return np.array([[mark not in '.G' for mark in row] for row in rows])
    image = cv2.imread(str(file), cv2.IMREAD_GRAYSCALE)
    assert image is not None
    return image < 230


@numba.njit
def plain(blocked, point, direction):
    """Return where the ray leaves the free cells, visiting one cell after the other."""
    (first_col, last_col, col_line), (first_row, last_row, row_line) = (
        _touched(point[0], direction[0]),
        _touched(point[1], direction[1]),
    )
    top, right = last_row + 1, last_col + 1
    if blocked[first_row:top, first_col:right].any():
        return 0.0
    # The cells ahead: of two that touch the start across the direction, only one is.
    if direction[0] != 0:
        first_col = last_col = col_line - (direction[0] > 0)
    if direction[1] != 0:
        first_row = last_row = row_line - (direction[1] > 0)
    while True:
        s_col = (col_line - point[0]) / direction[0] if direction[0] != 0 else np.inf
        s_row = (row_line - point[1]) / direction[1] if direction[1] != 0 else np.inf
        s = min(s_col, s_row)
        cols, rows = (first_col, last_col), (first_row, last_row)
        if s_col == s:
            first_col = last_col = first_col + _sign(direction[0])
            col_line += _sign(direction[0])
        if s_row == s:
            first_row = last_row = first_row + _sign(direction[1])
            row_line += _sign(direction[1])
        # At the crossing the ray touches the cells before it, those after it, and none besides.
        for row in range(min(rows[0], first_row), max(rows[1], last_row) + 1):
            for col in range(min(cols[0], first_col), max(cols[1], last_col) + 1):
                if blocked[row, col]:
                    return s


@numba.njit
def _touched(x, u):
    """Return the first and last index of the cells that touch x, and the next line along u."""
    first, last = int(np.ceil(x)) - 1, int(np.floor(x))
    return first, last, last + 1 if u > 0 else first


@numba.njit
def _sign(u):
    return 1 if u > 0 else -1


@numba.njit
def plain_ends(blocked, points, directions):
    ends = np.empty(len(points))
    for k in range(len(points)):
        ends[k] = plain(blocked, points[k], directions[k])
    return ends


@numba.njit
def fast_ends(data, points, directions, enough):
    ends = np.empty(len(points))
    for k in range(len(points)):
        ends[k] = first_exit(data, points[k], directions[k], 0.0, enough[k])
    return ends


def any_rays(shape, rng):
    """Return points and directions of no particular kind."""
    points = rng.uniform(0, shape[::-1], (N_RAYS, 2)) + RIM
    return points, rng.standard_normal((N_RAYS, 2))


def rays_with_ties(shape, rng):
    """Return rays from halves and quarters of a cell along small whole directions."""
    points = np.floor(rng.uniform(0, shape[::-1], (N_RAYS, 2)) * 4) / 4 + RIM
    directions = rng.integers(-4, 5, (N_RAYS, 2)).astype(float)
    directions[~directions.any(axis=1)] = 1
    return points, directions


def rays_close_to_corners(shape, rng):
    """Return rays from anywhere at lattice points, which rounding takes to one side or another."""
    points = rng.uniform(0, shape[::-1], (N_RAYS, 2)) + RIM
    points[::4] = np.round(points[::4]) + rng.choice(
        [-1e-13, 1e-16, 0, 1e-9], (len(points[::4]), 2)
    )
    reach = rng.choice([3, 20, 200])
    corners = np.round(points + rng.uniform(-reach, reach, points.shape))
    directions = corners - points
    directions[~directions.any(axis=1)] = 1
    lengths = np.where(rng.random(N_RAYS) < 0.5, 1.0, np.linalg.norm(directions, axis=1))
    return points, directions / lengths[:, None]


def assert_skipping_changes_nothing(occupied, family):
    rng = np.random.default_rng(12)
    space = GridSpace.from_blocked(occupied)
    blocked = np.pad(occupied, RIM, constant_values=True)
    points, directions = family(occupied.shape, rng)
    points = np.clip(points, RIM, np.array(occupied.shape[::-1]) + RIM)

    slow = plain_ends(blocked, points, directions)
    fast = fast_ends(space.data, points, directions, np.full(len(points), np.inf))
    different = np.flatnonzero(slow.view(np.int64) != fast.view(np.int64))
    first = different[:1]
    assert not len(different), (
        f'{len(different)} rays differ, first: point {points[first].tolist()}, direction '
        f'{directions[first].tolist()}, plain {slow[first].tolist()}, fast {fast[first].tolist()}'
    )
    # Where a search may stop early it says the same up to there, and "beyond" beyond.
    enough = slow * rng.choice([0.5, 0.999, 1.0, 1.001, 2.0], len(slow))
    early = fast_ends(space.data, points, directions, enough)
    beyond = slow > enough
    assert (early[beyond] > enough[beyond]).all()
    assert np.array_equal(early[~beyond], slow[~beyond])
    assert (slow > 0).any()


FAMILIES = pytest.mark.parametrize(
    'family', [any_rays, rays_with_ties, rays_close_to_corners], ids=lambda f: f.__name__
)


@FAMILIES
@pytest.mark.parametrize('kind', sweep_but(['dense speckle', 'rooms', 'wide hall'], KINDS))
def test_skipping_changes_no_bit(kind, family):
    assert_skipping_changes_nothing(KINDS[kind], family)


@FAMILIES
@pytest.mark.parametrize('file', [*map(sweep, real_maps())], ids=lambda file: file.name)
def test_skipping_changes_no_bit_on_real_maps(file, family):
    assert_skipping_changes_nothing(read_real_map(file), family)
