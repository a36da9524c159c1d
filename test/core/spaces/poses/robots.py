"""Footprints and maps on which robots that are not round are tested."""

from collections.abc import Callable
from test.laws import maps
from test.pose_checker import PoseChecker

from hnr_planner.core import GridSpace, PoseSpace
import numpy as np

RECTANGLE = [(-0.35, -0.3), (0.55, -0.3), (0.55, 0.3), (-0.35, 0.3)]
L_SHAPE = [(-0.4, -0.3), (0.5, -0.3), (0.5, 0.0), (0.0, 0.0), (0.0, 0.3), (-0.4, 0.3)]
#: The centre of rotation lies outside.
TRIANGLE = [(0.2, -0.25), (0.8, 0.05), (0.15, 0.4)]
FOOTPRINTS = {'rectangle': RECTANGLE, 'L': L_SHAPE, 'triangle': TRIANGLE}


def _surveyed() -> GridSpace:
    """Return a turned map with occupied and unknown cells, inflated by a radius."""
    data = np.where(maps.rooms(70, 90, 35, seed=3), 100, 0).astype(np.int8)
    data[:6, :9] = data[40, 50] = -1
    return GridSpace.from_occupancy(data, 0.05, (1.0, 2.0, -2.5), robot_radius=0.1)


MAPS: dict[str, Callable[[], GridSpace]] = {
    'speckle': lambda: GridSpace.from_blocked(
        maps.speckle(60, 80, 0.01, seed=1), 0.05, (1.0, -2.0, 0.7)
    ),
    'lone cells and diagonals': lambda: GridSpace.from_blocked(
        maps.single_cells_and_diagonals(60), 0.2
    ),
    'hall': lambda: GridSpace.from_blocked(maps.wide_hall(50, 70), 0.1, (0.0, 0.0, np.pi)),
    'surveyed': _surveyed,
    'empty': lambda: GridSpace.from_blocked(np.zeros((40, 30), bool), 0.05, (-5.0, 3.0, 1.0)),
}


def checker(space: PoseSpace) -> PoseChecker:
    """Return the independent checker for a space of poses."""
    grid = space.grid
    return PoseChecker(grid.uninflated, grid.resolution, grid.origin, space.footprint)


def random_poses(space: PoseSpace, rng: np.random.Generator, n: int) -> np.ndarray:
    """Return poses (n, 3) whose positions are uniform in the map."""
    rows, columns = space.grid.shape
    places = space.grid.from_cells(rng.uniform((0, 0), (columns, rows), (n, 2)))
    return np.column_stack([places, rng.uniform(-np.pi, np.pi, n)])


def free_poses(space: PoseSpace, rng: np.random.Generator, n: int) -> np.ndarray:
    """Return free poses (n, 3)."""
    poses = random_poses(space, rng, 300 * n)
    poses = poses[space.contains(poses)][:n]
    assert len(poses) == n
    return poses


def random_twist(rng: np.random.Generator) -> np.ndarray:
    """Return a twist of one of five kinds: ahead, aside, in place, along an arc, any."""
    angle = rng.uniform(-np.pi, np.pi)
    kinds = (
        (1.0, 0.0, 0.0),
        (np.cos(angle), np.sin(angle), 0.0),
        (0.0, 0.0, 1.0),
        (1.0, 0.0, rng.uniform(-3.0, 3.0)),
        rng.standard_normal(3),
    )
    sign = rng.choice([-1.0, 1.0])
    return np.asarray(kinds[rng.integers(len(kinds))]) * sign * 10.0 ** rng.uniform(-2.0, 2.0)
