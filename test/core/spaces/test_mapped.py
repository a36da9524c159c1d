"""Images of spaces under maps of the user: membership, chords, and why others are refused."""

import pickle

from hnr_planner.core import BallSpace, BoxSpace, diagnose, MappedSpace, sample, SpaceError
from numba import njit
import numpy as np
import pytest
from scipy import stats

TURNS = 2.0


@njit
def twist(x):
    """Turn a point about the third axis by an angle that grows with its height."""
    angle = TURNS * x[2]
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * x[0] - s * x[1], s * x[0] + c * x[1], x[2]])


@njit
def untwist(x):
    angle = -TURNS * x[2]
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * x[0] - s * x[1], s * x[0] + c * x[1], x[2]])


BAR = BoxSpace((-1.0, -0.2, -1.0), (1.0, 0.2, 1.0))


def test_points_and_chords_are_those_of_the_image():
    space = MappedSpace(twist, untwist, BAR)
    rng = np.random.default_rng(1)
    points = rng.uniform(-1.2, 1.2, (300, 3))
    expected = BAR.contains([untwist(x) for x in points])
    np.testing.assert_array_equal(space.contains(points), expected)
    assert 20 < expected.sum() < 280
    for x in points[expected][:20]:
        u = rng.standard_normal(3)
        lower, upper = space.chord(x, u)
        assert lower < 0.0 < upper
        inside = x + np.linspace(lower, upper, 50)[1:-1, None] * u
        assert BAR.contains([untwist(y) for y in inside]).all()
        for end, beyond in ((lower, -1e-6), (upper, 1e-6)):
            assert not BAR.contains(untwist(x + (end + beyond) * u))
    lower, upper = space.bounds
    assert (lower < -1.0).all()
    assert (upper > 1.0).all()


@pytest.mark.sweep
def test_draws_mapped_back_are_uniform_in_the_base():
    """2 x 2,000 draws, 30 steps apart; a p-value below 1e-7 once in 3e6 runs."""
    space = pickle.loads(pickle.dumps(MappedSpace(twist, untwist, BAR, resolution=0.02)))
    draws = sample(space, (0.0, 0.0, 0.0), 2000, n_chains=2, thin=30, seed=1)
    assert diagnose(draws).converged
    back = np.array([untwist(x) for x in draws.reshape(-1, 3)])
    unit = (back - BAR.lower) / (BAR.upper - BAR.lower)
    assert min(stats.kstest(each, 'uniform').pvalue for each in unit.T) > 1e-7


def test_functions_in_python_give_the_same_space():
    compiled = MappedSpace(twist, untwist, BAR, resolution=0.1)
    python = MappedSpace(twist.py_func, untwist.py_func, BAR, resolution=0.1)
    u = (0.3, 0.5, -0.2)
    np.testing.assert_allclose(python.chord((0, 0, 0), u), compiled.chord((0, 0, 0), u))
    assert python.why_not_free((0, 0, 3)).startswith('mapped back, outside the box')


@pytest.mark.parametrize(
    ('function', 'inverse', 'base', 'reason'),
    [
        (1, untwist, BAR, 'function must be a function, got 1'),
        (twist, untwist, 3, 'base must be a space, got 3'),
        (twist, twist, BAR, 'inverse must lead back'),
        (lambda x: 2.0 * x, lambda x: 0.5 * x, BAR, 'must keep volume, but multiplies it by 8'),
        (lambda x: x[:2], untwist, BAR, r'must return finite points \(3,\)'),
        (lambda x: x / 0.0, untwist, BallSpace((0, 0, 0), 1), 'must return finite points'),
    ],
)
@pytest.mark.filterwarnings('ignore:divide by zero')
def test_what_is_no_map_that_keeps_volume_is_refused(function, inverse, base, reason):
    with pytest.raises(SpaceError, match=reason):
        MappedSpace(function, inverse, base)
