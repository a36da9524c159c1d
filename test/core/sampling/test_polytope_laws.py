"""
Walks in polytopes, which carry distances along, keep the law of one step and of many.

Each statistical test here draws N points with a fixed seed and compares a p-value with 1e-7: with
fresh seeds, one run in a hundred thousand would fail.
"""

from test.core.sampling.chain_steps import step_of
from test.core.sampling.test_chains import polytope, simplex
from test.sweeps import sweep_but

from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import stream
from hnr_planner.core.sampling.chain import new_chain
from hnr_planner.core.sampling.steps import take_step
from hnr_planner.core.sampling.walks import make_walk
from hnr_planner.core.spaces.chain_cache import open_cache, refresh
import numpy as np
import pytest
from scipy import stats

N, ALPHA = 100_000, 1e-7
SPACES = {'sparse': simplex(5), 'dense': polytope(60, 4)}
EACH_SPACE = pytest.mark.parametrize('space', SPACES.values(), ids=SPACES)
WALKS = ('hit_and_run', 'coordinate_hit_and_run', 'ball_walk')


@EACH_SPACE
@pytest.mark.parametrize('walk', ['hit_and_run', 'coordinate_hit_and_run'])
def test_a_step_is_uniform_over_directions_and_on_the_chord(space, walk: str):
    """Directions by the law Beta(1/2, (n - 1)/2) of a squared component; chords from the rows."""
    x = 0.6 * space.centre + 0.4 * (space.centre + 0.9 * space.inner_radius * np.eye(space.dim)[0])
    moved = step_of(walk, space)(np.tile(x, (N, 1)), np.random.default_rng(3))
    lengths = np.linalg.norm(moved - x, axis=1)
    u = (moved - x) / lengths[:, None]
    with np.errstate(divide='ignore'):
        ends = (space.data.offsets - space.data.normals @ x) / (u @ space.data.normals.T)
    upper = np.where(ends > 0, ends, np.inf).min(axis=1)
    lower = np.where(ends < 0, ends, -np.inf).max(axis=1)
    position = np.where(u[:, 0] > 0, lengths - lower, upper - lengths) / (upper - lower)
    if walk == 'hit_and_run':
        for k in range(3):
            law = stats.beta(0.5, 0.5 * (space.dim - 1))
            assert stats.kstest(u[:, k] ** 2, law.cdf).pvalue > ALPHA
        assert stats.kstest(position, 'uniform').pvalue > ALPHA
        assert stats.kstest(position**1.05, 'uniform').pvalue < ALPHA  # a mutant
    else:
        axes = np.abs(u).argmax(axis=1)
        np.testing.assert_allclose(np.abs(u).max(axis=1), 1.0, atol=1e-12)
        assert stats.chisquare(np.bincount(axes, minlength=space.dim)).pvalue > ALPHA


def uniform_points(dim: int, rng: np.random.Generator) -> np.ndarray:
    return rng.dirichlet(np.ones(dim + 1), N)[:, :dim]


def p_values(points: np.ndarray) -> list[float]:
    """Return p-values of every coordinate, and of what is left of the sum, Beta(1, n)."""
    law = stats.beta(1, points.shape[1])
    left = 1.0 - points.sum(axis=1)
    return [float(stats.kstest(each, law.cdf).pvalue) for each in (*points.T, left)]


@pytest.mark.parametrize('walk', sweep_but(WALKS[:2], WALKS))
def test_steps_keep_the_uniform_law(walk: str):
    """Ten steps, each from the distances that the one before left."""
    space, rng = SPACES['sparse'], np.random.default_rng(4)
    moved = step_of(walk, space, n_steps=10)(uniform_points(space.dim, rng), rng)
    assert space.contains(moved).all()
    assert min(p_values(moved)) > ALPHA


@kernel
def _step_from_half_of_memory(space, walk, points, chain, u):
    for k in range(len(points)):
        cache = open_cache(space, points[k], chain.memory)
        refresh(space, cache)
        cache.slacks[0] *= 0.5
        take_step(walk, space, cache, u, chain.rng, chain.counts)


@pytest.mark.sweep
def test_one_wrong_distance_is_caught():
    """Show that the test above can fail: a plane that seems half as far away as it is."""
    space, rng = SPACES['sparse'], np.random.default_rng(5)
    points = uniform_points(space.dim, rng)
    chain = new_chain(space, points[0].copy(), stream(6))
    walk = make_walk('hit_and_run').compiled(space)
    _step_from_half_of_memory(space.data, walk, points, chain, np.zeros(space.dim))
    assert min(p_values(points)) < ALPHA
