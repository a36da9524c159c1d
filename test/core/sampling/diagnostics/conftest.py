"""What takes long to import, for the tests that compare with it."""

from types import ModuleType

import pytest


@pytest.fixture(scope='session')
def arviz() -> ModuleType:
    """Return arviz, which workers that run none of these tests do not import."""
    import arviz

    return arviz
