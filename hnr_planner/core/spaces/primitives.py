"""
Primitives of a compiled space: the kernels from which walks and planners are built.

A compiled space is a NamedTuple of arrays whose type registers a kernel for each primitive.
Primitives that have a body here have a default in terms of the others; a type registers its own
kernel where that is faster or more exact.

``first_exit`` refers to the open set and ``first_entry`` to its closure: the spaces that a
difference removes are closed, so that free space is open.

Points ``x`` and directions ``u`` are arrays (dim,) in the frame of the compiled space. Lines are
written ``x + s u``: a parameter ``s`` is in units of ``|u|``.
"""

from collections.abc import Iterator
import math
from typing import Any, Protocol

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.dispatch import dispatched
from hnr_planner.core.kernels.kernel import kernel
import numpy as np


class CompiledSpace(Protocol):
    """
    A NamedTuple of arrays and numbers for whose type the primitives are registered.

    Compiled spaces may be nested: a field of a composed space is a compiled space.
    """

    @property
    def _fields(self) -> tuple[str, ...]:
        """Names of the fields, as every NamedTuple has them."""

    def __iter__(self) -> Iterator[Any]:
        """Iterate over the values of the fields."""


@dispatched
@kernel
def contains(space: CompiledSpace, x: Floats) -> bool:
    """Return whether ``x`` is a free point of ``space``."""
    raise NotImplementedError


@dispatched
@kernel
def touches(space: CompiledSpace, x: Floats) -> bool:
    """Return whether ``x`` is in the closure of the free points: free, or on the boundary."""
    raise NotImplementedError


@dispatched
@kernel
def first_exit(space: CompiledSpace, x: Floats, u: Floats, t: float, horizon: float) -> float:
    """
    Return the first parameter ``s >= t`` at which the line ``x + s u`` leaves ``space``.

    It is ``t`` itself where the line is outside at ``t``. Where the line is inside up to
    ``horizon``, any value above ``horizon`` may be returned.
    """
    raise NotImplementedError


@dispatched
@kernel
def first_entry(space: CompiledSpace, x: Floats, u: Floats, t: float) -> float:
    """
    Return the first parameter ``s >= t`` at which ``x + s u`` touches ``space``.

    It is ``t`` itself where the line touches the space at ``t``, and inf where it never does.
    """
    raise NotImplementedError


@dispatched
@kernel
def chord(space: CompiledSpace, x: Floats, u: Floats, back: Floats) -> tuple[float, float]:
    """
    Return the largest open interval of ``x + s u`` around ``s = 0`` that is free.

    The interval is (lower, upper) in parameters s. ``x`` has to be free (``chord_or_empty`` checks
    that), and ``back`` has to be ``-u``.
    """
    return -first_exit(space, x, back, 0.0, math.inf), first_exit(space, x, u, 0.0, math.inf)


@dispatched
@kernel
def gap(space: CompiledSpace, x: Floats, u: Floats, back: Floats) -> tuple[float, float]:
    """
    Return the largest open interval of ``x + s u`` around ``s = 0`` that does not touch ``space``.

    ``x`` must not touch the space, and ``back`` has to be ``-u``. The ends may be infinite.
    """
    return -first_entry(space, x, back, 0.0), first_entry(space, x, u, 0.0)


@dispatched
@kernel
def component(space: CompiledSpace, x: Floats) -> int:
    """
    Return the number of the component that holds ``x``, from 1; 0 where ``x`` is not free.

    No path joins points with different numbers. A space that cannot distinguish its components
    gives all free points the same number.
    """
    return 1 if contains(space, x) else 0


@dispatched
@kernel
def segment_is_free(space: CompiledSpace, a: Floats, b: Floats) -> bool:
    """Return whether every point of the closed segment from ``a`` to ``b`` (dim,) is free."""
    if not (contains(space, a) and contains(space, b)):
        return False
    u = b - a
    return not u.any() or first_exit(space, a, u, 0.0, 1.0) > 1.0


