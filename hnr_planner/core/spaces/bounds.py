"""Bounds: a box around a space, which floating-point numbers can resolve."""

import math

from hnr_planner.core.checks import Floats
from hnr_planner.core.errors import SpaceError
from hnr_planner.core.kernels.kernel import kernel
import numpy as np

#: Coordinates must resolve this part of each side, or chords would end in their rounding.
FINEST = 1e-10


def check_bounds(name: str, lower: Floats, upper: Floats) -> None:
    """Refuse bounds (dim,) of a space that are not finite, without inside, or too far away."""
    if not (np.isfinite(lower).all() and np.isfinite(upper).all()):
        raise SpaceError(f'{name} must be bounded, its bounds are {_words(lower, upper)}')
    if not (lower < upper).all():
        raise SpaceError(f'{name} must have an inside, its bounds are {_words(lower, upper)}')
    rounding = np.spacing(np.maximum(np.abs(lower), np.abs(upper)))
    if not (rounding <= FINEST * (upper - lower)).all():
        raise SpaceError(
            f'{name} is too thin for where it lies: coordinates must resolve {FINEST:g} of each '
            f'side, its bounds are {_words(lower, upper)}'
        )


def _words(lower: Floats, upper: Floats) -> str:
    return f'{lower.tolist()} .. {upper.tolist()}'


@kernel
def within(lower, upper, x, u):
    """Return where the line ``x + s u`` enters and leaves a box; (inf, -inf) for never."""
    first, last = -math.inf, math.inf
    for i in range(len(x)):
        below, above = lower[i] - x[i], upper[i] - x[i]
        if u[i] != 0.0:
            first = max(first, min(below / u[i], above / u[i]))
            last = min(last, max(below / u[i], above / u[i]))
        elif not below <= 0.0 <= above:
            return math.inf, -math.inf
    return first, last
