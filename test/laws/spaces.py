"""Every space that the laws are held on: a further space is one more entry in SPACES."""

from collections.abc import Callable
from test.laws import maps

from hnr_planner.core import (
    BallSpace,
    BoxSpace,
    DifferenceSpace,
    GridSpace,
    MappedSpace,
    OracleSpace,
    PolygonSpace,
    PolytopeSpace,
    ProductSpace,
    ShearedSpace,
    UnionSpace,
)
from numba import njit
import numpy as np
from numpy.typing import NDArray
import shapely

TURNED = (3.0, -2.0, 0.7)
SHIFTED = (-12.3, 4.56, 0.0)


def _surveyed() -> GridSpace:
    """Return a grid as a survey gives it: occupied, free and unknown, with a robot's radius."""
    data = np.where(maps.rooms(24, 30, 8, seed=3), 100, 0).astype(np.int8)
    data[:3, :5] = -1
    data[20, 20] = 64
    return GridSpace.from_occupancy(data, 0.05, (1.0, 2.0, -2.5), robot_radius=0.05)


def _truncated_simplex() -> PolytopeSpace:
    """Return x > 0, x + y + z < 1, cut off at x < .7."""
    normals = np.vstack([-np.eye(3), np.ones((1, 3)), [[2.0, 0.0, 0.0]]])
    return PolytopeSpace(normals, [0.0, 0.0, 0.0, 1.0, 1.4])


