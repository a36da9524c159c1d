"""Polytopes from inequalities as people write them, thin ones, and why others are refused."""

from test.sweeps import sweep

from hnr_planner.core import PolytopeSpace, sample, SpaceError
import numpy as np
import pytest
from scipy import sparse

SIMPLEX = np.vstack([-np.eye(3), np.ones(3)])
RIGHT = np.array([0.0, 0.0, 0.0, 1.0])
BOX = np.vstack([np.eye(2), -np.eye(2)])


def thin_simplex(dim: int, decades: int) -> tuple[PolytopeSpace, np.ndarray]:
    """Return a simplex at the origin whose axes differ by so many decades, and their lengths."""
    scales = 10.0 ** np.linspace(-decades / 2, decades / 2, dim)
    normals = np.vstack([-np.eye(dim), 1.0 / scales])
    return PolytopeSpace(normals, np.append(np.zeros(dim), 1.0)), scales


@pytest.mark.parametrize(
    ('a', 'b'),
    [
        (sparse.csr_matrix(SIMPLEX), RIGHT),
        (sparse.coo_array(SIMPLEX), RIGHT.tolist()),
        (np.vstack([np.zeros(3), SIMPLEX]), [1.0, *RIGHT]),
        (np.vstack([SIMPLEX[:2], np.ones(3), SIMPLEX[2:]]), [0.0, 0.0, np.inf, 0.0, 1.0]),
        (SIMPLEX * 1e-200, RIGHT * 1e-200),
    ],
    ids=['sparse matrix', 'sparse array', 'row of zeros', 'no limit', 'tiny rows'],
)
def test_inequalities_as_people_write_them_give_the_same_polytope(a, b):
    space, expected = PolytopeSpace(a, b), PolytopeSpace(SIMPLEX, RIGHT)
    assert repr(space) == 'PolytopeSpace(dim=3, inequalities=4)'
    np.testing.assert_allclose(space.bounds, expected.bounds, atol=1e-12)
    points = np.random.default_rng(1).uniform(-0.1, 1.0, (200, 3))
    np.testing.assert_array_equal(space.contains(points), expected.contains(points))


@pytest.mark.parametrize('nothing', [[], np.empty((0, 3)), sparse.csr_array((0, 3))])
def test_no_rows_are_no_constraint(nothing):
    sides = {'lower': np.zeros(3), 'upper': 1.0}
    expected = repr(PolytopeSpace(**sides))
    assert repr(PolytopeSpace(a_eq=nothing, b_eq=[], **sides)) == expected
    assert repr(PolytopeSpace(nothing, [], **sides)) == expected


def test_a_row_is_named_as_the_caller_counts_it():
    space = PolytopeSpace(np.vstack([np.zeros(3), SIMPLEX]), [1.0, *RIGHT])
    assert space.why_not_free((0.2, -0.5, 0.2)).endswith('0.5 beyond the plane of row 2 of a')


@pytest.mark.parametrize(
    ('a', 'b', 'reason'),
    [
        (BOX, [1.0, 1.0, -1.5, 0.0], 'no point holds all of a x <= b: rows 0, 2 of a'),
        (np.vstack([BOX, np.zeros(2)]), [1, 1, 1, 1, 0], 'row 4 says 0 < 0, which no point holds'),
        (BOX, [1.0, 1.0, -np.inf, 0.0], r'row 2 says a\[2\] x < -inf, which no point holds'),
        (BOX, [1.0, 1.0, np.inf, 0.0], 'must be bounded, but a x < b leaves a direc'),
        (BOX[[0, 2]], [1.0, 1.0], 'must be bounded, but a x < b leaves a direc'),
        (BOX, [np.inf] * 4, 'must be bounded, but no row of a bounds anything'),
        (BOX, [1.0, 1.0, np.nan, 0.0], r'b\[2\] is nan'),
        (BOX * np.nan, [1.0] * 4, 'a must be finite'),
        (BOX, [1.0], r'a must have shape \(1, dim\) as b has, got \(4, 2\)'),
        ('a', [1.0], "a must be numbers, got 'a'"),
    ],
)
def test_what_is_no_polytope_is_refused_for_the_true_reason(a, b, reason):
    with pytest.raises(SpaceError, match=reason):
        PolytopeSpace(a, b)


@pytest.mark.parametrize(('dim', 'decades'), [(2, 8), (2, 12), sweep(20, 10)])
def test_a_simplex_with_axes_of_very_different_lengths_is_sampled(dim: int, decades: int):
    """
    Mean of the coordinates over their lengths: 1 / (dim + 1), each with a Beta(1, dim) law.

    5,000 draws, 10 dim steps apart: nearly independent. A mean is off by 6 of its standard errors
    once in 5e8 times.
    """
    space, scales = thin_simplex(dim, decades)
    np.testing.assert_allclose(space.bounds[1], scales, rtol=1e-6)
    (draws,) = sample(
        space,
        space.centre,
        5000,
        walk='coordinate_hit_and_run',
        thin=10 * dim,
        burn_in=1000,
        seed=4,
    )
    mean, spread = 1.0 / (dim + 1), np.sqrt(dim / (dim + 1) ** 2 / (dim + 2))
    np.testing.assert_allclose((draws / scales).mean(axis=0), mean, atol=6 * spread / 5000**0.5)


def test_a_polytope_thinner_than_rounding_is_refused_with_what_helps():
    turned = BOX @ np.array([[0.8, -0.6], [0.6, 0.8]])
    assert PolytopeSpace(turned, [1.0, 1e-8, 0.0, 0.0]).inner_radius == pytest.approx(5e-9)
    with pytest.raises(SpaceError, match=r'too thin.* turn and scale the coordinates'):
        PolytopeSpace(turned, [1.0, 1e-11, 0.0, 0.0])


def test_bounds_are_computed_only_when_they_are_used():
    rng = np.random.default_rng(2)
    space = PolytopeSpace(rng.standard_normal((120, 30)), rng.uniform(1.0, 2.0, 120))
    (draws,) = sample(space, space.centre, 50, seed=1)
    assert 'kernel_bounds' not in vars(space)
    lower, upper = space.bounds
    assert 'kernel_bounds' in vars(space)
    assert ((draws > lower) & (draws < upper)).all()
    # The bounds touch the polytope: a point just beyond one violates an inequality.
    assert (lower < space.centre).all() and (space.centre < upper).all()
    for i in range(30):
        beyond = np.where(np.arange(30) == i, upper + 1e-6, space.centre)
        assert not space.contains(beyond)
