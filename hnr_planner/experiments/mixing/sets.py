"""
Sets in which mixing is measured: a start, and cells whose fractions of the volume are known.

The cells must be small along the direction in which chains mix most slowly. In the plane they are
the squares of a lattice; in solids (module ``solids``) they are slices along the way from the
start.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache

from hnr_planner.core import GridSpace, PolygonSpace, Space
from hnr_planner.maps import spiral
import numpy as np
from numpy.typing import NDArray
import shapely

Floats = NDArray[np.float64]
Starts = Callable[[int, np.random.Generator], Floats]
Cells = Callable[[Floats], NDArray[np.int64]]

#: Number of chains for each cell that is not empty. The estimate of the total variation from above
#: is then about 0.04 (the floor) even for chains that are mixed, in every set.
CHAINS_PER_CELL = 100
#: Widths of the door between two rooms of 1 m x 1 m, and half the thickness of their wall [m].
DOORS = (0.05, 0.1, 0.2, 0.4)
WALL = 1e-6
#: Distance of the star's inner corners from its centre [m]; the tips are 1 m from the centre.
NOTCH = 0.35
#: Width of the spirals' corridor, thickness of their walls, and side of a grid's cell [m].
WIDTH, THICKNESS, RESOLUTION = 1.2, 0.1, 0.05
#: Sizes of the spirals: how many corridors lie side by side across the square.
TURNS = (4, 6, 8)


@dataclass(frozen=True)
class MixingSet:
    """
    A set in which mixing is measured, with starts of chains and a partition into cells.

    Attributes
    ----------
    space : Space
        The set.
    starts : callable
        ``starts(n_chains, rng)`` returns one point (dim,) for all chains, or one point for each
        chain (n_chains, dim).
    cells : callable
        ``cells(points)`` returns the index (k,) into ``shares`` of the cell of each point
        (k, dim).
    shares : (n_cells,)
        Fraction of the set's volume in each cell.
    lattice : (rows, columns)
        Number of equal rectangles that the bounds of a set in the plane are divided into; (0, 0)
        for solids.

    """

    space: Space
    starts: Starts
    cells: Cells
    shares: Floats
    lattice: tuple[int, int] = (0, 0)

    @property
    def n_chains(self) -> int:
        """Number of chains of one run: ``CHAINS_PER_CELL`` for each cell that is not empty."""
        return CHAINS_PER_CELL * int(np.count_nonzero(self.shares))


def at(point: Sequence[float] | Floats) -> Starts:
    """Return a function for ``MixingSet.starts`` that starts all chains at one point (dim,)."""
    return lambda n_chains, rng: np.array(point, dtype=float)


@cache
def planar_sets() -> dict[str, MixingSet]:
    """Build all sets in the plane, by their names."""
    square, corner = shapely.box(0.0, 0.0, 2.0, 2.0), shapely.box(1.0, 1.0, 3.0, 3.0)
    ell = _of_polygon(square - corner, (1.99, 0.01), (4, 4))
    star = _of_polygon(_star(), (0.96, 0.0), (6, 6))
    rooms = {f'door {door}': _of_polygon(_rooms(door), (0.01, 0.01), (3, 6)) for door in DOORS}
    return {'L': ell, 'star': star, **rooms, **{f'spiral {k}': _spiral(k) for k in TURNS}}


def _rooms(door: float) -> shapely.Polygon:
    """Build two unit squares with a door of this width [m] in the wall between them."""
    rooms = shapely.box(0.0, 0.0, 2.0, 1.0)
    for bottom, top in ((-1.0, 0.5 - door / 2.0), (0.5 + door / 2.0, 2.0)):
        rooms -= shapely.box(1.0 - WALL, bottom, 1.0 + WALL, top)
    return rooms


def _star() -> shapely.Polygon:
    """Build a star with five points, all visible from its centre."""
    angles = np.arange(10) * np.pi / 5.0
    radii = np.where(np.arange(10) % 2 == 0, 1.0, NOTCH)
    return shapely.Polygon(np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1))


def _of_polygon(
    polygon: shapely.Polygon, start: Sequence[float], lattice: tuple[int, int]
) -> MixingSet:
    """Build the set of a polygon with the cells of a lattice over its bounds; areas are exact."""
    space = PolygonSpace(polygon)
    (left, bottom), (right, top) = space.bounds
    x, y = np.linspace(left, right, lattice[1] + 1), np.linspace(bottom, top, lattice[0] + 1)
    squares = shapely.box(x[:-1], y[:-1, np.newaxis], x[1:], y[1:, np.newaxis])
    areas = shapely.area(shapely.intersection(squares, polygon)).ravel()
    return MixingSet(space, at(start), _squares(space, lattice), areas / areas.sum(), lattice)


def _spiral(turns: int) -> MixingSet:
    """Build a spiral ``turns`` corridors wide, such that the lattice's lines lie in its walls."""
    size = turns * (WIDTH + THICKNESS) + THICKNESS
    made = spiral(WIDTH, resolution=RESOLUTION, wall=THICKNESS, size=size)
    free = ~made.blocked[1:-1, 1:-1]  # without the outer half of the outer walls
    space = GridSpace.from_blocked(~free, RESOLUTION)
    side = len(free) // turns
    counts = free.reshape(turns, side, turns, side).sum(axis=(1, 3)).ravel()
    start, lattice = np.array(made.start) - RESOLUTION, (turns, turns)
    return MixingSet(space, at(start), _squares(space, lattice), counts / counts.sum(), lattice)


def _squares(space: Space, lattice: tuple[int, int]) -> Cells:
    """Return the function that maps points (k, 2) [m] to row-major indices (k,) of squares."""
    rows, columns = lattice
    lower, upper = space.bounds

    def cells(points: Floats) -> NDArray[np.int64]:
        along = np.floor((points - lower) / (upper - lower) * (columns, rows)).astype(int)
        column, row = np.clip(along, 0, (columns - 1, rows - 1)).T
        numbers: NDArray[np.int64] = row * columns + column
        return numbers

    return cells
