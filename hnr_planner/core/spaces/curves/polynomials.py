"""
Sign changes of polynomials, in order.

Between two turning points of a polynomial its sign changes at most once, and its turning points
are the sign changes of its derivative. So the sign changes are found from the last derivative,
which is linear, up to the polynomial itself. Every change is located by bisection, which converges
whatever the coefficients.
"""

import math

from hnr_planner.core.kernels.kernel import kernel
import numpy as np

#: Bisections between two turning points: to the last bit, unless the interval is minute.
HALVINGS = 80


@kernel
def value(coefficients, s):
    """Return the value at ``s`` of a polynomial; its constant coefficient comes first."""
    total = 0.0
    for k in range(len(coefficients) - 1, -1, -1):
        total = total * s + coefficients[k]
    return total


@kernel
def next_change(coefficients, first, last, closed, rounding):
    """
    Return the first parameter in (``first``, ``last``] of a change between inside and outside.

    A parameter is inside where the polynomial is below 0, and also where it is 0 when ``closed``.
    The result is the first number after the change, and inf if there is no change. A turning point
    whose value is within ``rounding`` of 0 counts as 0, and so may be a change.
    """
    order = len(coefficients) - 1
    derivative, turns, n_turns = np.empty(order + 1), np.empty(order), 0
    for k in range(order - 1, 0, -1):
        for i in range(order + 1 - k):
            factor = 1.0
            for j in range(k):
                factor *= i + 1 + j
            derivative[i] = factor * coefficients[i + k]
        end = order + 1 - k
        n_turns = _changes(derivative[:end], first, last, turns, n_turns)
    before = first
    for k in range(n_turns + 1):
        after = turns[k] if k < n_turns else last
        was_in = _is_in(coefficients, before, closed)
        if was_in != _is_in(coefficients, after, closed):
            return _change(coefficients, before, after, closed)
        if k < n_turns and was_in != closed and abs(value(coefficients, after)) <= rounding:
            return after
        before = after
    return math.inf


@kernel
def _changes(coefficients, first, last, turns, n_turns):
    """
    Replace turning points of a polynomial by its sign changes; return the number of changes.

    ``turns`` holds ``n_turns`` turning points between ``first`` and ``last``, in order.
    """
    before, n = first, 0
    for k in range(n_turns + 1):
        after = turns[k] if k < n_turns else last
        if _is_in(coefficients, before, False) != _is_in(coefficients, after, False):
            turns[n] = _change(coefficients, before, after, False)
            n += 1
        before = after
    return n


@kernel
def _change(coefficients, before, after, closed):
    """Return the first number after the only change between two parameters, by bisection."""
    was_in = _is_in(coefficients, before, closed)
    for _ in range(HALVINGS):
        middle = before + (after - before) / 2.0
        if not before < middle < after:
            break
        if _is_in(coefficients, middle, closed) == was_in:
            before = middle
        else:
            after = middle
    return after


@kernel
def _is_in(coefficients, s, closed):
    """Return whether the polynomial is below 0 at ``s``, or 0 when ``closed``."""
    height = value(coefficients, s)
    return height < 0.0 or (closed and height == 0.0)
