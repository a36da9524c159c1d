"""What the laws of spaces share: one of each kind, and where draws come from."""

from test.laws.spaces import FURTHER, LONG, QUICK, SPACES
from test.sweeps import sweep

import numpy as np
import pytest

#: Those that wait for machine code come last: it is being made while the others are held.
EACH_SPACE = [
    *(
        pytest.param(
            name, marks=[pytest.mark.interpreted, *[pytest.mark.sweep] * (name in FURTHER)]
        )
        for name in QUICK
    ),
    *(sweep(name) if name in FURTHER else name for name in LONG),
]


@pytest.fixture(scope='module', params=EACH_SPACE)
def space(request):
    return SPACES[request.param]()


@pytest.fixture
def rng():
    return np.random.default_rng(20160823)
