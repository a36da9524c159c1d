"""The distance by chains: closed forms in convex sets, and bounds in others."""

import math
from test.core.theory.sets import DISC, L_SET, PLUS, SQUARE, U_SET

from hnr_planner.core import BoxSpace, PolygonSpace, RequestError
from hnr_planner.core.theory import chain_distance, cross_ratio_distance, even_chain_distance
import numpy as np
import pytest
from shapely import Polygon


def test_even_parts_by_hand():
    """On the chord of the disc: 8 in one link, 4 by the middle, log 9 in the limit."""
    found = [even_chain_distance(8, k) for k in (1, 2, math.inf)]
    assert found == pytest.approx([8, 4, math.log(9)])


@pytest.mark.parametrize('space', [DISC, SQUARE], ids=['disc', 'square'])
@pytest.mark.parametrize('n_links', [1, 2, 3, math.inf])
def test_in_convex_sets_no_detour_is_shorter(space, n_links):
    u, v = (0.1, 0.2), (0.7, 0.6)
    exact = even_chain_distance(cross_ratio_distance(space, u, v)[0], n_links)
    lower, upper = chain_distance(space, u, v, n_links)
    assert lower == pytest.approx(exact)
    assert upper == pytest.approx(exact, rel=1e-3)


def test_even_parts_are_the_best_of_a_chord():
    """Against every other division in two of a chord of the disc."""
    middle = np.stack([np.linspace(-0.499, 0.499, 2001), np.zeros(2001)], axis=1)
    ends = cross_ratio_distance(DISC, (-0.5, 0), middle) + cross_ratio_distance(
        DISC, middle, (0.5, 0)
    )
    assert ends.min() == pytest.approx(even_chain_distance(8, 2), rel=1e-6)


def test_round_the_corner_of_an_ell():
    """By symmetry through the diagonal; the hull's distance is as large, so it is exact."""
    lower, upper = chain_distance(L_SET, (0.5, 1.5), (1.5, 0.5), 2)
    assert lower == pytest.approx(4)
    assert upper == pytest.approx(4, rel=1e-4)
    assert chain_distance(L_SET, (0.5, 1.5), (1.5, 0.5), 1).upper == math.inf


@pytest.mark.sweep
def test_a_polygon_is_the_same_as_its_grid():
    """The same L as a polygon, whose rings run either way."""
    ring = [(0, 0), (0, 2), (1, 2), (1, 1), (2, 1), (2, 0)]
    for corners in (ring, ring[::-1]):
        ell = PolygonSpace(Polygon(corners))
        of_polygon = chain_distance(ell, (0.5, 1.9), (1.9, 0.5))
        of_grid = chain_distance(L_SET, (0.5, 1.9), (1.9, 0.5))
        assert of_polygon.lower == pytest.approx(of_grid.lower, rel=1e-6)
        assert of_polygon.upper == pytest.approx(of_grid.upper, rel=1e-3)


@pytest.mark.parametrize('n_links', [3, 6, math.inf])
def test_bounds_enclose_and_more_links_cost_less(n_links):
    u, v = (1, 8), (6, 8)
    bounds = chain_distance(U_SET, u, v, n_links)
    assert 0 < bounds.lower <= bounds.upper < math.inf
    fewer = chain_distance(U_SET, u, v, 3)
    assert bounds.upper <= fewer.upper
    # Two corners, so a path of two corridors of 6 and a floor: 12 + 3 long or more.
    diameter = math.hypot(7, 9)
    assert bounds.lower >= 4 * (2 * math.hypot(1, 5) + 3) / diameter * (1 - 1e-5)


def test_a_detour_through_long_chords_is_shorter_than_a_short_chord():
    """Points that see each other: d-tilde is less than any division of their chord costs."""
    u, v = (3.4, 3.4), (3.6, 3.6)
    straight = even_chain_distance(cross_ratio_distance(PLUS, u, v)[0])
    assert chain_distance(PLUS, u, v, 2).upper < straight / 3


def test_what_has_no_chain_is_refused():
    with pytest.raises(RequestError, match='3 axes'):
        chain_distance(BoxSpace((0, 0, 0), (1, 1, 1)), (0.1, 0.1, 0.1), (0.5, 0.5, 0.5))
    with pytest.raises(RequestError, match='n_links must be at least 1, got 0'):
        chain_distance(DISC, (0, 0), (0.5, 0), 0)
