"""Footprints: what is refused and why, and the convex pieces."""

from test.core.spaces.poses.robots import FOOTPRINTS, RECTANGLE

from hnr_planner.core import GridSpace, PoseSpace, SpaceError
from hnr_planner.core.spaces.poses.footprint import check_footprint, convex_pieces
import numpy as np
import pytest
import shapely

GRID = GridSpace.from_blocked(np.zeros((20, 30), dtype=bool), 0.1)


@pytest.mark.parametrize(
    ('footprint', 'why'),
    [
        ([(0, 0), (1, 1), (1, 0), (0, 1)], 'must not cross or touch itself: Self-intersection'),
        ([(0, 0), (1, 0), (1, 1), (0.5, 0), (0, 1)], 'must not cross or touch itself'),
        ([(0, 0), (1, 0), (2, 0)], 'must'),
        ([(0, 0), (1, 0), (1, 1e-7), (0, 1e-7)], 'must have an area'),
        ([(0, 0), (1, 0)], r'shape \(k, 2\) with k >= 3, got \(2, 2\)'),
        ([(0, 0), (1, 0), (0, 0)], 'no repeated vertex'),
        ([(0, 0), (1, 0), (1, 0), (0, 1)], 'no repeated vertex'),
        ([(0, 0, 0), (1, 0, 0), (0, 1, 0)], r'shape \(k, 2\)'),
        ([(0, 0), (np.nan, 0), (0, 1)], 'must be finite'),
        ([(0, 0), (np.inf, 0), (0, 1)], 'must be finite'),
        ('round', 'must be numbers'),
        ([(-2, -0.1), (2, -0.1), (2, 0.1), (-2, 0.1)], r'fit into the map of 3 x 2 m, got one of'),
    ],
)
def test_a_footprint_that_is_none_is_refused_with_the_reason(footprint, why):
    with pytest.raises(SpaceError, match=f'footprint .*{why}'):
        PoseSpace(GRID, footprint)


def test_order_repeated_ends_and_straight_sides_do_not_matter():
    outline = np.array(RECTANGLE)
    along = np.insert(outline, 1, outline[:2].mean(axis=0), axis=0)
    for same in (outline[::-1], np.vstack([outline, outline[:1]]), along):
        checked = check_footprint(same)
        assert {tuple(v) for v in checked.tolist()} == {tuple(v) for v in outline.tolist()}
        assert shapely.LinearRing(checked).is_ccw


def star(n, rng):
    """Return a polygon with n vertices around the origin, far from convex."""
    angles = np.sort(rng.uniform(0.0, 2.0 * np.pi, n))
    return rng.uniform(0.3, 1.0, n)[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def test_convex_pieces_are_convex_and_cover_the_footprint_once(rng):
    outlines = [check_footprint(outline) for outline in FOOTPRINTS.values()]
    outlines += [check_footprint(star(n, rng)) for n in (5, 8, 13, 21)]
    for vertices in outlines:
        pieces = [shapely.Polygon(vertices[piece]) for piece in convex_pieces(vertices)]
        whole = shapely.Polygon(vertices)
        assert sum(piece.area for piece in pieces) == pytest.approx(whole.area)
        assert shapely.union_all(pieces).symmetric_difference(whole).area < 1e-12
        for piece in pieces:
            assert piece.convex_hull.area == pytest.approx(piece.area)
    assert len(convex_pieces(check_footprint(RECTANGLE))) == 1


@pytest.mark.parametrize(
    ('options', 'why'),
    [
        ({'drive': 'tank'}, 'drive must be one of car, differential, omnidirectional, got'),
        ({'drive': 'car'}, 'min_turning_radius must be above 0 for a car'),
        ({'drive': 'car', 'min_turning_radius': -1.0}, 'must be at least 0 and finite, got -1.0'),
        ({'drive': 'car', 'min_turning_radius': np.nan}, 'must be at least 0 and finite, got nan'),
        ({'drive': 'differential', 'min_turning_radius': 0.5}, 'must be 0 for a differential'),
        ({'drive': 'omnidirectional', 'reverse': False}, 'reverse must be true'),
    ],
)
def test_a_drive_that_is_none_is_refused_with_the_reason(options, why):
    with pytest.raises(SpaceError, match=why):
        PoseSpace(GRID, RECTANGLE, **options)


def test_only_a_grid_can_be_driven_on():
    with pytest.raises(SpaceError, match='grid must be a GridSpace'):
        PoseSpace(np.zeros((5, 5)), RECTANGLE)
