"""
Hit-and-Run keeps the densities that it is given, in convex sets and in others.

Each statistical test moves N points of the exact density by STEPS steps with a fixed seed, and
compares p-values of marginals with ALPHA: with fresh seeds, one run in a hundred thousand would
fail. Walks for other densities, which are the mutants, must fail the same test.
"""

import pickle
from test.core.sampling.chain_steps import step_of
from test.sweeps import sweep

from hnr_planner.core import (
    BallSpace,
    BoxSpace,
    CoordinateHitAndRunWalk,
    diagnose,
    DifferenceSpace,
    Exponential,
    Gaussian,
    HitAndRunWalk,
    OracleError,
    PolytopeSpace,
    RequestError,
    round_space,
    sample,
)
from hnr_planner.core.kernels.kernel import interpreted
from hnr_planner.core.kernels.streams import stream
from hnr_planner.core.sampling.chain import new_chain, take_steps
from numba import njit
import numpy as np
import pytest
from scipy import stats

N, STEPS, ALPHA = 20_000, 8, 1e-7
REACH = 8.0


@njit
def _standard_normal(x):
    return -0.5 * np.sum(x * x)


@njit
def _narrower(x):
    return -0.7 * np.sum(x * x)


def cone() -> PolytopeSpace:
    """Return the sector |y| < x of the plane, cut off where a normal density is 1e-14."""
    return PolytopeSpace([[-1.0, 1.0], [-1.0, -1.0], [1.0, 0.0]], [0.0, 0.0, REACH])


def p_values_in_cone(points: np.ndarray) -> list[float]:
    """Return p-values of angle and radius: uniform, and Rayleigh's law."""
    angles = np.arctan2(points[:, 1], points[:, 0]) / (np.pi / 2.0) + 0.5
    radii = np.linalg.norm(points, axis=1)
    return [
        float(stats.kstest(angles, 'uniform').pvalue),
        float(stats.kstest(radii, stats.rayleigh.cdf).pvalue),
    ]


def normal_points_in_cone(rng: np.random.Generator) -> np.ndarray:
    angles, radii = (
        rng.uniform(-np.pi / 4, np.pi / 4, N),
        stats.rayleigh.rvs(size=N, random_state=rng),
    )
    return radii[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)


@pytest.mark.parametrize(
    ('density', 'is_right'),
    [
        (Gaussian((0.0, 0.0), np.eye(2)), True),
        (Gaussian((0.0, 0.0), 0.9 * np.eye(2)), False),
        (Gaussian((0.1, 0.0), np.eye(2)), False),
        (_standard_normal, True),
        sweep(_narrower, False),
        sweep(Exponential((1.0, 0.0)), False),
        sweep(None, False),
    ],
)
def test_a_normal_density_in_a_cone_is_kept(density, is_right):
    space, rng = cone(), np.random.default_rng(1)
    moved = step_of(HitAndRunWalk(density), space, STEPS)(normal_points_in_cone(rng), rng)
    assert space.contains(moved).all()
    assert (min(p_values_in_cone(moved)) > ALPHA) == is_right


@pytest.mark.sweep
def test_a_normal_density_is_kept_in_rounded_coordinates():
    space, rng = round_space(cone(), seed=1), np.random.default_rng(2)
    walk = HitAndRunWalk(Gaussian((0.0, 0.0), np.eye(2)))
    moved = step_of(walk, space, STEPS)(normal_points_in_cone(rng), rng)
    assert min(p_values_in_cone(moved)) > ALPHA


def box_without_balls() -> DifferenceSpace:
    balls = BallSpace((0.3, 0.2, 0.0), 0.5), BallSpace((-0.6, -0.4, 0.3), 0.4)
    return DifferenceSpace(BoxSpace(np.full(3, -1.0), np.full(3, 1.5)), *balls)


@pytest.mark.parametrize(
    ('density', 'is_right'),
    [(_standard_normal, True), sweep(_narrower, False)],
)
def test_a_normal_density_in_a_box_without_balls_is_kept(density, is_right):
    """Marginals against as many exact points: normal ones that are free."""
    space, rng = box_without_balls(), np.random.default_rng(3)
    exact = rng.standard_normal((12 * N, 3))
    exact = exact[space.contains(exact)]
    assert len(exact) > 2 * N
    start, others = exact[:N], exact[N:][:N]
    moved = step_of(HitAndRunWalk(density), space, 2 * STEPS)(start, rng)
    assert space.contains(moved).all()
    found = min(stats.ks_2samp(moved[:, i], others[:, i]).pvalue for i in range(3))
    squares = (np.sum(points**2, axis=1) for points in (moved, others))
    assert (min(found, stats.ks_2samp(*squares).pvalue) > ALPHA) == is_right


@pytest.mark.parametrize(('rate', 'is_right'), [(2.0, True), (2.2, False)])
def test_an_exponential_density_in_a_box_is_kept(rate, is_right):
    """Each coordinate has the exponential law cut off at 1."""
    space, rng = PolytopeSpace(lower=np.zeros(2), upper=1.0), np.random.default_rng(4)
    law = stats.truncexpon(b=2.0, scale=0.5)
    exact = law.rvs((N, 2), random_state=rng)
    moved = step_of(HitAndRunWalk(Exponential((rate, rate))), space, STEPS)(exact, rng)
    found = min(stats.kstest(moved[:, i], law.cdf).pvalue for i in range(2))
    assert (found > ALPHA) == is_right


