"""Bounds: a box around a space, and whether floating-point numbers resolve it."""

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
    """Return the corners (dim,) of a box as fresh arrays, or raise SpaceError."""
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
    Return the origin (dim,) of the kernel frame of a space with these bounds; None for zero.

    A coordinate that does not resolve ``FINEST`` of its side is counted from the middle of the
    bounds, the others from 0. Then the subtraction of the origin is exact for points in the bounds
    (Sterbenz's lemma), and a space near 0 keeps the caller's frame.
    """
    is_far = _rounding(lower, upper) > FINEST * (upper - lower)
    return np.where(is_far, lower + (upper - lower) / 2.0, 0.0) if is_far.any() else None


def in_words(vector: Floats) -> str:
    """Format a vector (dim,) for a repr: short numbers, of many the first and last two."""
    return np.array2string(
        vector, separator=', ', threshold=6, edgeitems=2, formatter={'float_kind': '{:g}'.format}
    )


def _rounding(lower: Floats, upper: Floats) -> Floats:
    """Return the spacing (dim,) of floating-point numbers at the far end of the bounds."""
    return np.asarray(np.spacing(np.maximum(np.abs(lower), np.abs(upper))))


def _words(lower: Floats, upper: Floats) -> str:
    """Return bounds in full, for a message."""
    return f'{lower.tolist()} .. {upper.tolist()}'


@kernel
def box_span(lower, upper, x, u):
    """Return the interval of the line ``x + s u`` in a closed box; (inf, -inf) for none."""
    first, last = -math.inf, math.inf
    for i in range(len(x)):
        below, above = lower[i] - x[i], upper[i] - x[i]
        if u[i] != 0.0:
            first = max(first, min(below / u[i], above / u[i]))
            last = min(last, max(below / u[i], above / u[i]))
        elif not below <= 0.0 <= above:
            return math.inf, -math.inf
    return first, last
