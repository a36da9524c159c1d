"""
Polygons in exact fractions: slow, and obviously right.

It shares no code with the library: every float is taken as the rational number that it is, so that
lines along an edge or through a corner are told from those that miss it by any distance.
"""

from fractions import Fraction
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray
import shapely

Point = tuple[Fraction, Fraction]


def chord(polygon: shapely.Geometry, point: ArrayLike, direction: ArrayLike) -> NDArray:
    """Return the ends (2,) of the chord of the open polygon, exactly; zeros where not free."""
    x, u = _exact(point), _exact(direction)
    edges = _edges(polygon)
    if not _is_inside(edges, x):
        return np.array([Fraction(0), Fraction(0)])
    met = [s for a, b in edges for s in _meetings(a, b, x, u)]
    return np.array([max(s for s in met if s < 0), min(s for s in met if s > 0)])


def contains(polygon: shapely.Geometry, point: ArrayLike) -> bool:
    """Say whether the open polygon holds a point."""
    return _is_inside(_edges(polygon), _exact(point))


def _edges(polygon: shapely.Geometry) -> list[tuple[Point, Point]]:
    """Return the edges of all rings."""
    edges = []
    for ring in shapely.get_rings(shapely.get_parts(polygon)):
        corners = [_exact(corner) for corner in shapely.get_coordinates(ring)]
        edges += pairwise(corners)
    return edges


def _exact(point: ArrayLike) -> Point:
    x, y = np.asarray(point, dtype=float).tolist()
    return Fraction(x), Fraction(y)


def _cross(u: Point, v: Point) -> Fraction:
    return u[0] * v[1] - u[1] * v[0]


def _from(x: Point, a: Point) -> Point:
    return a[0] - x[0], a[1] - x[1]


def _is_inside(edges: list[tuple[Point, Point]], x: Point) -> bool:
    """Count the edges to the right; a point on an edge is not inside."""
    inside = False
    for a, b in edges:
        (ax, ay), (bx, by) = _from(x, a), _from(x, b)
        turn = ax * by - ay * bx
        if turn == 0 and min(ax, bx) <= 0 <= max(ax, bx) and min(ay, by) <= 0 <= max(ay, by):
            return False
        if (ay > 0) != (by > 0) and (turn > 0) == (by > ay):
            inside = not inside
    return inside


def _meetings(a: Point, b: Point, x: Point, u: Point) -> list[Fraction]:
    """Return where the line x + s u meets a closed edge: where it begins and ends to, along it."""
    to_a, to_b = _from(x, a), _from(x, b)
    side_a, side_b = _cross(u, to_a), _cross(u, to_b)
    if side_a == side_b == 0:
        squared = u[0] ** 2 + u[1] ** 2
        return [(u[0] * px + u[1] * py) / squared for px, py in (to_a, to_b)]
    if side_a * side_b > 0:
        return []
    along = (b[0] - a[0], b[1] - a[1])
    return [_cross(to_a, along) / _cross(u, along)]
