"""Every space that the laws are held on: a further space is one more entry in SPACES."""

from collections.abc import Callable
from test.laws import maps

from hnr_planner.core import GridSpace
import numpy as np

TURNED = (3.0, -2.0, 0.7)
SHIFTED = (-12.3, 4.56, 0.0)


def _surveyed() -> GridSpace:
    """Return a grid as a survey gives it: occupied, free and unknown, with a robot's radius."""
    data = np.where(maps.rooms(24, 30, 8, seed=3), 100, 0).astype(np.int8)
    data[:3, :5] = -1
    data[20, 20] = 64
    return GridSpace.from_occupancy(data, 0.05, (1.0, 2.0, -2.5), robot_radius=0.05)


SPACES: dict[str, Callable[[], object]] = {
    'grid in cells': lambda: GridSpace.from_blocked(maps.TWO_ROOMS),
    'grid in metres': lambda: GridSpace.from_blocked(maps.U_SHAPE, 0.05, SHIFTED),
    'grid turned': lambda: GridSpace.from_blocked(maps.TWO_ROOMS, 0.05, TURNED),
    'grid of speckle, turned round': lambda: GridSpace.from_blocked(
        maps.speckle(15, 20, 0.3, seed=1), 0.25, (-1.0, 7.5, np.pi)
    ),
    'grid of speckle, sparse': lambda: GridSpace.from_blocked(
        maps.speckle(60, 80, 0.02, seed=2), 0.1, (5.0, 5.0, -0.3)
    ),
    'grid without obstacles': lambda: GridSpace.from_blocked(np.zeros((5, 9), bool), 0.2, TURNED),
    'grid of one cell': lambda: GridSpace.from_blocked(maps.ONE_CELL, 3.0),
    'grid of one row': lambda: GridSpace.from_blocked(maps.CORRIDOR, 0.05, TURNED),
    'grid, checkerboard': lambda: GridSpace.from_blocked(maps.CHECKERBOARD, 0.5, SHIFTED),
    'grid, spiral': lambda: GridSpace.from_blocked(maps.SPIRAL, 1.0, TURNED),
    'grid, surveyed': _surveyed,
}
