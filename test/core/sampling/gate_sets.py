"""Sets for the tests of walks, each as a brute-force region and as a space of the package."""

from collections.abc import Collection
from functools import cache
from test.laws import maps
from test.regions import (
    BentRegion,
    CellRegion,
    Points,
    PolygonRegion,
    PolytopeRegion,
    Region,
    UnionRegion,
)
from test.sweeps import sweep
from typing import NamedTuple

from hnr_planner.core import (
    BallSpace,
    BoxSpace,
    DifferenceSpace,
    GridSpace,
    PolygonSpace,
    PolytopeSpace,
    ShearedSpace,
    Space,
    UnionSpace,
)
import numpy as np
import pytest
from shapely import Polygon


class GateSet(NamedTuple):
    """A set, and points from which single steps are tested."""

    region: Region
    space: Space
    points: Points


@cache
def u_shape() -> GateSet:
    """Return two arms; a point in one of them, and one between both."""
    points = np.array([[0.7, 8.3], [3.2, 1.1]])
    return GateSet(CellRegion(maps.U_SHAPE), GridSpace.from_blocked(maps.U_SHAPE), points)


@cache
def two_rooms() -> GateSet:
    """Return rooms with a door, furnished; a point beside the door, and one in a room."""
    points = np.array([[4.6, 3.3], [8.9, 5.2]])
    return GateSet(CellRegion(maps.TWO_ROOMS), GridSpace.from_blocked(maps.TWO_ROOMS), points)


@cache
def hall_and_dome() -> GateSet:
    """Return a room, a corridor and a disc in line; a point that sees through the corridor."""
    corners = np.array([[[0.0, 0.0], [1.0, 1.0]], [[0.9, 0.4], [2.2, 0.6]]])
    centre, radius = np.array([2.5, 0.5]), 0.5
    region = UnionRegion(
        np.zeros(2), np.array([3.0, 1.0]), (9, 3), corners, centre[None], np.array([radius])
    )
    space = UnionSpace(*(BoxSpace(*corner) for corner in corners), BallSpace(centre, radius))
    return GateSet(region, space, np.array([[0.95, 0.55]]))


@cache
def court_with_pillars() -> GateSet:
    """Return a polygon with a notch and two holes; a point between the notch and a hole."""
    outline = np.array([[0, 0], [4, 0], [4, 3], [2.2, 3], [2, 1.2], [1.8, 3], [0, 3.0]])
    pillar = np.array([[0.5, 0.4], [1.4, 0.5], [0.8, 1.3]])
    wall = np.array([[2.6, 0.8], [3.6, 0.9], [3.6, 1.0], [2.6, 0.9]])
    rings = (outline, pillar, wall)
    region = PolygonRegion(np.zeros(2), np.array([4.0, 3.0]), (8, 6), rings)
    space = PolygonSpace(Polygon(outline, [pillar, wall]))
    return GateSet(region, space, np.array([[1.6, 1.1]]))


@cache
def banana() -> GateSet:
    """Return a bent box in space; a point at its inner side."""
    low, high, bend = np.array([-1.0, -0.3, -0.2]), np.array([1.0, 0.3, 0.2]), 0.8
    region = BentRegion(low, high + [0.0, 0.0, bend], (6, 2, 6), low, high, bend)
    return GateSet(region, ShearedSpace(BoxSpace(low, high), bend), np.array([[0.1, 0.1, 0.15]]))


@cache
def stone_without_its_core() -> GateSet:
    """Return a cube with a corner cut off, less a ball in it; a point beside the ball."""
    normals = np.vstack([np.eye(3), -np.eye(3), np.ones((1, 3))])
    offsets = np.array([1, 1, 1, 0, 0, 0, 2.4])
    centre, radius = np.array([0.5, 0.45, 0.4]), 0.38
    region = PolytopeRegion(
        np.zeros(3), np.ones(3), (3, 3, 3), normals, offsets, centre[None], np.array([radius])
    )
    space = DifferenceSpace(PolytopeSpace(normals, offsets), BallSpace(centre, radius))
    return GateSet(region, space, np.array([[0.9, 0.5, 0.42]]))


@cache
def box_without_balls() -> GateSet:
    """
    Return a 10-D cube less ten balls, a quarter of it; of 1000 points the nearest to a ball.

    Every fifth chord ends at a ball.
    """
    dim, radii = 10, np.full(10, 0.8)
    rng = np.random.default_rng(1)
    centres = rng.random((10, dim))
    normals, offsets = np.vstack([np.eye(dim), -np.eye(dim)]), np.repeat([1.0, 0.0], dim)
    bins = (2,) * 5 + (1,) * 5
    region = PolytopeRegion(np.zeros(dim), np.ones(dim), bins, normals, offsets, centres, radii)
    space = DifferenceSpace(
        BoxSpace(np.zeros(dim), np.ones(dim)),
        *(BallSpace(centre, radius) for centre, radius in zip(centres, radii, strict=True)),
    )
    points = region.uniform(1000, rng)
    nearest = np.linalg.norm(points[:, None] - centres, axis=2).min(axis=1).argmin()
    return GateSet(region, space, points[[nearest]])


SETS = {
    'u shape': u_shape,
    'two rooms': two_rooms,
    'hall and dome': hall_and_dome,
    'court with pillars': court_with_pillars,
    'banana, 3-D': banana,
    'stone, 3-D': stone_without_its_core,
    'box without balls, 10-D': box_without_balls,
}
#: Sets whose walks would be compiled for them alone: what is tested in them belongs to the sweeps.
FURTHER = ('hall and dome', 'court with pillars', 'banana, 3-D', 'stone, 3-D')


def marked(name: str, *values: object, further: Collection[str] = FURTHER) -> object:
    """Return a parameter that belongs to the sweeps if its set is one of ``further``."""
    return sweep(name, *values) if name in further else pytest.param(name, *values)
