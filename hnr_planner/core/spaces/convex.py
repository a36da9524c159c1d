"""
Convex pieces: sets whose intersection with every line is one interval.

A compiled space of convex pieces is the union of one or more pieces of one kind, such as balls.
Each of its arrays has one row for each piece, and its last field, ``max_gap``, is the longest gap
between two pieces that counts as free: a ray passes over it. A type decorated with ``convex``
registers kernels for ``count_pieces``, ``piece_contains`` and ``piece_span``, from which the
primitives of this module are computed. It has a property ``boxes``, the lower and the upper
corners (k, dim) of boxes around the pieces, and ``tree_from``, the number of pieces from which a
tree over these boxes makes chords faster.
"""

from collections.abc import Sequence
import math
from typing import Any, TypeVar

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.dispatch import dispatched
from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.lengths import norm
from hnr_planner.core.spaces import primitives
from hnr_planner.core.spaces.primitives import CompiledSpace, first_exit
import numpy as np

DataType = TypeVar('DataType', bound=type)


@dispatched
@kernel
def count_pieces(space: CompiledSpace) -> int:
    """Return the number of convex pieces of ``space``."""
    raise NotImplementedError


@dispatched
@kernel
def piece_contains(space: CompiledSpace, k: int, x: Floats, closed: bool) -> bool:
    """Return whether piece ``k`` contains ``x`` (dim,), its boundary included when ``closed``."""
    raise NotImplementedError


@dispatched
@kernel
def piece_span(
    space: CompiledSpace, k: int, x: Floats, u: Floats, closed: bool
) -> tuple[float, float]:
    """
    Return the interval of the line ``x + s u`` in piece ``k``; (inf, -inf) for none.

    A line that only touches a piece, or runs along a face, has an interval in the piece only when
    ``closed``.
    """
    raise NotImplementedError


@dispatched
@inlined
def piece_entry(space: CompiledSpace, k: int, x: Floats, u: Floats, t: float, end: float) -> float:
    """Return the first parameter from ``t`` to ``end`` where the line touches a piece, or inf."""
    lower, upper = piece_span(space, k, x, u, True)
    return max(t, lower) if lower <= end and upper >= t else math.inf


@dispatched
@kernel
def span_end_at(space: CompiledSpace, x: Floats, u: Floats, s: float) -> float:
    """
    Return the largest end of the intervals of the line in the pieces that contain ``x + s u``.

    It is ``s`` itself where no piece contains that point.
    """
    raise NotImplementedError


def convex(data_type: DataType) -> DataType:
    """
    Register the primitives for NamedTuples of ``data_type``, whose pieces are convex.

    Return ``data_type``, so that this can be used as a decorator.
    """
    for primitive, answer in (
        (primitives.contains, _contains),
        (primitives.touches, _touches),
        (primitives.first_exit, first_exit_of_pieces),
        (primitives.first_entry, _first_entry),
        (primitives.chord, _chord),
        (primitives.gap, _gap),
        (primitives.segment_is_free, _segment_is_free),
        (primitives.is_visible, _is_visible),
        (primitives.line_touches, _line_touches),
        (primitives.entry_beyond, _entry_beyond),
        (span_end_at, _span_end_at),
    ):
        primitive.register(data_type)(answer)
    return data_type


def is_convex(data: CompiledSpace) -> bool:
    """Return whether a compiled space consists of convex pieces, which ``pack`` can join."""
    return piece_span.knows(data)


def pack(pieces: Sequence[Any], max_gap: float) -> Any:
    """
    Return the union of compiled spaces of one type, in common arrays.

    Gaps up to ``max_gap`` between the pieces count as free: a ray passes over them.
    """
    fields = zip(*(data[:-1] for data in pieces), strict=True)
    return type(pieces[0])(*map(np.concatenate, fields), max_gap)


@kernel
def _contains(space, x):
    """Return whether a piece contains ``x``."""
    return _any_contains(space, x, False)


@kernel
def _touches(space, x):
    """Return whether the closure of a piece contains ``x``."""
    return _any_contains(space, x, True)


@kernel
def _any_contains(space, x, closed):
    """Return whether one of the pieces, open or closed, contains ``x``."""
    for k in range(count_pieces(space)):
        if piece_contains(space, k, x, closed):
            return True
    return False


@kernel
def first_exit_of_pieces(space, x, u, t, horizon):
    """
    Return the first parameter from ``t`` on at which the line leaves the union of the pieces.

    From the end of the pieces that contain the line at ``t``, the line is followed on as long as a
    piece contains the point ``max_gap`` beyond that end.
    """
    s = span_end_at(space, x, u, t)
    if s == t or count_pieces(space) == 1:
        return s
    max_gap = space.max_gap / norm(u)
    while s <= horizon:
        end = span_end_at(space, x, u, s + max_gap)
        if end == s + max_gap:
            break
        s = end
    return s


@kernel
def _span_end_at(space, x, u, s):
    """Return the largest end of the pieces that contain ``x + s u``; ``s`` where none does."""
    end = s
    for k in range(count_pieces(space)):
        lower, upper = piece_span(space, k, x, u, False)
        if lower < s < upper:
            end = max(end, upper)
    return end


@kernel
def _first_entry(space, x, u, t):
    """Return the first parameter from ``t`` on at which the line touches a piece."""
    first = math.inf
    for k in range(count_pieces(space)):
        first = min(first, piece_entry(space, k, x, u, t, first))
    return first


@kernel
def _segment_is_free(space, a, b):
    """Return whether the segment from ``a`` to ``b`` is in the union of the pieces."""
    if not (_any_contains(space, a, False) and _any_contains(space, b, False)):
        return False
    return _is_visible(space, a, b)


@kernel
def _is_visible(space, a, b):
    """Return whether the segment between two free points is in the union of the pieces."""
    if count_pieces(space) == 1:  # which is convex
        return True
    u = b - a
    return not u.any() or first_exit(space, a, u, 0.0, 1.0) > 1.0


@kernel
def _line_touches(space, x, u, end):
    """Return whether the line touches a piece at a parameter from 0 to ``end``."""
    for k in range(count_pieces(space)):
        if piece_entry(space, k, x, u, 0.0, end) < math.inf:
            return True
    return False


@kernel
def _entry_beyond(space, x, u, t, end):
    """Return the first entry into a piece up to ``end``, else ``end``; or a value up to ``t``."""
    for k in range(count_pieces(space)):
        end = min(end, piece_entry(space, k, x, u, 0.0, end))
        if end <= t:
            break
    return end


@kernel
def _chord(space, x, u, back):
    """Return the chord through ``x``: the line in a single piece, or followed through several."""
    if count_pieces(space) > 1:
        return -first_exit(space, x, back, 0.0, math.inf), first_exit(space, x, u, 0.0, math.inf)
    lower, upper = piece_span(space, 0, x, u, False)
    return (lower, upper) if lower < 0.0 < upper else (0.0, 0.0)


@kernel
def _gap(space, x, u, back):
    """Return the interval (lower, upper) of the line around ``x`` that touches no piece."""
    lower, upper = -math.inf, math.inf
    for k in range(count_pieces(space)):
        first, last = piece_span(space, k, x, u, True)
        if first <= 0.0 <= last:
            return 0.0, 0.0
        if last < 0.0:
            lower = max(lower, last)
        elif first <= last:
            upper = min(upper, first)
    return lower, upper