def test_a_density_in_the_plane_of_equations_is_that_of_the_points():
    """Normal points of x + y + z = 1: the law of x - y there is normal, with deviation sqrt(2)."""
    space = PolytopeSpace(a_eq=[[1.0, 1.0, 1.0]], b_eq=1.0, lower=-9.0, upper=9.0)
    rng = np.random.default_rng(5)
    exact = rng.standard_normal((N, 3))
    exact += (1.0 - exact.sum(axis=1, keepdims=True)) / 3.0
    walk = HitAndRunWalk(Gaussian(np.zeros(3), np.eye(3)))
    moved = step_of(walk, space, STEPS)(exact[(np.abs(exact) < 9.0).all(axis=1)], rng)
    assert stats.kstest((moved[:, 0] - moved[:, 1]) / 2**0.5, 'norm').pvalue > ALPHA
    assert stats.kstest((moved[:, 0] - 1 / 3) / (2 / 3) ** 0.5, 'norm').pvalue > ALPHA


@pytest.mark.interpreted
def test_a_function_in_python_gives_the_draws_of_a_compiled_one():
    space = cone()
    compiled = sample(space, (1.0, 0.0), 50, walk=HitAndRunWalk(_standard_normal), seed=1)
    walk = HitAndRunWalk(_standard_normal.py_func)
    np.testing.assert_allclose(sample(space, (1.0, 0.0), 50, walk=walk, seed=1), compiled)
    again = pickle.loads(pickle.dumps(HitAndRunWalk(_standard_normal)))
    np.testing.assert_array_equal(sample(space, (1.0, 0.0), 50, walk=again, seed=1), compiled)


def _raise(x):
    raise KeyError('no density')


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ('density', 'error', 'reason'),
    [
        (3.0, RequestError, 'log_density must be a function, got 3.0'),
        (lambda x: np.nan, RequestError, 'must be a finite number at a start, but is nan'),
        (lambda x: -np.inf, RequestError, 'must be a finite number at a start, but is -inf'),
        (lambda x: 0.0 if x[0] == 1.0 else np.nan, RequestError, 'is nan or inf at a point'),
        (Gaussian(np.zeros(3), np.eye(3)), RequestError, 'has 3 dimensions, the space has 2'),
        (Exponential([1.0]), RequestError, 'has 1 dimensions, the space has 2'),
    ],
)
def test_what_is_no_density_is_refused(density, error, reason):
    with pytest.raises(error, match=reason):
        sample(cone(), (1.0, 0.0), 5, walk=HitAndRunWalk(density), seed=1)


@pytest.mark.interpreted
def test_an_exception_in_a_density_is_the_cause():
    walk = HitAndRunWalk(lambda x: 0.0 if x[0] == 1.0 else _raise(x))
    with pytest.raises(OracleError) as error:
        sample(cone(), (1.0, 0.0), 5, walk=walk, seed=1)
    assert isinstance(error.value.__cause__, KeyError)


@pytest.mark.parametrize(
    ('mean', 'covariance', 'reason'),
    [
        ((0, 0), np.eye(3), r'must have shape \(2, 2\), got \(3, 3\)'),
        ((0, 0), [[1, 2], [0, 1]], 'must be finite and symmetric'),
        ((0, 0), [[1, 2], [2, 1]], 'positive definite, but has an eigenvalue of -1'),
        ((0, np.nan), np.eye(2), 'mean must be finite'),
    ],
)
def test_what_is_no_normal_distribution_is_refused(mean, covariance, reason):
    with pytest.raises(RequestError, match=reason):
        Gaussian(mean, covariance)


@pytest.mark.sweep
@pytest.mark.parametrize(
    'build',
    [
        lambda: HitAndRunWalk(Gaussian((0.3, 0.1), np.eye(2))),
        lambda: HitAndRunWalk(Exponential((1.0, -0.5))),
        lambda: HitAndRunWalk(_standard_normal),
        lambda: CoordinateHitAndRunWalk(overrelaxed=True),
    ],
    ids=['normal', 'exponential', 'slice', 'overrelaxed'],
)
def test_steps_are_the_same_interpreted_and_compiled(build):
    space, walk = round_space(cone(), seed=1), build()
    draws = np.empty((2, 60, 2))
    for k, steps in enumerate((take_steps, interpreted(take_steps))):
        chain = new_chain(space, np.zeros(2), stream(7))
        steps(space.data, walk.compiled(space), chain, np.zeros(2), 1, draws[k])
    np.testing.assert_array_equal(draws[0], draws[1])
    assert len(np.unique(draws[0], axis=0)) > 50


@pytest.mark.sweep
def test_a_diagnosis_counts_for_densities_too():
    """Chains in two modes of one density do not converge; chains in one mode do."""
    modes = njit(lambda x: -3e4 * min((x[0] - 1.0) ** 2, (x[0] + 1.0) ** 2) - 3e4 * x[1] ** 2)
    space = PolytopeSpace(lower=(-2.0, -2.0), upper=2.0)
    start = [(-1.0, 0.0), (1.0, 0.0), (-1.0, 0.01), (1.0, 0.01)]
    apart = diagnose(sample(space, start, 1500, walk=HitAndRunWalk(modes), thin=3, seed=1))
    assert not apart.converged
    assert apart.separated.any()
    normal = HitAndRunWalk(Gaussian((0.0, 0.0), np.diag((0.3, 0.6))))
    assert diagnose(sample(space, start, 1500, walk=normal, thin=5, seed=1)).converged
