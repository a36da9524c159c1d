"""Bounds on the link diameter, against numbers counted by hand."""

import math
from test.core.theory.sets import L_SET, PLUS, U_SET
from test.laws.maps import CHECKERBOARD, CORRIDOR, drawn, ONE_CELL, SPIRAL, TWO_ROOMS

from hnr_planner.core import GridSpace, PolygonSpace, RequestError
from hnr_planner.core.theory import (
    annulus_sector_links,
    link_diameter,
    polygon_link_diameter,
)
import numpy as np
import pytest
from scipy.sparse.csgraph import dijkstra
from shapely import box, MultiPolygon, Polygon

HALL = GridSpace.from_blocked(TWO_ROOMS)


@pytest.mark.parametrize(
    ('space', 'links'),
    [
        (GridSpace.from_blocked(ONE_CELL), 1),
        (GridSpace.from_blocked(CORRIDOR), 1),
        (L_SET, 2),
        (PLUS, 2),
        (U_SET, 3),
        (GridSpace.from_blocked(SPIRAL), 7),
    ],
    ids=['cell', 'corridor', 'L', 'plus', 'U', 'spiral'],
)
def test_bounds_are_equal_to_the_number_counted_by_hand(space, links):
    assert link_diameter(space, 2) == (links, links)


def test_pairs_of_different_components_do_not_count():
    assert link_diameter(GridSpace.from_blocked(CHECKERBOARD)) == (1, 1)


def test_bounds_enclose_and_come_together():
    bounds = [link_diameter(HALL, subdivision) for subdivision in (1, 2, 3)]
    lower, upper = np.transpose(bounds)
    assert (lower <= upper.min()).all()
    assert (np.diff(lower) >= 0).all()
    assert (np.diff(upper) <= 0).all()


def test_chains_over_random_points_are_no_shorter():
    """The largest number of links among 300 points lies between the bounds too."""
    rng = np.random.default_rng(1)
    points = rng.uniform(*HALL.bounds, size=(600, 2))
    points = points[[HALL.connected(point, (0.5, 3.5)) for point in points]][:300]
    visible = np.array([[HALL.is_motion_valid(a, b) for a in points] for b in points])
    links = dijkstra(visible, unweighted=True)
    assert (
        link_diameter(HALL).lower <= links[np.isfinite(links)].max() <= link_diameter(HALL).upper
    )


@pytest.mark.parametrize(
    ('polygon', 'links'),
    [
        (Polygon([(0, 0), (3, 0), (1, 2)]), 1),
        (Polygon([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]), 2),
        (box(0, 0, 7, 9).difference(box(2, 3, 5, 9)), 3),
        # The middles of two opposite walls of a room with a pillar do not meet at a third wall.
        (box(-2, -2, 2, 2).difference(box(-1, -1, 1, 1)), 3),
        # Each of two rooms that touch in a corner by itself.
        (MultiPolygon([box(0, 0, 1, 1), box(1, 1, 2, 2)]), 1),
    ],
    ids=['triangle', 'ell', 'you', 'pillar', 'apart'],
)
def test_of_polygons_it_is_what_one_counts(polygon, links):
    assert polygon_link_diameter(PolygonSpace(polygon), 16) == (links, links)


@pytest.mark.parametrize('inner', [1.0, 1.5])
def test_a_sector_lies_between_the_bounds_of_its_polygon(inner):
    angle = np.linspace(0, math.pi, 60)
    arc = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    sector = PolygonSpace(Polygon(np.concatenate([2 * arc, inner * arc[::-1]])))
    lower, upper = polygon_link_diameter(sector, 16)
    assert lower <= annulus_sector_links(inner, 2, math.pi) <= upper <= lower + 1


def test_a_sector_of_an_annulus():
    """With radii 1 and 2 a segment turns by up to 120 degrees."""
    assert annulus_sector_links(1, 2, math.pi / 2) == 2
    assert annulus_sector_links(1, 2, math.pi) == 3
    assert annulus_sector_links(1.9, 2, 2 * math.pi) == 11
    with pytest.raises(RequestError, match='0 < inner < outer, got 2, 1'):
        annulus_sector_links(2, 1, 1.0)


def test_a_grid_without_free_cells_is_refused():
    with pytest.raises(RequestError, match='every cell'):
        link_diameter(GridSpace.from_blocked(drawn('##', '##')))
