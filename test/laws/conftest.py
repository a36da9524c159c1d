"""What the laws of spaces share: one of each kind, and where draws come from."""

from test.laws.spaces import SPACES

import numpy as np
import pytest


@pytest.fixture(scope='module', params=SPACES)
def space(request):
    return SPACES[request.param]()


@pytest.fixture
def rng():
    return np.random.default_rng(20160823)
