"""
Where polynomials change their sign, in order: found between the turns that come one after another.

Between two turns of a polynomial its sign changes at most once, and its turns are the sign changes
of its derivative: so from the last derivative, which is linear, one goes up to the polynomial.
Every change is closed in by halving, which no coefficient can lead astray.
"""

import math

from hnr_planner.core.kernels.kernel import kernel
import numpy as np

#: Halvings of the way between two turns: to the last bit, unless the change is next to nothing.
HALVINGS = 80


@kernel
def value(coefficients, s):
    """Value at ``s`` of the polynomial with these coefficients, that of 1 first."""
    total = 0.0
    for k in range(len(coefficients) - 1, -1, -1):
        total = total * s + coefficients[k]
    return total


@kernel
def next_change(coefficients, first, last, closed, rounding):
    """
    Return the first parameter after ``first`` at which being in ends or begins; inf for none.

    Where the polynomial is below 0 is in, and also where it is 0 when ``closed``. The parameter is
    at most ``last``, and the first number on the other side. A turn no higher or deeper than
    ``rounding`` touches 0.
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
    """Replace the turns of a polynomial by its changes of sign; return how many there are."""
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
    """Close in on the only change between two parameters, to the number after it."""
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
    height = value(coefficients, s)
    return height < 0.0 or (closed and height == 0.0)
