"""Polytopes with equations, given or implied: their plane, their draws, and why others fail."""

import pickle

from hnr_planner.core import (
    BallWalk,
    Chord,
    plan,
    PolytopeSpace,
    RequestError,
    sample,
    SpaceError,
    UnionSpace,
)
import numpy as np
import pytest
from scipy import sparse
from scipy.optimize import Bounds, LinearConstraint

SIMPLEX = np.vstack([-np.eye(3), np.ones(3)])
RIGHT = np.array([0.0, 0.0, 0.0, 1.0])


def birkhoff(k: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the equations of the doubly stochastic matrices (k, k): one follows from others."""
    sums = [np.kron(np.eye(k), np.ones(k)), np.kron(np.ones(k), np.eye(k))]
    return np.vstack(sums), np.ones(2 * k)


def assert_on_plane(draws: np.ndarray, a_eq: np.ndarray, b_eq: np.ndarray) -> None:
    error = np.abs(draws @ a_eq.T - b_eq)
    assert (error <= 1e-9 * (np.abs(draws) @ np.abs(a_eq).T + np.abs(b_eq))).all()


@pytest.mark.parametrize('form', [np.asarray, sparse.csr_array], ids=['dense', 'sparse'])
def test_draws_satisfy_equations_and_inequalities_in_the_callers_coordinates(form):
    a_eq, b_eq = birkhoff(4)
    space = PolytopeSpace(a_eq=form(a_eq), b_eq=b_eq, lower=0.0)
    assert repr(space) == 'PolytopeSpace(dim=16, inequalities=16, equations=7)'
    (draws,) = sample(space, np.full(16, 0.25), 300, thin=5, seed=1)
    assert_on_plane(draws, a_eq, b_eq)
    assert (draws > 0.0).all()
    assert space.contains(draws).all()
    np.testing.assert_allclose(space.bounds, [np.zeros(16), np.ones(16)], atol=1e-9)
    again = pickle.loads(pickle.dumps(space))
    np.testing.assert_array_equal(sample(again, np.full(16, 0.25), 300, thin=5, seed=1)[0], draws)


def test_equations_that_inequalities_imply_are_found():
    space = PolytopeSpace(np.vstack([SIMPLEX, -np.ones(3)]), [*RIGHT, -1.0])
    assert repr(space) == 'PolytopeSpace(dim=3, inequalities=3, equations=1)'
    (draws,) = sample(space, space.centre, 200, seed=1)
    np.testing.assert_allclose(draws.sum(axis=1), 1.0, rtol=1e-12)
    # A chain of them: x0 <= 0 leads to x1 <= 0 in the plane x0 = 0, and that to x2 <= 0.
    lower = np.zeros(4)
    rows = [[1, 0, 0, 0], [-1, 1, 0, 0], [0, -1, 1, 0]]
    space = PolytopeSpace(rows, np.zeros(3), lower=lower, upper=1.0)
    assert space.kernel_dim == 1
    np.testing.assert_allclose(space.bounds, [np.zeros(4), [0, 0, 0, 1]], atol=1e-12)


def test_equal_bounds_are_an_equation():
    space = PolytopeSpace(lower=[0, 2, -1], upper=[1, 2, 1])
    (draws,) = sample(space, (0.5, 2.0, 0.0), 50, seed=1)
    assert (draws[:, 1] == 2.0).all()
    assert np.ptp(draws, axis=0)[[0, 2]].min() > 0.5


@pytest.mark.interpreted
def test_points_directions_and_motions_off_the_plane_are_not_free():
    space = PolytopeSpace(a_eq=[[1.0, 1.0, 1.0]], b_eq=1.0, lower=0.0)
    x = np.full(3, 1 / 3)
    assert space.contains([x, x + 1e-6, x + 1e-15]).tolist() == [True, False, True]
    np.testing.assert_allclose(space.chord(x, (1, -1, 0)), (-1 / 3, 1 / 3), rtol=1e-9)
    np.testing.assert_allclose(space.chord(x, (20, -20, 0)), (-1 / 60, 1 / 60), rtol=1e-9)
    assert space.chord(x + 1e-3, (1, -1, 0)) == Chord(0.0, 0.0)
    with pytest.raises(RequestError, match='must lie in the plane of the equations'):
        space.chord(x, (1, 0, 0))
    assert space.is_motion_valid(x, x + (0.3, -0.3, 0))
    assert not space.is_motion_valid(x, x + (0.3, -0.2, 0))
    assert space.first_blocked_segment([x, x + (0.1, -0.1, 0), x + (0.1, 0, 0)]) == 1
    assert 'does not satisfy the equations' in space.why_not_free(x + 1e-3)
    assert 'beyond the plane of lower[1]' in space.why_not_free((0.5, -0.5, 1.0))
    with pytest.raises(RequestError, match='is outside the polytope: it does not satisfy'):
        sample(space, x + 1e-3, 1)


def test_what_needs_an_inside_refuses_a_flat_polytope():
    space = PolytopeSpace(a_eq=[[1.0, 1.0, 1.0]], b_eq=1.0, lower=0.0)
    with pytest.raises(RequestError, match='do not keep lengths'):
        plan(space, (0.5, 0.25, 0.25), (0.25, 0.5, 0.25), max_iterations=1)
    with pytest.raises(SpaceError, match='must have an inside in its 3 dimensions'):
        UnionSpace(space, space)
    with pytest.raises(RequestError, match='a radius has no meaning'):
        sample(space, space.centre, 1, walk=BallWalk(0.1))


@pytest.mark.parametrize('decades', [6, 18])
def test_a_thin_simplex_in_a_plane_is_sampled(decades: int):
    """
    Mean of each coordinate over its length: 1 / (dim + 1), of a Beta(1, dim) law.

    4,000 draws, 10 dim steps apart: nearly independent. A mean is off by 6 of its standard errors
    once in 5e8 times.
    """
    dim, n = 8, 4000
    lengths = np.append(10.0 ** np.linspace(-decades / 2, decades / 2, dim), 1.0)
    space = PolytopeSpace(a_eq=[1.0 / lengths], b_eq=[1.0], lower=0.0)
    walk = {'walk': 'coordinate_hit_and_run', 'thin': 10 * dim, 'burn_in': 1000}
    (draws,) = sample(space, space.centre, n, seed=4, **walk)
    assert_on_plane(draws, 1.0 / lengths[None], np.ones(1))
    assert (draws > 0.0).all()
    mean, spread = 1.0 / (dim + 1), np.sqrt(dim / (dim + 1) ** 2 / (dim + 2))
    np.testing.assert_allclose((draws / lengths).mean(axis=0), mean, atol=6 * spread / n**0.5)


def test_constraints_of_scipy_give_the_same_polytope():
    ours = PolytopeSpace(SIMPLEX[3:], [1.0], a_eq=[[1.0, -1.0, 0.0]], b_eq=[0.1], lower=0.0)
    rows = np.array([[1.0, 1.0, 1.0], [1.0, -1.0, 0.0]])
    theirs = PolytopeSpace.from_constraints(
        LinearConstraint(sparse.csr_array(rows), [-np.inf, 0.1], [1.0, 0.1]), Bounds(lb=[0, 0, 0])
    )
    np.testing.assert_allclose(theirs.bounds, ours.bounds, atol=1e-9)
    assert theirs.kernel_dim == ours.kernel_dim == 2
    with pytest.raises(SpaceError, match='must be a LinearConstraint or Bounds: 3'):
        PolytopeSpace.from_constraints(3)


def test_a_model_of_highs_is_given_by_its_matrices():
    highspy = pytest.importorskip('highspy')
    model = highspy.Highs()
    x = model.addVariables(3, lb=0.0, ub=2.0)
    model.addConstr(x[0] + x[1] + x[2] == 1.0)
    model.addConstr(x[0] - x[1] <= 0.25)
    lp = model.getLp()
    shape = lp.num_row_, lp.num_col_
    kind = {highspy.MatrixFormat.kColwise: sparse.csc_array}.get(
        lp.a_matrix_.format_, sparse.csr_array
    )
    rows = kind((lp.a_matrix_.value_, lp.a_matrix_.index_, lp.a_matrix_.start_), shape=shape)
    space = PolytopeSpace.from_constraints(
        LinearConstraint(rows, lp.row_lower_, lp.row_upper_),
        Bounds(lp.col_lower_, lp.col_upper_),
    )
    (draws,) = sample(space, space.centre, 100, seed=1)
    np.testing.assert_allclose(draws.sum(axis=1), 1.0, rtol=1e-12)
    assert (draws[:, 0] - draws[:, 1]).max() < 0.25


@pytest.mark.parametrize(
    ('constraints', 'reason'),
    [
        ({}, 'needs a matrix a or a_eq, or bounds'),
        ({'a': [[1.0]]}, 'a and b must be given together'),
        (
            {'a_eq': np.eye(2), 'b_eq': [0, 0], 'lower': -1, 'upper': 1},
            'equations leave one point',
        ),
        ({'lower': [0, 0], 'upper': [1, -1]}, r'lower\[1\] is 0 and upper\[1\] is -1'),
        ({'lower': [0, 0], 'upper': [1, np.nan]}, 'upper must be numbers, and has a nan'),
        ({'lower': [0, 0]}, 'must be bounded'),
        ({'a_eq': [[1, 1]], 'b_eq': 1}, 'must be bounded, but no row'),
        ({'a_eq': [[1, 1, 0]], 'b_eq': 1, 'lower': 0, 'upper': [1, 1, np.inf]}, 'unlimited'),
        ({'a_eq': [[1, 1], [2, 2]], 'b_eq': [1, 3], 'lower': 0}, 'no point holds all of its eq'),
        ({'a_eq': [[1, 1]], 'b_eq': -1, 'lower': 0}, r'lower\[0\], lower\[1\] exclude each other'),
        ({'a_eq': [[0, 0]], 'b_eq': 1, 'lower': 0, 'upper': 1}, 'row 0 of a_eq says 0 = 1'),
        ({'a_eq': [[1, 1]], 'b_eq': np.inf, 'lower': 0}, 'b_eq must be finite'),
        ({'a_eq': [[1, 0, 0]], 'b_eq': 3, 'lower': 0, 'upper': 1}, r'exclude upper\[0\]'),
        ({'a': np.ones((1, 3)), 'b': 1, 'lower': [0, 0]}, r'lower must have shape \(3,\)'),
    ],
)
def test_what_is_no_polytope_is_refused_for_the_true_reason(constraints, reason):
    with pytest.raises(SpaceError, match=reason):
        PolytopeSpace(**constraints)


def test_rows_that_the_equations_imply_do_not_count():
    """One row is parallel to the plane and inactive, one follows from the equation."""
    a_eq = [[1.0, 1.0, 1.0]]
    rows = [[1.0, 1.0, 1.0], [2.0, 2.0, 2.0]]
    space = PolytopeSpace(rows, [5.0, 2.0], a_eq=a_eq, b_eq=[1.0], lower=0.0)
    assert repr(space) == 'PolytopeSpace(dim=3, inequalities=3, equations=1)'
