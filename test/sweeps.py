"""Parameters of tests that belong to the sweeps: further cases of what `make test` has already."""

from collections.abc import Collection, Iterable
import os
from typing import Any

import pytest

#: Whether all tests run as machine code, on full inputs, as `make compiled` runs them.
IN_FULL = bool(os.environ.get('HNR_COMPILE_ALL'))


def sweep(*values: Any, name: str | None = None) -> Any:
    """Return a parameter that belongs to the sweeps."""
    return pytest.param(*values, marks=pytest.mark.sweep, id=name)


def sweep_but(kept: Collection[Any], values: Iterable[Any]) -> list[Any]:
    """Return parameters of which all but ``kept`` belong to the sweeps."""
    return [value if value in kept else sweep(value) for value in values]
