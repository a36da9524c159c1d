"""Polygons against exact fractions, where rounding decides, and what is refused."""

from test import exact_polygons

from hnr_planner.core import PolygonSpace, SpaceError
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest
import shapely

COMB = shapely.Polygon(
    [(0, 0), (8, 0), (8, 5), (7, 5), (7, 1), (6, 5), (5, 1), (4, 4), (3, 1), (2, 5), (0, 5)],
    [[(1, 1), (2, 1), (2, 2), (1, 2)], [(1, 3), (2, 2), (1, 4)]],
)
"""Teeth, slanted and upright, and two holes that touch each other in a corner."""

DIAMONDS = shapely.MultiPolygon(
    [
        shapely.Polygon([(0, 2), (2, 0), (4, 2), (2, 4)], [[(1, 2), (2, 1), (3, 2), (2, 3)]]),
        shapely.Polygon([(4, 2), (6, 0), (8, 2), (6, 4)]),
        shapely.box(4, 3, 5, 4),
        shapely.box(1.5, 1.5, 2.5, 2.5),
    ]
)
"""Polygons that touch in a corner or on an edge, and one in the hole of another."""


def star(corners: int, seed: int) -> shapely.Polygon:
    """Return a polygon of long thin spikes with a hole of another such."""
    rng = np.random.default_rng(seed)
    rings = []
    for radius in (1.0, 0.15):
        angles = 2.0 * np.pi * (np.arange(corners) + rng.uniform(0.0, 0.9, corners)) / corners
        radii = radius * rng.uniform(0.4, 1.0, corners)
        rings.append(radii[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1))
    return shapely.Polygon(rings[0], [rings[1]])


# -- against exact fractions


halves = st.integers(-2, 18).map(lambda k: k / 2)
steps = st.tuples(st.integers(-4, 4), st.integers(-4, 4)).filter(any)


@pytest.mark.parametrize('polygon', [COMB, DIAMONDS], ids=['comb', 'diamonds'])
def test_corners_and_edges_that_a_line_meets_exactly(polygon):
    """Half of these lines run through a corner, along an edge, or begin on the boundary."""
    space = PolygonSpace(polygon)

    @settings(max_examples=400, deadline=None, derandomize=True, database=None)
    @given(st.tuples(halves, halves), steps)
    def check(point, direction):
        assert space.contains(point) == exact_polygons.contains(polygon, point)
        expected = exact_polygons.chord(polygon, point, direction)
        found = space.chord(point, direction)
        np.testing.assert_allclose(found, expected.astype(float), rtol=0.0, atol=1e-15)

    check()


@pytest.mark.parametrize('corners', [5, 60])
def test_lines_of_any_direction(corners):
    polygon = star(corners, seed=corners)
    space, rng = PolygonSpace(polygon), np.random.default_rng(1)
    for point, direction in zip(
        rng.uniform(-1.0, 1.0, (80, 2)), rng.standard_normal((80, 2)), strict=True
    ):
        assert space.contains(point) == exact_polygons.contains(polygon, point)
        expected = exact_polygons.chord(polygon, point, direction).astype(float)
        np.testing.assert_allclose(space.chord(point, direction), expected, rtol=0.0, atol=1e-13)


@pytest.mark.parametrize('shift', [0.0, 1e3, 1e6])
def test_nothing_goes_on_behind_a_corner_that_it_hits(shift):
    """Between two edges that share a corner there is no gap, however the numbers round."""
    polygon = shapely.transform(star(300, seed=7), lambda corners: corners * 3.0 + shift)
    space, rng = PolygonSpace(polygon), np.random.default_rng(2)
    lower, upper = space.bounds
    points = rng.uniform(lower, upper, (400, 2))
    rounding = 1e-15 * (1.0 + shift)
    for point in points[space.contains(points)]:
        corner = rng.choice(shapely.get_coordinates(polygon))
        reach = space.chord(point, corner - point).upper
        assert reach <= 1.0 + 40.0 * rounding / np.linalg.norm(corner - point)


@pytest.mark.parametrize('shift', [0.0, 1e3, 1e6])
def test_no_point_of_an_edge_is_free(shift):
    polygon = shapely.transform(star(300, seed=8), lambda corners: corners * 3.0 + shift)
    space, rng = PolygonSpace(polygon), np.random.default_rng(3)
    rings = [shapely.get_coordinates(ring) for ring in shapely.get_rings(polygon)]
    for ring in rings:
        along = rng.random((len(ring) - 1, 1))
        assert not space.contains(ring).any()
        assert not space.contains(ring[:-1] + along * np.diff(ring, axis=0)).any()


@settings(max_examples=60, deadline=None, derandomize=True, database=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 40))
def test_unions_of_rectangles_of_any_kind_hold_what_shapely_says(seed, n):
    """Corners are shared, edges overlap, holes touch rings: whatever comes of whole numbers."""
    rng = np.random.default_rng(seed)
    boxes = [shapely.box(x, y, x + w, y + h) for x, y, w, h in rng.integers(1, 12, (n, 4))]
    polygon = shapely.union_all(boxes[::2]).difference(shapely.union_all(boxes[1::2]))
    if polygon.is_empty:
        return
    space = PolygonSpace(polygon)
    points = np.concatenate([rng.integers(0, 48, (200, 2)) / 2.0, rng.uniform(0, 24, (200, 2))])
    inside = shapely.contains_properly(polygon, shapely.points(points))
    assert space.contains(points).tolist() == inside.tolist()


