"""Draws go to arviz in one call, and mean the same there."""

from test.core.sampling.diagnostics.chains import autoregressive

from hnr_planner.core import diagnose, RequestError, to_arviz
import numpy as np
import pytest


def test_arviz_takes_the_draws_and_gives_our_figures(arviz):
    draws = autoregressive(0.5, 4, 300, 2, seed=0)
    data = to_arviz(draws)
    assert data['x'].dims[:2] == ('chain', 'draw')
    np.testing.assert_array_equal(data['x'], draws)
    ours = diagnose(draws)
    np.testing.assert_allclose(arviz.rhat(data)['x'], ours.r_hat)
    np.testing.assert_allclose(arviz.ess(data)['x'], ours.ess_bulk)
    assert len(arviz.summary(data)) == 2


def test_what_is_no_draws_is_refused():
    with pytest.raises(RequestError, match='draws must have shape'):
        to_arviz(np.zeros((3, 3)))
