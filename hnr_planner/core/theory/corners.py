"""
Corners of the boundary of sets in the plane.

Corners are the kinks of chord lengths as functions of the angle, the ends of a view's walls, and
the turning points of shortest paths.
"""

import itertools
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.spaces import BoxSpace, GridSpace, PolygonSpace, PolytopeSpace, Space
import numpy as np
from shapely import get_parts
from shapely.geometry.polygon import orient

#: Distance between a corner and the point where a path turns, as a fraction of the diagonal of the
#: bounds.
BESIDE = 1e-7


class Corners(NamedTuple):
    """
    Corners of the boundary of a set in the plane.

    Attributes
    ----------
    points : (k, 2)
        All corners; none where the boundary is smooth or its corners are unknown.
    turns : (m, 2)
        Free points just beside the reflex corners, at which shortest paths turn.

    """

    points: Floats
    turns: Floats


def corners(space: Space) -> Corners:
    """
    Return the corners of a grid or polygon, or of a box or polytope in the plane.

    For all other spaces, and for boxes and polytopes in more dimensions, both arrays are empty.
    """
    none = np.empty((0, 2))
    if isinstance(space, GridSpace):
        return _grid_corners(space)
    if isinstance(space, PolygonSpace):
        return _polygon_corners(space)
    if isinstance(space, BoxSpace) and space.dim == 2:
        return Corners(np.array(list(itertools.product(*zip(*space.bounds, strict=True)))), none)
    if isinstance(space, PolytopeSpace) and space.dim == 2:
        corners = _polytope_corners(space.data.normals, space.data.offsets)
        return Corners(space.from_kernel(corners), none)
    return Corners(none, none)


def _grid_corners(space: GridSpace) -> Corners:
    """Return the lattice points where the boundary turns, and points beside reflex corners."""
    blocked = np.pad(space.blocked, 1, constant_values=True)
    around = np.stack([blocked[:-1, :-1], blocked[:-1, 1:], blocked[1:, :-1], blocked[1:, 1:]])
    count = around.sum(axis=0)
    diagonal = (count == 2) & (around[0] == around[3])
    row, column = np.nonzero((count == 1) | (count == 3) | diagonal)
    at = np.stack([column, row], axis=1).astype(np.float64) + space.frame.RIM
    offsets = np.array([(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)])
    reflex = count[row, column] == 1
    away = -offsets[np.argmax(around[:, row[reflex], column[reflex]], axis=0)]
    lower, upper = space.kernel_bounds
    beside = at[reflex] + away * (BESIDE * float(np.linalg.norm(upper - lower)))
    return Corners(space.from_kernel(at), space.from_kernel(beside))


def _polygon_corners(space: PolygonSpace) -> Corners:
    """Return the vertices of the rings, and free points beside the reflex vertices."""
    lower, upper = space.bounds
    beside = BESIDE * float(np.linalg.norm(upper - lower))
    points, turns = [], []
    for polygon in get_parts(space.polygon):
        inside_on_the_left = orient(polygon)
        for ring in (inside_on_the_left.exterior, *inside_on_the_left.interiors):
            at = np.asarray(ring.coords)[:-1, :2]
            ahead = np.roll(at, -1, axis=0) - at
            ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
            behind = np.roll(ahead, 1, axis=0)
            right = behind[:, 0] * ahead[:, 1] - behind[:, 1] * ahead[:, 0] < 0.0
            away = (behind - ahead)[right]
            away /= np.linalg.norm(away, axis=1, keepdims=True)
            points.append(at)
            turns.append(at[right] + beside * away)
    return Corners(np.concatenate(points), np.concatenate(turns))


def _polytope_corners(normals: Floats, offsets: Floats) -> Floats:
    """Return the vertices (k, 2) of the polygon ``normals @ x <= offsets``, normals (m, 2)."""
    found = []
    for i, j in itertools.combinations(range(len(offsets)), 2):
        if abs(np.linalg.det(normals[[i, j]])) > 1e-12:
            point = np.linalg.solve(normals[[i, j]], offsets[[i, j]])
            if (normals @ point <= offsets + 1e-9 * (1.0 + np.abs(offsets))).all():
                found.append(point)
    return np.array(found).reshape(-1, 2)
