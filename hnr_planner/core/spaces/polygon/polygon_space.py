"""One or more polygons, which may have holes, as a space of the plane."""

from functools import cached_property
import math
from typing import Any, TYPE_CHECKING

from hnr_planner.core.checks import check_number, check_point, check_points, Floats
from hnr_planner.core.errors import SpaceError
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.bounds import check_bounds, in_words, kernel_origin
from hnr_planner.core.spaces.curves.curve import along, first_exit_on_curve
from hnr_planner.core.spaces.curves.surfaces import (
    add_crossings,
    add_level_crossings,
    first_exit_between_surfaces,
)
from hnr_planner.core.spaces.polygon.cells import edges_in_cells
from hnr_planner.core.spaces.polygon.edges import distance_to_edges, PolygonData
from hnr_planner.core.spaces.primitives import component
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from shapely import LinearRing, MultiPolygon, Polygon

#: Distance to an edge that counts as 0, in roundings of the largest coordinate.
ROUNDING = 16


class PolygonSpace(Space):
    """
    The inside of a shapely polygon or multipolygon.

    The boundary rings are obstacles: a point on a ring is not free, and a line stops at a corner
    that it touches.
    The polygons of a multipolygon may touch in points, where nothing passes.

    Parameters
    ----------
    polygon : shapely.Polygon or shapely.MultiPolygon
        The polygons, valid and not empty. Coordinates z are ignored.

    Raises
    ------
    SpaceError
        When the polygon is empty or invalid, with shapely's reason.

    Attributes
    ----------
    polygon : shapely.Polygon or shapely.MultiPolygon
        The argument.

    """

    dim = 2
    data: PolygonData

    def __init__(self, polygon: 'Polygon | MultiPolygon') -> None:
        self.polygon = polygon
        self._polygons = _check_polygons(polygon)
        check_bounds('the polygon', *self.bounds)
        self._kernel_origin = kernel_origin(*self.bounds)
        edges, numbers = _edges(self._polygons)
        edges = self.to_kernel(edges.reshape(-1, 2)).reshape(-1, 4)
        rounding = ROUNDING * float(np.spacing(np.abs(edges).max()))
        self.data = edges_in_cells(edges, numbers, rounding)

    def __repr__(self) -> str:
        """Count polygons, holes and edges, and name the bounds."""
        lower, upper = self.bounds
        return (
            f'PolygonSpace(polygons={len(self._polygons)}, holes={len(self._holes())}, '
            f'edges={len(self.data.edges)}, lower={in_words(lower)}, upper={in_words(upper)})'
        )

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (2,), caller's frame."""
        corners = np.array(self.polygon.bounds)
        return corners[:2], corners[2:]

    @property
    def _rounding(self) -> float:
        """Rounding of the coordinates of points and edges, kernel frame."""
        return max(super()._rounding, self.data.rounding)

    @cached_property
    def typical_clearance(self) -> float:
        """Mean distance to the wall in a corridor of the same area and boundary length."""
        return float(self.polygon.area / self.polygon.length / 2.0)

    @property
    def island_points(self) -> Floats:
        """One point (k, 2) in each hole of the polygons, kernel frame."""
        from shapely import Polygon

        holes = [Polygon(hole).representative_point() for _, hole in self._holes()]
        return self.to_kernel(np.array([[point.x, point.y] for point in holes]).reshape(-1, 2))

    def covers_box(self, lower: Floats, upper: Floats) -> bool:
        """Return whether the closed polygon covers the box between two corners (2,)."""
        from shapely import box

        return bool(self.polygon.covers(box(*lower, *upper)))

    def why_not_free(self, point: ArrayLike) -> str:
        """Return the reason why ``point`` (2,) is not free."""
        from shapely import Point, Polygon

        where = Point(check_point('point', point, 2))
        for number, hole in self._holes():
            if Polygon(hole).contains_properly(where):
                return f'in a hole of {self._name(number)}'
        lower, upper = self.bounds
        place = 'on the boundary of' if self.polygon.intersects(where) else 'outside'
        return (
            f'{place} the polygon, which spans '
            f'x {lower[0]:g}..{upper[0]:g}, y {lower[1]:g}..{upper[1]:g}'
        )

    def connected(self, a: ArrayLike, b: ArrayLike) -> bool:
        """
        Return whether a path joins the points ``a`` and ``b`` (2,): both are in one polygon.

        False where one of the points is not free.
        """
        label = self._component(a)
        return label != 0 and label == self._component(b)

    def region_reachable(self, start: ArrayLike, goal: ArrayLike, radius: float) -> bool:
        """
        Return whether the polygon that holds ``start`` comes nearer than ``radius`` to ``goal``.

        ``goal`` (2,) need not be free. False where ``start`` (2,) is not free.
        """
        from shapely import Point

        label = self._component(start)
        if label == 0:
            return False
        distance = self._polygons[label - 1].distance(Point(check_point('goal', goal, 2)))
        return bool(distance < check_number('radius', radius, 0.0))

    def clearance(self, points: ArrayLike) -> Floats:
        """
        Return the distance (k,) from each of points (k, 2) to the nearest edge.

        It is 0 for points that are not free.
        """
        points = np.atleast_2d(check_points('points', points, 2))
        return distance_to_edges(self.data.edges, self.to_kernel(points)) * self.contains(points)

    def _component(self, point: ArrayLike) -> int:
        """Return the number of the polygon that holds a point (2,), from 1; 0 for none."""
        return int(component(self.data, self.to_kernel(check_point('point', point, 2))))

    def _holes(self) -> list[tuple[int, 'LinearRing']]:
        """Return the rings that are holes, each with the number of its polygon, from 1."""
        return [
            (number, hole)
            for number, polygon in enumerate(self._polygons, start=1)
            for hole in polygon.interiors
        ]

    def _name(self, number: int) -> str:
        """Return the name of polygon ``number``, from 1, in messages, which count from 0."""
        return 'the polygon' if len(self._polygons) == 1 else f'polygon {number - 1}'


