"""
Rounded spaces, and the overrelaxed walk that is fast in them, keep the uniform law.

Each statistical test moves N exact points by steps with a fixed seed, and compares p-values with
ALPHA: with fresh seeds, one run in a hundred thousand would fail. The mutants are steps that are
wrong in plausible ways, and fail the same test.
"""

from test.sweeps import sweep
from typing import NamedTuple

from hnr_planner.core import (
    BallSpace,
    BoxSpace,
    CoordinateHitAndRunWalk,
    diagnose,
    DifferenceSpace,
    plan,
    PolytopeSpace,
    RequestError,
    round_space,
    sample,
    Space,
)
from hnr_planner.core.kernels.kernel import inlined
from hnr_planner.core.kernels.streams import stream, uniform
from hnr_planner.core.sampling.chain import new_chain, take_steps
from hnr_planner.core.sampling.steps import STEPS, take_step
from hnr_planner.core.spaces.chain_cache import (
    chord_cached,
    clear_axis,
    count_axes,
    move_along,
    set_axis,
)
import numpy as np
import pytest
from scipy import stats
from scipy.stats import ortho_group

N, N_STEPS, ALPHA = 10_000, 40, 1e-7
FAST = CoordinateHitAndRunWalk(overrelaxed=True)


class MutantStep(NamedTuple):
    """Overrelaxed steps that mirror not quite, or never draw uniformly on the chord."""

    mirror: float
    power: float


@take_step.register(MutantStep)
@inlined
def _mutant(walk, space, cache, u, rng, counts):
    axis = (counts[STEPS] - 1) % count_axes(space, len(u))
    set_axis(space, u, axis)
    lower, upper = chord_cached(space, cache, u, axis)
    s = walk.mirror * (lower + upper)
    if uniform(rng) >= 0.8:
        s = lower + (upper - lower) * uniform(rng) ** walk.power
    moved = lower < s < upper and move_along(space, cache, u, axis, s)
    clear_axis(space, u, axis)
    return moved


def simplex(lengths: np.ndarray, turn: np.ndarray | None = None) -> PolytopeSpace:
    """Return the simplex with these lengths along axes that are turned."""
    turn = np.eye(len(lengths)) if turn is None else turn
    rows = np.vstack([-np.diag(1.0 / lengths), 1.0 / lengths]) @ turn
    return PolytopeSpace(rows, np.append(np.zeros(len(lengths)), 1.0))


def barycentric(dim: int, rng: np.random.Generator) -> np.ndarray:
    """Return uniform points (N, dim) of the standard simplex."""
    return rng.dirichlet(np.ones(dim + 1), N)[:, :dim]


def moved(space: Space, walk: object, points: np.ndarray, seed: int) -> np.ndarray:
    """Return points (n, dim), caller's frame, after ``N_STEPS`` steps from each."""
    compiled = walk if isinstance(walk, MutantStep) else walk.compiled(space)
    ends = space.to_kernel(points)
    u = np.zeros(space.kernel_dim)
    rng = stream(seed)
    for x in ends:
        chain = new_chain(space, x.copy(), rng)
        draws = np.empty((1, len(u)))
        take_steps(space.data, compiled, chain, u, N_STEPS, draws)
        x[:] = draws[0]
    return space.from_kernel(ends)


def p_value(parts: np.ndarray) -> float:
    """Return the least p-value of barycentric coordinates: Beta(1, dim), and of their products."""
    dim = parts.shape[1]
    every = np.column_stack([parts, 1.0 - parts.sum(axis=1)])
    singles = [stats.kstest(each, stats.beta(1, dim).cdf).pvalue for each in every.T]
    sums = every[:, :-1] + every[:, 1:]
    pairs = [stats.kstest(each, stats.beta(2, dim - 1).cdf).pvalue for each in sums.T]
    return float(min(singles + pairs))


LENGTHS = 10.0 ** np.linspace(-4, 4, 20)
TURN = ortho_group.rvs(20, random_state=1)
SETS = {
    'turned and scaled': (lambda: round_space(simplex(LENGTHS, TURN), seed=1), TURN),
    'scaled': (lambda: round_space(simplex(LENGTHS), seed=1), np.eye(20)),
    'as given': (lambda: simplex(LENGTHS), np.eye(20)),
}


RIGHT = {
    'overrelaxed': FAST,
    'uniform axes': CoordinateHitAndRunWalk(),
    'no mutant': MutantStep(mirror=1.0, power=1.0),
}
WRONG = {
    'mirror too near': MutantStep(mirror=0.95, power=1.0),
    'not uniform': MutantStep(mirror=1.0, power=2.0),
}
#: The one set in which ``make test`` has the mutants caught; in the others it has one walk.
DEMONSTRATION = 'turned and scaled'


@pytest.mark.parametrize(
    ('name', 'walk'),
    [
        (name, walk) if name == DEMONSTRATION or walk == 'overrelaxed' else sweep(name, walk)
        for name in SETS
        for walk in RIGHT | WRONG
    ],
)
def test_walks_along_facets_keep_the_uniform_law(name, walk):
    build, turn = SETS[name]
    space, rng = build(), np.random.default_rng(2)
    ends = moved(space, (RIGHT | WRONG)[walk], barycentric(20, rng) * LENGTHS @ turn, seed=3)
    assert space.contains(ends).all()
    assert (p_value(ends @ turn.T / LENGTHS) > ALPHA) == (walk in RIGHT)


