"""Bounds of spaces: checks that floating-point numbers resolve them, and the kernel origin."""

import math

from hnr_planner.core.checks import check_vector, Floats
from hnr_planner.core.errors import SpaceError
from hnr_planner.core.kernels.kernel import kernel
import numpy as np
from numpy.typing import ArrayLike

#: Coordinates in the kernel frame resolve this fraction of each side.
FINEST = 1e-10
#: The caller's coordinates must resolve this fraction of each side, or the space is refused.
COARSEST = 1e-6


def check_bounds(name: str, lower: Floats, upper: Floats) -> None:
    """Raise SpaceError unless bounds (dim,) are finite, not empty, and resolved by floats."""
    if not (np.isfinite(lower).all() and np.isfinite(upper).all()):
        raise SpaceError(f'{name} must be bounded, its bounds are {_words(lower, upper)}')
    if not (lower < upper).all():
        raise SpaceError(f'{name} must have an inside, its bounds are {_words(lower, upper)}')
    if not (_rounding(lower, upper) <= COARSEST * (upper - lower)).all():
        raise SpaceError(
            f'{name} is too thin for where it lies: coordinates must resolve {COARSEST:g} of each '
            f'side, its bounds are {_words(lower, upper)}; move it nearer to the origin'
        )


def check_corners(lower: ArrayLike, upper: ArrayLike) -> tuple[Floats, Floats]:
    """
    Return the corners (dim,) of a box as fresh arrays, or raise SpaceError.

    The box has to satisfy ``check_bounds``: ``lower`` below ``upper`` in every coordinate.
    """
    begin = check_vector('lower', lower, SpaceError)
    end = check_vector('upper', upper, SpaceError)
    if begin.shape != end.shape:
        raise SpaceError(
            f'lower and upper must be of one dimension, got {len(begin)} and {len(end)}'
        )
    check_bounds('the box', begin, end)
    return begin, end


def kernel_origin(lower: Floats, upper: Floats) -> Floats | None:
    """
    Return the origin (dim,) of the kernel frame, in the caller's frame; None for the zero vector.

    A coordinate whose floating-point spacing is above ``FINEST`` of the side of the bounds is
    counted from the middle of the bounds, the others from 0. Then the subtraction of the origin is
    exact for points in the bounds (Sterbenz's lemma), and a space near 0 keeps the caller's frame.
    """
    is_far = _rounding(lower, upper) > FINEST * (upper - lower)
    return np.where(is_far, lower + (upper - lower) / 2.0, 0.0) if is_far.any() else None


def in_words(vector: Floats) -> str:
    """Format a vector (dim,) for a repr, in short numbers; of more than 6 the first and last 2."""
    return np.array2string(
        vector, separator=', ', threshold=6, edgeitems=2, formatter={'float_kind': '{:g}'.format}
    )


def _rounding(lower: Floats, upper: Floats) -> Floats:
    """Return the spacing (dim,) of floats at the bound that is farther from 0, for each axis."""
    return np.asarray(np.spacing(np.maximum(np.abs(lower), np.abs(upper))))


def _words(lower: Floats, upper: Floats) -> str:
    """Format bounds (dim,) with all their numbers, for a message."""
    return f'{lower.tolist()} .. {upper.tolist()}'


@kernel
def box_span(lower, upper, x, u):
    """
    Return the interval of parameters s at which ``x + s u`` is in a closed box.

    Where the line misses the box, the first end is above the last.
    """
    first, last = -math.inf, math.inf
    for i in range(len(x)):
        below, above = lower[i] - x[i], upper[i] - x[i]
        if u[i] != 0.0:
            first = max(first, min(below / u[i], above / u[i]))
            last = min(last, max(below / u[i], above / u[i]))
        elif not below <= 0.0 <= above:
            return math.inf, -math.inf
    return first, last
