"""Balls and boxes under a shear: the map, its constants, and lines that touch."""

from hnr_planner.core import BallSpace, BoxSpace, ShearedSpace, SpaceError
from hnr_planner.core.spaces.curves.polynomials import next_change
import numpy as np
import pytest

pytestmark = pytest.mark.interpreted

SPACES = {
    'disc': lambda: ShearedSpace(BallSpace((2.0, -1.0), 1.5), 0.9),
    'ball': lambda: ShearedSpace(BallSpace(np.full(5, 3.0), 0.5), -4.0),
    'box': lambda: ShearedSpace(BoxSpace((0.0, 1.0, 2.0), (4.0, 2.0, 2.5)), 0.3),
    'ball, unbent': lambda: ShearedSpace(BallSpace((0.0, 0.0, 0.0), 1.0), 0.0),
    'ball, hardly bent': lambda: ShearedSpace(BallSpace((0.0, 0.0), 1.0), 1e-9),
    'ball, folded': lambda: ShearedSpace(BallSpace((0.0, 0.0), 1.0), 50.0),
}


@pytest.fixture(params=SPACES)
def space(request):
    return SPACES[request.param]()


@pytest.fixture
def rng():
    return np.random.default_rng(20160823)


def points_of(base, rng, n):
    lower, upper = base.bounds
    points = rng.uniform(lower, upper, (n, base.dim))
    return points[base.contains(points)]


def test_it_is_the_image_of_its_base(space, rng):
    lower, upper = space.base.bounds
    points = rng.uniform(lower - 0.1, upper + 0.1, (4000, space.dim))
    images = space.image(points)
    np.testing.assert_allclose(space.preimage(images), points, atol=1e-13)
    assert space.contains(images).tolist() == space.base.contains(points).tolist()
    by_hand = points.copy()
    by_hand[:, -1] += space.bend * (points[:, 0] - (lower + upper)[0] / 2.0) ** 2
    np.testing.assert_allclose(images, by_hand, atol=1e-13)


def test_bounds_are_touched_on_every_side(space, rng):
    """The nearest of 2e5 points comes as near as the sharpest corner lets it, in any dimension."""
    lower, upper = space.base.bounds
    points = rng.standard_normal((200_000, space.dim))
    if isinstance(space.base, BallSpace):
        points *= space.base.radius / np.linalg.norm(points, axis=1, keepdims=True)
        images = space.image(space.base.centre + points)
    else:
        corners = np.where(points > 0.0, upper, lower)
        corners[::2, 0] = (lower + upper)[0] / 2.0
        images = space.image(corners)
    lower, upper = space.bounds
    assert (images >= lower - 1e-12).all() and (images <= upper + 1e-12).all()
    sides = upper - lower
    assert (images.min(axis=0) - lower <= 0.05 * sides).all()
    assert (upper - images.max(axis=0) <= 0.05 * sides).all()


def test_the_map_keeps_volume(space, rng):
    """The Jacobian by central differences, which are exact for a polynomial of degree two."""
    x, step = points_of(space.base, rng, 4000)[0], 0.125
    jacobian = np.stack(
        [(space.image(x + e) - space.image(x - e)) / (2 * step) for e in step * np.eye(space.dim)]
    )
    assert np.linalg.det(jacobian) == pytest.approx(1.0)


def test_stretch_and_shrink_hold_for_all_pairs_and_are_reached(space, rng):
    lower, upper = space.base.bounds
    x, y = points_of(space.base, rng, 4000), points_of(space.base, rng, 4000)
    n = min(len(x), len(y))
    x, y = x[:n], y[:n]
    # Pairs near the two ends of the first axis, in every direction of the plane that is sheared.
    angles = np.linspace(0.0, np.pi, 20_000)
    ends = np.tile((lower + upper) / 2.0, (len(angles), 1))
    ends[:, 0] = lower[0] + 1e-4 * (upper - lower)[0]
    around = ends.copy()
    around[:, 0] += 1e-6 * (upper - lower)[0] * np.cos(angles)
    around[:, -1] += 1e-6 * (upper - lower)[0] * np.sin(angles)
    ratios = []
    for a, b in ((x, y), (ends, around)):
        before = np.linalg.norm(a - b, axis=1)
        ratios.append(np.linalg.norm(space.image(a) - space.image(b), axis=1) / before)
    ratio = np.concatenate(ratios)
    assert 0.999 * space.stretch <= ratio.max() <= (1.0 + 1e-8) * space.stretch
    assert 0.999 / space.shrink <= 1.001 * ratio.min()
    assert ratio.min() >= (1.0 - 1e-8) / space.shrink
    assert min(space.stretch, space.shrink) >= 1.0


