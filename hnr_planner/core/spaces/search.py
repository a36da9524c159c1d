"""
Search along a line in a space that can only test points.

A point is tested at every ``step`` along the line, and a change of the result is located by
bisection. So a gap or a wall that is thinner than the step along a line may be missed.
"""

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.dispatch import dispatched
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.primitives import CompiledSpace
import numpy as np


@dispatched
@kernel
def is_in(space: CompiledSpace, x: Floats, u: Floats, s: float, work: Floats) -> bool:
    """
    Return whether ``x + s u`` is a free point of ``space``.

    ``work`` is a work array of ``work_size`` numbers.
    """
    raise NotImplementedError


@dispatched
@kernel
def work_size(space: CompiledSpace, dim: int) -> int:
    """Return the number of floats that ``is_in`` needs to work with."""
    raise NotImplementedError


@kernel
def exit_by_search(space, x, u, t, horizon, last, step, closeness):
    """
    Return the first parameter from ``t``, where the line is inside, at which it is found outside.

    No point from ``last`` on is inside. ``step`` and ``closeness`` are parameters too: the
    distance of tests, and that to which the exit is located.
    """
    work, before = np.empty(work_size(space, len(x))), t
    while before <= horizon:
        s = min(before + step, last)
        if s == last or not is_in(space, x, u, s, work):
            return bisect(space, x, u, before, s, closeness, work)
        before = s
    return before


@kernel
def entry_by_search(space, x, u, first, last, step, closeness):
    """Return the first parameter in (first, last) at which the line is found inside, or inf."""
    work, before = np.empty(work_size(space, len(x))), first
    while before < last:
        s = min(before + step, last)
        if is_in(space, x, u, s, work):
            return bisect(space, x, u, before, s, closeness, work)
        before = s
    return np.inf


@kernel
def bisect(space, x, u, before, after, closeness, work):
    """Return a parameter just after the change of membership between ``before`` and ``after``."""
    was_in = is_in(space, x, u, before, work)
    while after - before > closeness:
        middle = before + (after - before) / 2.0
        if not before < middle < after:
            break
        if is_in(space, x, u, middle, work) == was_in:
            before = middle
        else:
            after = middle
    return after