def _check_polygons(polygon: Any) -> list['Polygon']:
    """
    Return the polygons of a valid geometry that is not empty, or raise SpaceError.

    Their exterior rings are counter-clockwise, their holes clockwise.
    """
    from shapely import MultiPolygon, Polygon
    from shapely.geometry.polygon import orient
    from shapely.validation import explain_validity

    if not isinstance(polygon, Polygon | MultiPolygon):
        raise SpaceError(f'polygon must be a shapely Polygon or MultiPolygon, got {polygon!r}')
    if polygon.is_empty:
        raise SpaceError('the polygon must have an inside, but it is empty')
    if not polygon.is_valid:
        raise SpaceError(
            f'the polygon must be valid, but shapely says: {explain_validity(polygon)}'
        )
    polygons = [polygon] if isinstance(polygon, Polygon) else polygon.geoms
    return [orient(each) for each in polygons if not each.is_empty]


def _edges(polygons: list['Polygon']) -> tuple[Floats, NDArray[np.int32]]:
    """
    Return the edges (m, 4), and the number (m,) of the polygon of each, from 1.

    The inside is on the left of each edge, which is (x, y) of its begin and of its end.
    """
    edges, numbers = [], []
    for number, polygon in enumerate(polygons, start=1):
        for ring in (polygon.exterior, *polygon.interiors):
            corners = np.asarray(ring.coords)[:, :2]
            of_ring = np.hstack([corners[:-1], corners[1:]])
            of_ring = of_ring[(of_ring[:, :2] != of_ring[:, 2:]).any(axis=1)]
            edges.append(of_ring)
            numbers.append(np.full(len(of_ring), number, dtype=np.int32))
    return np.concatenate(edges), np.concatenate(numbers)


first_exit_on_curve.register(PolygonData)(first_exit_between_surfaces)


@add_crossings.register(PolygonData)
@kernel
def _add_crossings(polygon, curve, end, crossings, n):
    """
    Append to ``crossings``, from index ``n``, where a curve meets the line through any edge.

    Return ``n`` plus the number of these parameters, also of those that do not fit.
    """
    normal = np.empty(2)
    for k in range(len(polygon.edges)):
        ax, ay, bx, by = polygon.edges[k]
        length = math.hypot(bx - ax, by - ay)
        normal[0], normal[1] = (by - ay) / length, (ax - bx) / length
        level = normal[0] * ax + normal[1] * ay
        n = add_level_crossings(along(curve, normal), level, end, crossings, n)
    return n