def test_chords_against_many_points(space, rng):
    """Two walls and a bend: no point of a chord is outside, and the first beyond it is."""
    n_checked = 0
    for x in space.image(points_of(space.base, rng, 200)[:40]):
        u = rng.standard_normal(space.dim)
        lower, upper = space.chord(x, u)
        inside = x + np.linspace(lower, upper, 1001)[1:-1, None] * u
        assert space.base.contains(space.preimage(inside)).all()
        for end, side in ((lower, -1.0), (upper, 1.0)):
            beyond = end + side * 1e-10 * np.linalg.norm(np.subtract(*space.bounds))
            assert not space.base.contains(space.preimage(x + beyond * u))
        n_checked += 1
    assert n_checked == 40


def test_a_line_that_touches_the_hollow_stops_there():
    """The hollow of x^2 + (y - x^2)^2 < 1 is deepest at (0, 1), where y = 1 touches it."""
    space = ShearedSpace(BallSpace((0.0, 0.0), 1.0), 1.0)
    assert not space.contains((0.0, 1.0))
    assert space.contains((0.5, 1.0)) and space.contains((-0.5, 1.0))
    assert space.chord((0.5, 1.0), (-1.0, 0.0)).upper == pytest.approx(0.5, abs=1e-12)
    assert not space.is_motion_valid((0.5, 1.0), (-0.5, 1.0))
    assert space.is_motion_valid((0.5, 0.999), (-0.5, 0.999))
    # From wherever, at whichever angle of the page.
    for start in np.linspace(0.01, 0.9, 50):
        assert space.chord((start, 1.0), (-1.0, 0.0)).upper == pytest.approx(start, abs=1e-7)
    # A line above leaves, and comes in again on the other side.
    assert space.chord((0.5, 1.01), (-1.0, 0.0)).upper < 0.5


def test_lines_straight_up_are_those_of_the_base():
    space = ShearedSpace(BallSpace((0.0, 0.0), 1.0), 2.0)
    chord = space.chord((0.6, 0.72), (0.0, 1.0))
    assert chord == pytest.approx((-0.8, 0.8))


@pytest.mark.parametrize(
    ('roots', 'first', 'expected'),
    [
        ([1.0, 2.0, 3.0, 4.0], 0.0, 1.0),
        ([1.0, 2.0, 3.0, 4.0], 2.5, 3.0),
        ([2.0, 2.0, 3.0, 4.0], 0.0, 2.0),
        ([1.0, 1.0, 1.0, 7.0], 0.0, 1.0),
        ([-1.0, 1e-12], 0.0, 1e-12),
        ([1e-12, 1e6], 0.5, 1e6),
        ([5.0], 0.0, 5.0),
        ([-3.0, -2.0, -1.0], 0.0, np.inf),
    ],
)
def test_changes_of_sign_are_found_in_order(roots, first, expected):
    coefficients = np.polynomial.polynomial.polyfromroots(roots)
    is_in = bool(np.polynomial.polynomial.polyval(first, coefficients) < 0.0)
    for sign, closed in ((1.0, not is_in), (-1.0, is_in)):
        found = next_change(sign * coefficients, first, 1e7, closed, 1e-12)
        assert found == pytest.approx(expected, rel=1e-4, abs=1e-15)


@pytest.mark.parametrize(
    ('base', 'bend', 'reason'),
    [
        (
            ShearedSpace(BallSpace((0.0, 0.0), 1.0), 1.0),
            1.0,
            'a BallSpace or a BoxSpace, got S',
        ),
        (BallSpace([0.0], 1.0), 1.0, 'two dimensions at least'),
        (BallSpace((0.0, 0.0), 1.0), np.nan, 'bend must be finite, got nan'),
        (BallSpace((0.0, 0.0), 1.0), 'much', "bend must be a number, got 'much'"),
        (
            BallSpace((0.0, 0.0), 1.0),
            1e5,
            'by no more than 10000, but 100000.0 stretches it by 2',
        ),
        (
            BallSpace((0.0, 0.0), 10.0),
            1e308,
            'by no more than 10000, but 1e.308 stretches',
        ),
    ],
)
def test_what_is_no_image_is_refused_with_the_reason(base, bend, reason):
    with pytest.raises(SpaceError, match=reason):
        ShearedSpace(base, bend)


def test_why_a_point_is_not_free():
    space = ShearedSpace(BallSpace((0.0, 0.0), 1.0), 1.0)
    assert space.why_not_free((0.0, 2.0)) == (
        'mapped back, 2 away from the centre of a ball of radius 1'
    )
