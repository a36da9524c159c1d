"""Spaces far from the origin: planned in from their own middle, refused where numbers end."""

from hnr_planner.core import (
    BallSpace,
    BoxSpace,
    DifferenceSpace,
    OracleSpace,
    plan,
    PlannerStatus,
    PolygonSpace,
    PolytopeSpace,
    ProductSpace,
    sample,
    ShearedSpace,
    SpaceError,
    UnionSpace,
)
import numpy as np
import pytest
import shapely

pytestmark = pytest.mark.interpreted

#: A place in the coordinates of a map projection [m].
PLACE = np.array([691_000.0, 5_334_000.0])


def room(side: float, wall: float) -> shapely.Polygon:
    """Return a square room at the place, with a wall across it up to so much of its side."""
    outline = shapely.box(*PLACE, *(PLACE + side))
    return outline - shapely.box(
        *(PLACE + (0.45 * side, -side)), *(PLACE + (0.55 * side, wall * side))
    )


@pytest.mark.parametrize('side', [12.0, 5.0, 1.0, 0.01])
def test_a_room_in_the_coordinates_of_a_map_projection_is_planned_in(side):
    polygon = room(side, 0.8)
    space = PolygonSpace(polygon)
    start, goal = PLACE + 0.1 * side, PLACE + (0.9 * side, 0.1 * side)
    found = plan(space, start, goal, seed=1, time_limit=np.inf, max_iterations=10**5)
    assert found.status is PlannerStatus.SOLVED
    np.testing.assert_array_equal(found.path[[0, -1]], [start, goal])
    # By shapely in coordinates from the place, which are exact.
    near = shapely.transform(polygon, lambda xy: xy - PLACE)
    assert near.contains(shapely.LineString(found.path - PLACE))


def spaces_of_every_kind():
    """Yield a space about a metre wide at the place, and the same one at the origin."""
    for origin in (PLACE, np.zeros(2)):
        box = BoxSpace(origin, origin + 1.0)
        ball = BallSpace(origin + 0.5, 0.5)
        yield [
            box,
            ball,
            PolygonSpace(shapely.box(*origin, *(origin + 1.0))),
            PolytopeSpace(np.vstack([np.eye(2), -np.eye(2)]), [*(origin + 1.0), *-origin]),
            OracleSpace(
                lambda x, o=origin: bool(((x > o) & (x < o + 1.0)).all()),
                origin - 0.5,
                origin + 1.5,
                resolution=0.01,
            ),
            ShearedSpace(box, 0.5),
            UnionSpace(box, BallSpace(origin + 1.0, 0.4)),
            DifferenceSpace(box, BallSpace(origin + 0.5, 0.2)),
            ProductSpace(BoxSpace([origin[0]], [origin[0] + 1.0]), BoxSpace([0.0], [1.0])),
        ]


def test_far_spaces_are_those_at_the_origin_moved():
    rng = np.random.default_rng(7)
    far, near = spaces_of_every_kind()
    for there, here in zip(far, near, strict=True):
        shift = (PLACE[0], 0.0) if isinstance(there, ProductSpace) else PLACE
        np.testing.assert_allclose(there.bounds - np.array(shift), here.bounds, atol=2e-9)
        for x in rng.integers(-20, 120, (60, 2)) / 128.0:
            u = rng.standard_normal(2)
            assert there.contains(x + shift) == here.contains(x)
            assert there.chord(x + shift, u) == pytest.approx(here.chord(x, u), abs=1e-8)


def test_walks_in_far_spaces_stay_inside():
    far, _ = spaces_of_every_kind()
    for space in far:
        start = np.mean(space.bounds, axis=0) + 0.23
        draws = sample(space, start, 200, seed=3)
        assert space.contains(draws.reshape(-1, 2)).all()
        assert (np.ptp(draws, axis=(0, 1)) > 0.5).all()


@pytest.mark.parametrize('distance', [1e9, 1e13])
def test_a_space_that_coordinates_do_not_resolve_is_refused_with_what_helps(distance):
    lower = np.array([distance, 0.0])
    for build in (
        lambda: BoxSpace(lower, lower + 1e-2),
        lambda: BallSpace(lower, 5e-3),
        lambda: PolygonSpace(shapely.box(*lower, *(lower + 1e-2))),
        lambda: OracleSpace(lambda x: True, lower, lower + 1e-2, resolution=1e-3),
    ):
        with pytest.raises(SpaceError, match=r'must resolve 1e-06 .* nearer to the origin'):
            build()