@pytest.mark.parametrize('k', [3, 4])
def test_means_and_covariances_of_doubly_stochastic_matrices(k: int):
    """
    Of matrices (k, k): against exact points, by rejection, within 4 standard errors.

    The first k - 1 rows are uniform on simplices; they are kept where the last row is positive.
    With fresh seeds, one of the 13 or 20 numbers would be off by more once in 700 runs.
    """
    a_eq = np.vstack([np.kron(np.eye(k), np.ones(k)), np.kron(np.ones(k), np.eye(k))])
    space = round_space(PolytopeSpace(a_eq=a_eq, b_eq=np.ones(2 * k), lower=0.0), seed=1)
    assert f'equations={2 * k - 1}' in repr(space)
    thin = 2 * (k - 1) ** 2
    draws = sample(space, np.full(k * k, 1 / k), 20_000, n_chains=2, walk=FAST, thin=thin, seed=2)
    assert space.contains(draws.reshape(-1, k * k)).all()
    found = diagnose(draws)
    assert found.converged
    rows = np.random.default_rng(3).dirichlet(np.ones(k), (400_000, k - 1))
    full = np.concatenate([rows, 1.0 - rows.sum(axis=1, keepdims=True)], axis=1)
    exact = full[(full > 0.0).all(axis=(1, 2))].reshape(-1, k * k)
    assert np.abs(draws.mean(axis=(0, 1)) - 1 / k).max() < 4 * found.mcse_mean.max()
    # By symmetry the first number's products with itself, its row, its column and the others.
    products = lambda x: x[..., [0, 0, 0, 0]] * x[..., [0, 1, k, k + 1]]  # noqa: E731
    ours, theirs = products(draws), products(exact)
    error = diagnose(ours).mcse_mean + theirs.std(axis=0) / len(theirs) ** 0.5
    assert (np.abs(ours.mean(axis=(0, 1)) - theirs.mean(axis=0)) < 4 * error).all()


def test_few_draws_do_not_make_round_coordinates_worse():
    """
    Flows in a network like a metabolic one, with limits of many sizes: about 30 dimensions.

    The ellipsoid of the barrier has made it round; the draws of a first phase do not always show
    it, and more of them do, so that no phase changes the coordinates.
    """
    rng = np.random.default_rng(4)
    network = np.zeros((70, 100))
    for j in range(100):
        rows = rng.choice(70, rng.integers(2, 5), replace=False)
        network[rows, j] = rng.choice([-2.0, -1.0, 1.0, 2.0], len(rows))
    limits = 10.0 ** rng.uniform(0.0, 3.0, 100)
    base = PolytopeSpace(a_eq=network, b_eq=np.zeros(70), lower=-limits, upper=limits)
    first, *others = (round_space(base, seed=seed) for seed in range(5))
    assert max(space.rounding.phases for space in others) > 1
    for space in others:
        np.testing.assert_array_equal(space.matrix, first.matrix)


@pytest.mark.sweep
def test_a_set_that_is_not_convex_is_rounded_from_its_draws():
    """A thin slanted box without a ball: 1000 times as long as wide."""
    turn = np.array([[0.8, 0.6], [-0.6, 0.8]])
    rows = np.vstack([np.eye(2), -np.eye(2)]) @ turn
    thin = DifferenceSpace(PolytopeSpace(rows, [10.0, 0.01] * 2), BallSpace((4.0, 3.0), 0.005))
    space = round_space(thin, (0.0, 0.0), seed=1)
    assert space.rounding.ratio < 2.5
    assert space.rounding.phases > 1
    draws = sample(space, (0.0, 0.0), 4000, n_chains=2, thin=10, seed=2)
    assert thin.contains(draws.reshape(-1, 2)).all()
    assert diagnose(draws).converged
    along = draws.reshape(-1, 2) @ turn[0]
    assert abs(along.mean()) < 1.0
    assert np.ptp(along) > 19.5


def test_a_box_keeps_its_axes_and_its_sparse_columns():
    space = round_space(PolytopeSpace(lower=np.zeros(40), upper=np.logspace(0, 3, 40)), seed=1)
    assert len(space.data.axes) == 0
    assert np.count_nonzero(space.data.normals) == 80


def test_rounded_spaces_report_and_refuse():
    base = simplex(np.ones(3))
    space = round_space(base, seed=1)
    assert space.rounding.steps > 0
    assert space.rounding.seconds > 0.0
    assert repr(space) == 'RoundedSpace(base=PolytopeSpace(dim=3, inequalities=4))'
    np.testing.assert_array_equal(space.bounds, base.bounds)
    assert space.chord((0.2, 0.2, 0.2), (1, 0, 0)) == base.chord((0.2, 0.2, 0.2), (1, 0, 0))
    np.testing.assert_allclose(space.from_kernel(space.to_kernel(base.centre)), base.centre)
    with pytest.raises(RequestError, match='do not keep lengths'):
        plan(space, (0.1, 0.1, 0.1), (0.3, 0.3, 0.3), max_iterations=1)
    with pytest.raises(RequestError, match='start must be given for a BoxSpace'):
        round_space(BoxSpace((0.0, 0.0), (1.0, 1.0)))
    with pytest.raises(RequestError, match=r'start \[2.0, 0.0\] is outside the box'):
        round_space(BoxSpace((0.0, 0.0), (1.0, 1.0)), (2.0, 0.0))
