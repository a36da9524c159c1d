"""
The shortest order of stops: the travelling salesman's problem on a table of lengths.

Up to ``EXACT_MAX`` stops are ordered exactly, by dynamic programming over sets of stops (Held and
Karp, "A dynamic programming approach to sequencing problems", 1962). More are ordered by local
search: parts of the order are reversed (2-opt) or moved (Or-opt) while that shortens it; then
two parts are exchanged at random, a double bridge, and what the search makes of that is kept where
it is shorter (Martin, Otto and Felten, "Large-step Markov chains for the traveling salesman
problem", 1991).

The local search orders a ring. An order that may end anywhere is a ring with one more stop, at
length 0 from all others, that is bound to the first one by a length far below 0.
"""

import math

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import stream, uniform
from hnr_planner.core.planning.limits import Budget
import numpy as np
from numpy.typing import NDArray

#: Largest number of stops that are ordered exactly.
EXACT_MAX = 13
#: Exchanges of the local search for each stop, and between two looks at the limits.
KICKS, KICKS_AT_ONCE = 60, 50
#: Stops in the longest part that Or-opt moves.
PART_MAX = 3
#: Least gain of a move, as a fraction of the longest length: smaller ones may be roundings.
LEAST_GAIN = 1e-12


def shortest_order(lengths: Floats, *, closed: bool, budget: Budget) -> NDArray[np.int64]:
    """
    Return the order (k,) of stops, from stop 0 on, for which the sum of lengths is least.

    Parameters
    ----------
    lengths : (k, k)
        Finite lengths from stop to stop, symmetric.
    closed : bool
        Whether the way back to stop 0 counts as well.
    budget : Budget
        Limits that end the local search, with the best order by then.

    """
    n = len(lengths)
    if n <= EXACT_MAX:
        return exact_order(lengths, closed)
    ring_lengths = lengths if closed else _with_free_end(lengths)
    ring, rng = _nearest_next(ring_lengths, n), stream(0)
    for _ in range(0, KICKS * n, KICKS_AT_ONCE):
        if budget.stop() is not None:
            break
        improve_ring(ring_lengths, ring, KICKS_AT_ONCE, rng)
    first = int(np.flatnonzero(ring == 0)[0])
    order = np.roll(ring, -first)
    if not closed and order[-1] != n:
        order = np.roll(order[::-1], 1)
    return order[order < n]


def length_in_order(lengths: Floats, order: NDArray[np.int64], *, closed: bool) -> float:
    """Return the sum of ``lengths`` (k, k) along an order (k,), with the way back if closed."""
    total = math.fsum(lengths[order[:-1], order[1:]])
    return total + float(lengths[order[-1], order[0]]) if closed else total


def _with_free_end(lengths: Floats) -> Floats:
    """Return the lengths (k + 1, k + 1) of the ring of an order that may end anywhere."""
    n = len(lengths)
    ring = np.zeros((n + 1, n + 1))
    ring[:n, :n] = lengths
    ring[0, n] = ring[n, 0] = -2.0 * n * max(float(lengths.max()), 1.0)
    return ring


def _nearest_next(lengths: Floats, n_stops: int) -> NDArray[np.int64]:
    """Return the ring of the order in which each stop is the nearest that is left."""
    ring, left = [0], set(range(1, n_stops))
    while left:
        last = ring[-1]
        ring.append(min(left, key=lambda stop: (lengths[last, stop], stop)))
        left.remove(ring[-1])
    return np.array([*ring, *range(n_stops, len(lengths))])


@kernel
def exact_order(lengths, closed):
    """
    Return the order (k,) of stops from stop 0 on with the least sum of ``lengths`` (k, k).

    ``closed`` states whether the way back to stop 0 counts as well. The work is k^2 2^k.
    """
    n = len(lengths) - 1  # stop j + 1 has bit j in a set of stops
    order = np.zeros(n + 1, dtype=np.int64)
    if n == 0:
        return order
    least = np.full((1 << n, n), math.inf)  # to visit a set of stops and end at one of them
    before = np.zeros((1 << n, n), dtype=np.int64)
    for j in range(n):
        least[1 << j, j] = lengths[0, j + 1]
    for stops in range(1, 1 << n):
        for j in range(n):
            if (stops >> j) & 1 == 0:
                continue
            for k in range(n):
                if (stops >> k) & 1 == 0:
                    length = least[stops, j] + lengths[j + 1, k + 1]
                    if length < least[stops | (1 << k), k]:
                        least[stops | (1 << k), k] = length
                        before[stops | (1 << k), k] = j
    stops, last, shortest = (1 << n) - 1, 0, math.inf
    for j in range(n):
        length = least[stops, j] + (lengths[j + 1, 0] if closed else 0.0)
        if length < shortest:
            last, shortest = j, length
    for i in range(n, 0, -1):
        order[i] = last + 1
        stops, last = stops ^ (1 << last), before[stops, last]
    return order


