"""Limits of systems, checked at the door."""

import math
from typing import Any

from hnr_planner.core.checks import check_positive
from hnr_planner.core.errors import RequestError


def check_limit(name: str, value: Any) -> float:
    """Return a limit as a finite float above 0, or raise RequestError."""
    limit = check_positive(name, value)
    if limit == math.inf:
        raise RequestError(f'{name} must be finite, got inf')
    return limit
