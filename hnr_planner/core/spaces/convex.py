"""
Convex pieces: sets that cut one interval out of every line.

The data of such a space holds one piece or several, which together mean their union: pieces of one
kind lie in the same arrays, so that a union of many is one short loop. Each array has one row for
each piece, and the last field, ``max_gap``, is how far apart two pieces may be for a ray to pass from
one to the other. A type decorated with ``convex`` registers kernels for ``count``, ``holds`` and
``span``, and the primitives follow from them.
"""

from collections.abc import Sequence
import math
from typing import Any, TypeVar

from hnr_planner.core.kernels.dispatch import dispatched
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.lengths import norm
from hnr_planner.core.spaces import primitives
from hnr_planner.core.spaces.primitives import first_exit
import numpy as np

DataType = TypeVar('DataType', bound=type)


@dispatched
@kernel
def count(space: Any) -> int:
    """Return how many pieces there are."""
    raise NotImplementedError


@dispatched
@kernel
def holds(space: Any, k: int, x: Any, closed: bool) -> bool:
    """Say whether piece ``k`` holds ``x``, its boundary included when ``closed``."""
    raise NotImplementedError


@dispatched
@kernel
def span(space: Any, k: int, x: Any, u: Any, closed: bool) -> tuple[float, float]:
    """
    Return the interval of the line ``x + s u`` in piece ``k``; (inf, -inf) for none.

    Open and closed pieces differ in the lines that only touch them, or run along a face.
    """
    raise NotImplementedError


def convex(data_type: DataType) -> DataType:
    """Let the primitives answer for NamedTuples of ``data_type``, whose pieces are convex."""
    for primitive, answer in (
        (primitives.contains, _contains),
        (primitives.touches, _touches),
        (primitives.first_exit, _first_exit),
        (primitives.first_entry, _first_entry),
        (primitives.chord, _chord),
        (primitives.gap, _gap),
    ):
        primitive.register(data_type)(answer)
    return data_type


def is_convex(data: Any) -> bool:
    """Say whether data holds convex pieces, which ``pack`` takes."""
    return span.knows(data)


def pack(pieces: Sequence[Any], max_gap: float) -> Any:
    """Return the data of all pieces of several data of one type, between which gaps close."""
    fields = zip(*(data[:-1] for data in pieces), strict=True)
    return type(pieces[0])(*map(np.concatenate, fields), max_gap)


@kernel
def _contains(space, x):
    return _any_holds(space, x, False)


@kernel
def _touches(space, x):
    return _any_holds(space, x, True)


@kernel
def _any_holds(space, x, closed):
    for k in range(count(space)):
        if holds(space, k, x, closed):
            return True
    return False


@kernel
def _first_exit(space, x, u, t, enough):
    """Go to the end of a piece that holds the line at ``t``, and on in those that reach on."""
    s = t
    for k in range(count(space)):
        lower, upper = span(space, k, x, u, False)
        if lower < t < upper:
            s = max(s, upper)
    if s == t or count(space) == 1:
        return s
    max_gap = space.max_gap / norm(u)
    reaching = True
    while reaching and s <= enough:
        reaching = False
        for k in range(count(space)):
            lower, upper = span(space, k, x, u, False)
            if lower < s + max_gap < upper:
                s, reaching = upper, True
    return s


@kernel
def _first_entry(space, x, u, t):
    first = math.inf
    for k in range(count(space)):
        lower, upper = span(space, k, x, u, True)
        if t <= upper:
            first = min(first, max(t, lower))
    return first


@kernel
def _chord(space, x, u, back):
    """Take both ends from one piece; several may reach on from one to the next."""
    if count(space) > 1:
        return -first_exit(space, x, back, 0.0, math.inf), first_exit(space, x, u, 0.0, math.inf)
    lower, upper = span(space, 0, x, u, False)
    return (lower, upper) if lower < 0.0 < upper else (0.0, 0.0)


@kernel
def _gap(space, x, u, back):
    """Let every piece cut off what lies behind it, on either side."""
    lower, upper = -math.inf, math.inf
    for k in range(count(space)):
        first, last = span(space, k, x, u, True)
        if first <= 0.0 <= last:
            return 0.0, 0.0
        if last < 0.0:
            lower = max(lower, last)
        elif first <= last:
            upper = min(upper, first)
    return lower, upper