@dispatched
@kernel
def is_visible(space: CompiledSpace, a: Floats, b: Floats) -> bool:
    """Return whether every point of the segment between two free points (dim,) is free."""
    return segment_is_free(space, a, b)


@dispatched
@kernel
def line_touches(space: CompiledSpace, x: Floats, u: Floats, end: float) -> bool:
    """Return whether the line ``x + s u`` touches ``space`` at a parameter from 0 to ``end``."""
    return first_entry(space, x, u, 0.0) <= end


@dispatched
@kernel
def entry_beyond(space: CompiledSpace, x: Floats, u: Floats, t: float, end: float) -> float:
    """
    Return the first parameter from 0 to ``end`` at which ``x + s u`` touches ``space``.

    It is ``end`` where there is none. Where the line touches the space at or before ``t``, any
    value up to ``t`` may be returned.
    """
    return min(end, first_entry(space, x, u, 0.0))


@dispatched
@kernel
def exit_beyond(space: CompiledSpace, x: Floats, u: Floats, t: float) -> float:
    """
    Return the parameter ``s > t`` at which the ray from ``x`` along ``u`` leaves ``space``.

    Where it leaves the space before, any value up to ``t`` may be returned: of several rays the
    longest is found sooner than the length of each. A space that can only test points may look at
    some of them only and return a rough value; ``first_blocked`` looks at the others.
    """
    return first_exit(space, x, u, 0.0, math.inf)


@dispatched
@kernel
def longest_ray(space: CompiledSpace, x: Floats, directions: Floats) -> tuple[int, float]:
    """
    Return which of the rays from ``x`` along ``directions`` (n, dim) is the longest, and its end.

    The end is the parameter that ``exit_beyond`` returns.
    """
    longest, end = 0, 0.0
    for k in range(len(directions)):
        reach = exit_beyond(space, x, directions[k], end)
        if reach > end:
            longest, end = k, reach
    return longest, end


@dispatched
@kernel
def longest_apart(
    space: CompiledSpace, x: Floats, directions: Floats, ends: Floats
) -> tuple[int, float]:
    """
    Return which ray from ``x`` touches ``space`` last, and the parameter where it does.

    The rays are those along ``directions`` (n, dim), each up to its parameter in ``ends`` (n,),
    which is returned for a ray that touches the space nowhere before.
    """
    longest, end = 0, 0.0
    for k in range(len(directions)):
        if ends[k] > end:
            reach = entry_beyond(space, x, directions[k], end, ends[k])
            if reach > end:
                longest, end = k, reach
    return longest, end


@dispatched
@kernel
def first_blocked(space: CompiledSpace, x: Floats, y: Floats) -> float:
    """
    Return where the segment from ``x`` to ``y`` is blocked, as a fraction of it; inf if nowhere.

    ``y`` is a free point on a ray, before the end that ``exit_beyond`` returned: the answer is inf
    where that is exact. Where it is rough, the answer is inf if ``segment_is_free``.
    """
    return math.inf


@kernel
def are_free(space, points):
    """Return which of ``points`` (k, dim) are free: (k,) bool."""
    free = np.empty(len(points), dtype=np.bool_)
    for k in range(len(points)):
        free[k] = contains(space, points[k])
    return free


@kernel
def contains_around(space, x, slack):
    """Return whether ``x`` is free, also when any one of its coordinates changes by ``slack``."""
    y = x.copy()
    for i in range(len(x)):
        for offset in (-slack, slack):
            y[i] = x[i] + offset
            if not contains(space, y):
                return False
        y[i] = x[i]
    return contains(space, x)


@kernel
def chord_or_empty(space, x, u):
    """Return the chord through ``x`` along ``u``; (0, 0) where ``x`` is not free."""
    if not contains(space, x):
        return 0.0, 0.0
    return chord(space, x, u, -u)


@kernel
def first_blocked_segment(space, points):
    """
    Return the index of the first segment of a path (m, dim) that is not free; -1 for none.

    Segment k leads from point k to point k + 1. A path of one point has no segment.
    """
    for k in range(len(points) - 1):
        if not segment_is_free(space, points[k], points[k + 1]):
            return k
    return -1
