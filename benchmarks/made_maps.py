"""Generate maps: a warehouse, a maze, a yard full of clutter, a slanted Z."""

from __future__ import annotations

from hnr_planner.maps import Corridor, FREE, OccupancyMap, OCCUPIED
import numpy as np
from numpy.typing import NDArray

#: Side of a cell [m].
RESOLUTION = 0.05


def warehouse() -> OccupancyMap:
    """Build a hall of 60 m x 40 m with rows of shelves, and pallets left in the aisles."""
    rng = np.random.default_rng(0)
    data = _walled(40.0, 60.0)
    for bottom in np.arange(4.0, 35.0, 3.2):
        for left in np.arange(4.0, 50.0, 13.0):
            _fill(data, bottom, left, 1.0, 11.0)
    for _ in range(60):
        _fill(data, rng.uniform(1.0, 38.0), rng.uniform(1.0, 58.0), 0.8, 1.2)
    return OccupancyMap(data, RESOLUTION)


def maze(side: int = 25) -> OccupancyMap:
    """Build side x side chambers of 1 m, walls of .15 m, a tree of doors and some doors more."""
    rng = np.random.default_rng(0)
    data = _walled(side + 0.15, side + 0.15)
    for at in np.arange(1.0, side):
        _fill(data, at, 0.0, 0.15, side)
        _fill(data, 0.0, at, side, 0.15)
    for row, column, down in _doors(rng, side):
        if down:
            _fill(data, row + 1.0, column + 0.15, 0.15, 0.85, FREE)
        else:
            _fill(data, row + 0.15, column + 1.0, 0.85, 0.15, FREE)
    return OccupancyMap(data, RESOLUTION)


def clutter() -> OccupancyMap:
    """Build a yard of 30 m x 30 m with 400 boxes of all sizes."""
    rng = np.random.default_rng(0)
    data = _walled(30.0, 30.0)
    for bottom, left in rng.uniform(0.5, 29.0, (400, 2)):
        _fill(data, bottom, left, *rng.uniform(0.1, 1.2, 2))
    return OccupancyMap(data, RESOLUTION)


def slanted_z(width: float) -> Corridor:
    """Build a Z that fills a square of 10 m; the edge of its bar is a staircase of cells."""
    side, w = round(10.0 / RESOLUTION), round(width / RESOLUTION)
    blocked = np.ones((side, side), dtype=bool)
    blocked[:w] = blocked[-w:] = False
    for row in range(w, side - w):
        left = round((side - w) * (side - w - row) / (side - 2 * w))
        blocked[row, left:][:w] = False
    near, far = width / 2, 10.0 - width / 2
    return Corridor(blocked, RESOLUTION, (near, near), (far, far), width / 2)


def _doors(rng: np.random.Generator, side: int) -> list[tuple[int, int, bool]]:
    """Return doors (row, column, whether up or right): a random spanning tree, and some more."""
    opened = []
    seen, trail = {(0, 0)}, [(0, 0)]
    while trail:
        row, column = trail[-1]
        around = [(row + 1, column), (row - 1, column), (row, column + 1), (row, column - 1)]
        new = [at for at in around if min(at) >= 0 and max(at) < side and at not in seen]
        if not new:
            trail.pop()
            continue
        near = new[rng.integers(len(new))]
        seen.add(near)
        trail.append(near)
        opened.append((min(row, near[0]), min(column, near[1]), near[0] != row))
    more = rng.integers(side - 1, size=(side * side // 12, 2))
    return opened + [(int(row), int(column), bool(rng.integers(2))) for row, column in more]


def _walled(height: float, width: float) -> NDArray[np.int8]:
    data = np.full((round(height / RESOLUTION), round(width / RESOLUTION)), FREE, dtype=np.int8)
    data[:3], data[-3:], data[:, :3], data[:, -3:] = (OCCUPIED,) * 4
    return data


def _fill(
    data: NDArray[np.int8],
    bottom: float,
    left: float,
    height: float,
    width: float,
    value: int = OCCUPIED,
) -> None:
    """Fill a rectangle [m]."""
    first_row, first_column = round(bottom / RESOLUTION), round(left / RESOLUTION)
    end_row = first_row + round(height / RESOLUTION)
    end_column = first_column + round(width / RESOLUTION)
    data[first_row:end_row, first_column:end_column] = value