def test_many_edges():
    polygon = star(10_000, seed=5)
    space, rng = PolygonSpace(polygon), np.random.default_rng(6)
    points = rng.uniform(-1.0, 1.0, (20_000, 2))
    inside = shapely.contains_xy(polygon, points)
    assert space.contains(points).tolist() == inside.tolist()
    for point in points[inside][:50]:
        direction = rng.standard_normal(2)
        lower, upper = space.chord(point, direction)
        inner = shapely.LineString(point + np.array([[lower], [upper]]) * 0.999999 * direction)
        outer = shapely.LineString(point + np.array([[lower], [upper]]) * 1.000001 * direction)
        assert polygon.contains_properly(inner)
        assert not polygon.contains(outer)


# -- queries of a polygon


def test_polygons_are_not_connected_where_they_touch():
    space = PolygonSpace(DIAMONDS)
    assert space.connected((0.5, 2.0), (3.5, 2.0))
    assert not space.connected((3.5, 2.0), (4.5, 2.0))
    assert not space.connected((0.5, 2.0), (2.0, 2.0))
    assert not space.connected((4.5, 3.5), (6.0, 2.0))
    assert not space.connected((0.0, 0.0), (0.0, 0.0))
    assert not space.is_motion_valid((3.5, 2.0), (4.5, 2.0))


def test_a_region_is_reachable_when_the_polygon_comes_into_it():
    space = PolygonSpace(DIAMONDS)
    assert space.region_reachable((0.5, 2.0), (6.0, 2.0), 2.1)
    assert not space.region_reachable((0.5, 2.0), (6.0, 2.0), 2.0)
    assert not space.region_reachable((9.0, 9.0), (6.0, 2.0), 100.0)


def test_clearance_is_the_distance_to_the_nearest_ring():
    polygon = star(200, seed=9)
    space = PolygonSpace(polygon)
    points = np.random.default_rng(4).uniform(-1.0, 1.0, (500, 2))
    expected = shapely.distance(polygon.boundary, shapely.points(points))
    expected[~shapely.contains_xy(polygon, points)] = 0.0
    np.testing.assert_allclose(space.clearance(points), expected, rtol=1e-12)


def test_islands_are_the_holes():
    for polygon, n in ((COMB, 2), (star(20, seed=1), 1), (shapely.box(0, 0, 1, 1), 0)):
        points = PolygonSpace(polygon).island_points
        assert points.shape == (n, 2)
        holes = shapely.get_parts(shapely.Polygon(polygon.exterior).difference(polygon))
        held = [
            [hole.contains_properly(shapely.Point(point)) for point in points] for hole in holes
        ]
        assert (np.array(held).reshape(n, n).sum(axis=0) == 1).all()


def test_why_a_point_is_not_free():
    space = PolygonSpace(COMB)
    for point, reason in (
        ((1.5, 1.5), 'in a hole of the polygon'),
        ((1.0, 1.5), 'on the boundary of the polygon, which spans x 0..8, y 0..5'),
        ((0.0, 0.0), 'on the boundary of the polygon'),
        ((7.5, 6.0), 'outside the polygon, which spans x 0..8, y 0..5'),
        ((3.0, 4.0), 'outside the polygon'),
    ):
        assert not space.contains(point)
        assert space.why_not_free(point).startswith(reason)
    assert PolygonSpace(DIAMONDS).why_not_free((2.0, 1.2)) == 'in a hole of polygon 0'


def test_it_keeps_its_argument_and_recognizes_boxes_that_it_covers():
    space = PolygonSpace(COMB)
    assert space.polygon is COMB
    assert space.covers_box(np.array([0.0, 0.0]), np.array([8.0, 1.0]))
    assert not space.covers_box(np.array([0.0, 0.0]), np.array([8.0, 1.1]))


# -- what is refused


@pytest.mark.parametrize(
    ('polygon', 'reason'),
    [
        ('a square', 'must be a shapely Polygon or MultiPolygon'),
        (shapely.LineString([(0, 0), (1, 1)]), 'must be a shapely Polygon or MultiPolygon'),
        (shapely.Polygon(), 'must have an inside, but it is empty'),
        (shapely.MultiPolygon([]), 'must have an inside, but it is empty'),
        (shapely.Polygon([(0, 0), (1, 1), (1, 0), (0, 1)]), r'Self-intersection\[0.5 0.5\]'),
        (shapely.Polygon([(0, 0), (1, 1), (2, 2)]), 'must be valid, but shapely says'),
        (shapely.Polygon([(0, 0), (0, 0), (0, 0)]), 'must be valid, but shapely says'),
        (
            shapely.Polygon([(0, 0), (4, 0), (4, 4)], [[(5, 5), (6, 5), (6, 6)]]),
            'Hole lies outside shell',
        ),
        (
            shapely.MultiPolygon([shapely.box(0, 0, 2, 2), shapely.box(1, 1, 3, 3)]),
            'Self-intersection',
        ),
        (shapely.box(0, 1e9, 1, 1e9 + 1e-3), 'too thin for where it lies'),
    ],
)
def test_what_is_no_polygon_is_refused_with_the_reason(polygon, reason):
    with pytest.raises(SpaceError, match=reason):
        PolygonSpace(polygon)


@pytest.mark.parametrize('bad', [np.nan, np.inf])
def test_coordinates_that_are_not_finite_are_refused(bad):
    with np.errstate(invalid='ignore'):
        polygon = shapely.Polygon([(0, 0), (bad, 1), (1, 0)])
        with pytest.raises(SpaceError, match='Invalid Coordinate'):
            PolygonSpace(polygon)