@kernel
def improve_ring(lengths, ring, n_kicks, rng):
    """
    Improve a ring (n,) of stops in place: local search, and ``n_kicks`` kicks with another one.

    ``lengths`` (n, n) are symmetric. A kick that does not pay is undone.
    """
    n, least_gain = len(ring), LEAST_GAIN * np.abs(lengths).max()
    _descend(lengths, ring, least_gain)
    length = _ring_length(lengths, ring)
    kicked = np.empty_like(ring)
    for _ in range(n_kicks):
        a, b, c = _three_cuts(n, rng)
        for i in range(n):
            kicked[i] = ring[i]
        for i in range(c - b):
            kicked[a + i] = ring[b + i]
        for i in range(b - a):
            kicked[a + c - b + i] = ring[a + i]
        _descend(lengths, kicked, least_gain)
        other = _ring_length(lengths, kicked)
        if other < length - least_gain:
            length = other
            for i in range(n):
                ring[i] = kicked[i]


@kernel
def _three_cuts(n, rng):
    """Return three places 1 <= a < b < c <= n in a ring of n >= 3 stops, at random."""
    a = 1 + int(uniform(rng) * n)
    b = 1 + int(uniform(rng) * (n - 1))
    c = 1 + int(uniform(rng) * (n - 2))
    b += 1 if b >= a else 0
    low, high = min(a, b), max(a, b)
    c += 1 if c >= low else 0
    c += 1 if c >= high else 0
    return min(low, c), max(low, min(high, c)), max(high, c)


@kernel
def _ring_length(lengths, ring):
    """Return the sum of lengths along a ring."""
    total = 0.0
    for i in range(len(ring)):
        total += lengths[ring[i - 1], ring[i]]
    return total


@kernel
def _descend(lengths, ring, least_gain):
    """Reverse and move parts of a ring in place while a single move shortens it."""
    shorter = True
    while shorter:
        shorter = _reverse_parts(lengths, ring, least_gain)
        shorter = _move_parts(lengths, ring, least_gain) or shorter


@kernel
def _reverse_parts(lengths, ring, least_gain):
    """Reverse each part of a ring where that shortens it; return whether one was (2-opt)."""
    n, any_reversed = len(ring), False
    for i in range(n - 1):
        for j in range(i + 1, n):
            a, b, c, d = ring[i - 1], ring[i], ring[j], ring[j + 1 if j + 1 < n else 0]
            if a == c:  # the part is the whole ring
                continue
            gain = lengths[a, b] + lengths[c, d] - lengths[a, c] - lengths[b, d]
            if gain > least_gain:
                _reverse(ring, i, j)
                any_reversed = True
    return any_reversed


@kernel
def _reverse(ring, i, j):
    """Reverse the entries i to j of a ring in place."""
    while i < j:
        ring[i], ring[j] = ring[j], ring[i]
        i, j = i + 1, j - 1


@kernel
def _move_parts(lengths, ring, least_gain):
    """
    Move short parts of a ring where that shortens it; return whether one was moved (Or-opt).

    The part ring[i : j] between a and d goes between two neighbours c and e elsewhere. That is two
    or three reversals of entries.
    """
    n, any_moved = len(ring), False
    for size in range(1, PART_MAX + 1):
        for i in range(n - size):
            j = i + size
            for k in range(n):
                if i - 1 <= k < j or (i == 0 and k == n - 1):
                    continue
                a, first, last, d = ring[i - 1], ring[i], ring[j - 1], ring[j]
                c, e = ring[k], ring[k + 1 if k + 1 < n else 0]
                if e == first:
                    continue
                removed = lengths[a, first] + lengths[last, d] - lengths[a, d]
                forward = lengths[c, first] + lengths[last, e] - lengths[c, e]
                backward = lengths[c, last] + lengths[first, e] - lengths[c, e]
                if removed - min(forward, backward) > least_gain:
                    _move(ring, i, j, k, forward <= backward)
                    any_moved = True
    return any_moved


@kernel
def _move(ring, i, j, k, forward):
    """
    Move the entries i to j - 1 of a ring to the place after entry k, which is none of them.

    They keep their order if ``forward``, and are reversed otherwise.
    """
    if k >= j:
        _reverse(ring, i, j - 1)
        _reverse(ring, j, k)
        _reverse(ring, i, k)
        first, last = k - (j - i) + 1, k
    else:
        _reverse(ring, k + 1, i - 1)
        _reverse(ring, i, j - 1)
        _reverse(ring, k + 1, j - 1)
        first, last = k + 1, k + (j - i)
    if not forward:
        _reverse(ring, first, last)
