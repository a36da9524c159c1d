"""Annealing finds minima of functions on sets that are not convex."""

from test.sweeps import sweep

from hnr_planner.core import anneal, BallSpace, BoxSpace, DifferenceSpace, RequestError
from numba import njit
import numpy as np
import pytest

SPACE = DifferenceSpace(BoxSpace((-2.0, -2.0), (2.0, 2.0)), BallSpace((1.0, 1.0), 0.6))


@njit
def _wavy(x):
    """Return a function with many minima, the lowest of a value below -1.9 near (-1.5, -1.5)."""
    bowl = 0.1 * ((x[0] + 1.5) ** 2 + (x[1] + 1.5) ** 2)
    return bowl - np.cos(4.0 * (x[0] + 1.5)) - np.cos(4.0 * (x[1] + 1.5))


@pytest.mark.parametrize('objective', [sweep(_wavy), _wavy.py_func], ids=['compiled', 'Python'])
def test_the_lowest_of_many_minima_is_found(objective):
    best = anneal(SPACE, objective, (1.9, 1.9), n_steps=6000, seed=1)
    np.testing.assert_allclose(best.point, (-1.5, -1.5), atol=0.01)
    assert best.value == objective(best.point) < -1.999
    again = anneal(SPACE, objective, (1.9, 1.9), n_steps=6000, seed=1)
    np.testing.assert_array_equal(again.point, best.point)


def test_a_minimum_on_the_boundary_of_a_hole_is_approached():
    """The nearest free point to the middle of the hole is on its rim."""
    best = anneal(
        SPACE,
        lambda x: np.hypot(x[0] - 1.0, x[1] - 1.05),
        (-1.0, 0.0),
        n_steps=6000,
        n_chains=2,
        seed=2,
    )
    assert SPACE.contains(best.point)
    assert 0.55 < best.value < 0.551


@pytest.mark.parametrize(
    ('arguments', 'reason'),
    [
        ({'objective': 1}, 'objective must be a function'),
        ({'objective': lambda x: np.nan}, 'objective must be a finite number'),
        ({'start': (1.0, 1.0)}, 'start .* is '),
        ({'n_steps': 0}, 'n_steps must be at least 1'),
        ({'temperature': 0.0}, 'temperature must be above 0'),
    ],
)
def test_malformed_arguments_are_refused(arguments, reason):
    given = {'objective': _wavy, 'start': (0.0, 0.0), 'n_steps': 10, **arguments}
    with pytest.raises(RequestError, match=reason):
        anneal(SPACE, given.pop('objective'), given.pop('start'), seed=1, **given)
