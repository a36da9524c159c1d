"""Bounds at the door: a box around a space that floating-point numbers can resolve."""

from hnr_planner.core.checks import Floats
from hnr_planner.core.errors import SpaceError
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
