"""The view of a point: areas by hand, and its points against ``is_motion_valid``."""

import math
from test.core.theory.sets import DISC, L_SET, SQUARE, U_SET
from test.laws.maps import TWO_ROOMS

from hnr_planner.core import BoxSpace, DifferenceSpace, GridSpace, PolygonSpace, RequestError
from hnr_planner.core.theory import polygon_area, view
from matplotlib.path import Path
import numpy as np
import pytest
from shapely import box

HALL = GridSpace.from_blocked(TWO_ROOMS, 0.2, (3.0, 2.0, 0.4))


@pytest.mark.parametrize(
    ('u', 'area'),
    [
        # Beside the corner (1, 1) all is seen.
        ((0.5, 0.5), 3.0),
        # Past it the line from (1.5, .5) leaves a triangle of 1 by 1 unseen.
        ((1.5, 0.5), 2.5),
        # The line from (1.75, .75) through the corner meets x = 0 at 4/3: unseen beyond y = 1 is
        # the unit square without the triangle below that line, 1 by 1/3.
        ((1.75, 0.75), 2 + 1 / 6),
    ],
)
def test_an_ell_by_hand(u, area):
    assert polygon_area(view(L_SET, u)) == pytest.approx(area, rel=1e-12)
    turned = GridSpace.from_blocked(L_SET.blocked, 0.5, (4.0, -1.0, 0.7))
    there = turned.from_kernel(L_SET.to_kernel(np.array(u)))
    assert polygon_area(view(turned, there)) == pytest.approx(area / 4, rel=1e-12)


def test_a_you_by_hand():
    """From the middle of one arm (1, 8), arms 2 wide and 6 long above a hall of 7 by 3."""
    # Left of the line through the corner (2, 3), which goes from (1, 8) to the floor at x = 2.6.
    assert polygon_area(view(U_SET, (1, 8))) == pytest.approx(12 + 3 * (2 + 2.6) / 2, rel=1e-12)


@pytest.mark.parametrize(
    ('space', 'u'),
    [(U_SET, (3.2, 1.1)), (HALL, HALL.from_kernel(np.array([5.6, 4.3]))), (SQUARE, (0.9, 0.05))],
    ids=['you', 'hall', 'square'],
)
def test_it_holds_the_points_that_are_seen_and_no_others(space, u):
    polygon = view(space, u)
    points = np.random.default_rng(1).uniform(*space.bounds, size=(3000, 2))
    inside = Path(polygon).contains_points(points)
    seen = [space.is_motion_valid(u, point) for point in points]
    assert inside.tolist() == seen
    assert 0 < inside.sum() < 3000 or space is SQUARE


@pytest.mark.interpreted
def test_a_polygon_with_a_hole():
    """A square room with a square pillar: what lies behind the pillar is a trapezium."""
    room = PolygonSpace(box(-2, -2, 2, 2).difference(box(-1, -1, 1, 1)))
    # From (-1.5, 0) the pillar hides x > -1 between its near corners at (-1, +-1): by x = -.5 the
    # lines of slope 2 leave the room at y = 2.
    hidden_or_pillar = 3 * 4 - (2 * 0.5 * 1 / 2)
    assert polygon_area(view(room, (-1.5, 0))) == pytest.approx(16 - hidden_or_pillar, rel=1e-9)
    grid = GridSpace.from_blocked(np.pad(np.ones((2, 2), dtype=bool), 1), 1.0, (-2.0, -2.0, 0.0))
    assert view(grid, (-1.5, 0.3)) == pytest.approx(view(room, (-1.5, 0.3)), abs=1e-9)


def test_a_smooth_boundary_is_met_by_a_polygon():
    assert polygon_area(view(DISC, (0.3, -0.4), 4000)) == pytest.approx(math.pi, rel=1e-5)
    # The strip of .5 by 2 on its side, and two triangles of .25 by .5 past the corners.
    ring = DifferenceSpace(BoxSpace((-1, -1), (1, 1)), BoxSpace((-0.5, -0.5), (0.5, 0.5)))
    assert polygon_area(view(ring, (-0.75, 0.0), 40_000)) == pytest.approx(1.125, rel=1e-3)


def test_a_point_without_a_view_is_refused():
    with pytest.raises(RequestError, match='is occupied'):
        view(L_SET, (1.5, 1.5))
    with pytest.raises(RequestError, match='3 axes'):
        view(BoxSpace((0, 0, 0), (1, 1, 1)), (0.5, 0.5, 0.5))