def _gear() -> PolygonSpace:
    """Return a wheel with 40 teeth and a round hole."""
    angles = np.linspace(0.0, 2.0 * np.pi, 160, endpoint=False)
    radii = np.where(np.arange(160) // 2 % 2 == 0, 3.0, 2.6)
    rim = np.stack([5.0 + radii * np.cos(angles), radii * np.sin(angles)], axis=1)
    return PolygonSpace(shapely.Polygon(rim).difference(shapely.Point(5.0, 0.3).buffer(1.0)))


def _rooms() -> PolygonSpace:
    """Return two polygons that touch in a point, one with holes of which two touch the ring."""
    hall = shapely.box(0.0, 0.0, 4.0, 3.0).difference(
        shapely.union_all(
            [
                shapely.box(1.0, 1.0, 1.5, 2.0),
                shapely.Polygon([(2.0, 0.0), (2.5, 1.0), (1.8, 1.2)]),
                shapely.Polygon([(3.0, 3.0), (2.5, 2.0), (3.5, 1.5)]),
            ]
        )
    )
    return PolygonSpace(shapely.MultiPolygon([hall, shapely.box(4.0, 3.0, 5.0, 5.0)]))


def _hall_with_tables() -> DifferenceSpace:
    """Return a turned map without two polygons, one of them across its edge."""
    tables = [shapely.box(3.05, -1.9, 3.1, -1.8), shapely.Point(3.1, -2.0).buffer(0.1)]
    hall = GridSpace.from_blocked(maps.TWO_ROOMS, 0.05, TURNED)
    return DifferenceSpace(hall, PolygonSpace(shapely.MultiPolygon(tables)))


@njit
def _is_in_ring(x):
    return 0.3 < np.hypot(x[0], x[1]) < 1.0


@njit
def _bend(x):
    return np.array([x[0], x[1] + 0.3 * x[0] ** 2])


@njit
def _unbend(x):
    return np.array([x[0], x[1] - 0.3 * x[0] ** 2])


def _way_in_saucer(x: NDArray, u: NDArray) -> float:
    """Return how far a ray is free in a solid of revolution, |z| < 1 - x^2 - y^2."""
    ends = []
    for side in (1.0, -1.0):
        # Roots of side (z + s u_z) + |xy + s u_xy|^2 - 1.
        c = side * x[2] + x[0] ** 2 + x[1] ** 2 - 1.0
        if c >= 0.0:
            return 0.0
        b = side * u[2] + 2.0 * (x[0] * u[0] + x[1] * u[1])
        a = u[0] ** 2 + u[1] ** 2
        root = np.sqrt(b * b - 4.0 * a * c)
        if a > 0.0 or b > 0.0:
            ends.append(2.0 * -c / (b + root))
    return float(min(ends))


def _box_without_balls() -> DifferenceSpace:
    centres = np.random.default_rng(5).uniform(0.0, 1.0, (10, 4))
    return DifferenceSpace(
        BoxSpace(np.zeros(4), np.ones(4)), *(BallSpace(centre, 0.3) for centre in centres)
    )


def _grid_with_a_room_beside() -> UnionSpace:
    """Return a turned map and a box over its lower left corner."""
    return UnionSpace(
        GridSpace.from_blocked(maps.U_SHAPE, 0.05, TURNED),
        BoxSpace((2.9, -2.1), (3.05, -1.85)),
    )


def _nested() -> DifferenceSpace:
    """Return a box without a shell, whose core and whose map are there again."""
    shell = DifferenceSpace(BallSpace((2.0, 2.0), 1.9), BallSpace((2.0, 2.0), 1.2))
    hall = GridSpace.from_blocked(maps.TWO_ROOMS, 0.2, (3.0, 2.0, 0.4))
    return DifferenceSpace(BoxSpace((0.0, 0.0), (5.0, 4.0)), DifferenceSpace(shell, hall))


#: A corner in the coordinates of a map projection [m], which are rounded to 1e-9 there.
FAR = np.array([691_000.3, 5_334_000.7])


def _far_rooms() -> UnionSpace:
    """Return half a metre of rooms of three kinds far from the origin."""
    return UnionSpace(
        BoxSpace(FAR, FAR + (0.3, 0.5)),
        BallSpace(FAR + (0.35, 0.2), 0.15),
        PolygonSpace(shapely.box(*(FAR + (0.2, 0.3)), *(FAR + (0.6, 0.4)))),
    )


#: Spaces whose laws take less time interpreted than their kernels take to compile.
QUICK: dict[str, Callable[[], object]] = {
    'box': lambda: BoxSpace((-1.0, 2.0, 0.0), (1.0, 2.5, 8.0)),
    'interval': lambda: BoxSpace([3.0], [4.0]),
    'ball': lambda: BallSpace((5.0, -3.0, 0.5), 0.25),
    'polytope': _truncated_simplex,
    'polygon': _gear,
    'polygons': _rooms,
    'sheared ball': lambda: ShearedSpace(BallSpace((1.0, -2.0, 0.5), 0.75), -1.5),
    'sheared box': lambda: ShearedSpace(BoxSpace((0.0, 0.0), (3.0, 0.5)), 0.8),
    'union of a kind': lambda: UnionSpace(
        BoxSpace((0.0, 0.0), (0.3, 1.0)),
        BoxSpace((0.1 + 0.2, 0.0), (1.0, 0.2)),
        BoxSpace((0.9, 0.1), (1.1, 2.0)),
    ),
    'union of kinds': lambda: UnionSpace(
        BoxSpace((-1.0, -1.0, -1.0), (0.0, 1.0, 1.0)),
        BallSpace((0.5, 0.0, 0.0), 0.7),
        UnionSpace(BallSpace((1.5, 0.0, 0.0), 0.7), _truncated_simplex()),
    ),
    'difference': lambda: DifferenceSpace(
        BoxSpace((0.0, 0.0), (3.0, 2.0)), BallSpace((1, 1), 0.9)
    ),
    'difference with many balls': _box_without_balls,
    'grid and box': _grid_with_a_room_beside,
    'difference in a difference': _nested,
    'grid without polygons': _hall_with_tables,
    'polytope far away': lambda: PolytopeSpace(
        [[-1.0, 0.0], [0.0, -1.0], [1.0, 2.0]], [-FAR[0], -FAR[1], FAR @ (1, 2) + 0.5]
    ),
    'rooms far away': _far_rooms,
    'product': lambda: ProductSpace(
        GridSpace.from_blocked(maps.TWO_ROOMS, 0.1), BallSpace([0.0], 2)
    ),
}
#: Spaces that look at hundreds of points for a chord, and grids, whose kernels all requests need.
LONG: dict[str, Callable[[], object]] = {
    'oracle': lambda: OracleSpace(_is_in_ring, (-1.1, -1.2), (1.2, 1.1), resolution=2e-3),
    'oracle of chords': lambda: OracleSpace.from_chord(
        _way_in_saucer, (-1.0, -1.0, -1.0), (1.0, 1.0, 1.0), resolution=5e-3
    ),
    'mapped': lambda: MappedSpace(
        _bend, _unbend, BoxSpace((-1.0, -0.5), (1.0, 0.5)), resolution=2e-3
    ),
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
SPACES = QUICK | LONG
#: Spaces in which the laws are sweeps: others hold their kinds and what is difficult about them.
FURTHER = (
    'ball',
    'difference',
    'grid and box',
    'grid in metres',
    'grid without obstacles',
    'mapped',
    'polygon',
    'sheared box',
    'union of a kind',
)
