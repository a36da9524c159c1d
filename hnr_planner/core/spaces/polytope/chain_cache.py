"""
Walking in a polytope: the distances to its planes go along with the chain.

A line along ``u`` approaches the planes at the rates ``normals u``; a move by ``s`` takes ``s``
times the rates off the distances, and nothing has to be worked out from the point. Along an axis
the rates are one column of the normals, of which a sparse polytope looks at the numbers that are
not zero alone.

Rounding would let the distances drift, so they are worked out anew every ``REFRESH`` steps, and a
move to less than ``doubt`` before a plane is checked from the point itself: every point of a chain
is one that ``contains`` says is free.
"""

import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.spaces.chain_cache import (
    chord_cached,
    memory_size,
    move_along,
    move_if_free,
    NO_AXIS,
    open_cache,
    refresh,
)
from hnr_planner.core.spaces.polytope.planes import LONG, PolytopeData
import numpy as np
from numpy.typing import NDArray

#: Stands for distances that round to less: they never reach zero.
LEAST = float(np.finfo(np.float64).tiny)


class PolytopeCache(NamedTuple):
    """
    Where a chain stands in a polytope.

    Attributes
    ----------
    x, y : (dim,)
        The chain's point, and room for the next one.
    slacks : (m,)
        Distances to the planes.
    rates : (m,)
        How fast the line asked last approaches them.
    hurries : (m,)
        Rates over distances.
    hurries_signed, hurries_unsigned : (m,)
        The bits of these.

    """

    x: Floats
    y: Floats
    slacks: Floats
    rates: Floats
    hurries: Floats
    hurries_signed: NDArray[np.int64]
    hurries_unsigned: NDArray[np.uint64]


@memory_size.register(PolytopeData)
@kernel
def _memory_size(polytope, dim):
    return dim + 3 * len(polytope.offsets)


@open_cache.register(PolytopeData)
@inlined
def _open_cache(polytope, x, memory):
    first, m = len(x), len(polytope.offsets)
    second, third = first + m, first + 2 * m
    hurries = memory[third:]
    return PolytopeCache(
        x=x,
        y=memory[:first],
        slacks=memory[first:second],
        rates=memory[second:third],
        hurries=hurries,
        hurries_signed=hurries.view(np.int64),
        hurries_unsigned=hurries.view(np.uint64),
    )


@refresh.register(PolytopeData)
@kernel
def _refresh(polytope, cache):
    _set_rates(polytope.layout, cache.x, cache.slacks)
    for i in range(len(cache.slacks)):
        cache.slacks[i] = max(polytope.offsets[i] - cache.slacks[i], LEAST)


@chord_cached.register(PolytopeData)
@inlined
def _chord_cached(polytope, cache, u, axis):
    layout = polytope.layout
    if axis == NO_AXIS:
        _set_rates(layout, u, cache.rates)
    elif _is_dense(layout):
        for i in range(len(cache.rates)):
            cache.rates[i] = layout.dense[axis, i]
    else:
        return _chord_along_sparse_axis(layout, axis, cache.slacks)
    return _chord_at_rates(cache)


@move_along.register(PolytopeData)
@inlined
def _move_along(polytope, cache, u, axis, s):
    layout = polytope.layout
    if axis == NO_AXIS or _is_dense(layout):
        n_doubtful = _move_at_rates(cache, s, polytope.doubt)
    else:
        n_doubtful = _move_along_sparse_axis(layout, axis, cache.slacks, s, polytope.doubt)
    if n_doubtful > 0:
        return _move_and_look(polytope, cache, u, s)
    if axis == NO_AXIS:
        for i in range(len(u)):
            cache.x[i] += s * u[i]
    else:
        cache.x[axis] += s
    return True


@kernel
def _move_and_look(polytope, cache, u, s):
    """Move if the end is free for certain, and work out the distances from the point."""
    for i in range(len(u)):
        cache.y[i] = cache.x[i] + s * u[i]
    is_free = move_if_free(polytope, cache)
    _refresh(polytope, cache)
    return is_free


@inlined
def _is_dense(layout):
    return len(layout.dense) > 0


@inlined
def _set_rates(layout, u, rates):
    """Multiply the matrix by ``u`` (dim,) into ``rates`` (m,)."""
    if _is_dense(layout):
        for i in range(len(rates)):
            rates[i] = 0.0
        for j in range(len(u)):
            for i in range(len(rates)):
                rates[i] += u[j] * layout.dense[j, i]
        return
    for i in range(len(rates)):
        rate = 0.0
        for k in range(layout.row_starts[i], layout.row_starts[i + 1]):
            rate += u[layout.columns[k]] * layout.row_values[k]
        rates[i] = rate


@inlined
def _chord_at_rates(cache):
    """
    Return the parameters at which the first plane is met, backwards and forwards.

    Numbers above 0 are ordered as their bits are, taken for a signed whole number; numbers below 0
    have the largest bits of all taken for an unsigned one, and the lowest number the largest. The
    extremes of whole numbers are found several at a time.
    """
    if len(cache.slacks) < LONG:
        most, least = 0.0, 0.0
        for i in range(len(cache.slacks)):
            hurry = cache.rates[i] / cache.slacks[i]
            most, least = max(most, hurry), min(least, hurry)
        return 1.0 / least, 1.0 / most
    for i in range(len(cache.slacks)):
        cache.hurries[i] = cache.rates[i] / cache.slacks[i]
    forwards, backwards = np.int64(0), np.uint64(0)
    for i in range(len(cache.slacks)):
        forwards = max(forwards, cache.hurries_signed[i])
        backwards = max(backwards, cache.hurries_unsigned[i])
    cache.hurries_signed[0] = forwards
    upper = 1.0 / cache.hurries[0]
    cache.hurries_unsigned[0] = backwards
    return 1.0 / cache.hurries[0], upper


@inlined
def _move_at_rates(cache, s, doubt):
    """Change every distance; return how many are too small to be sure of."""
    n_doubtful = 0
    for i in range(len(cache.slacks)):
        slack = cache.slacks[i] - s * cache.rates[i]
        cache.slacks[i] = slack
        n_doubtful += not slack > doubt
    return n_doubtful


@inlined
def _chord_along_sparse_axis(layout, axis, slacks):
    middle = layout.column_starts[axis, 1]
    lower, upper = -math.inf, math.inf
    for k in range(layout.column_starts[axis, 0], middle):
        upper = min(upper, slacks[layout.rows[k]] * layout.inverses[k])
    for k in range(middle, layout.column_starts[axis, 2]):
        lower = max(lower, slacks[layout.rows[k]] * layout.inverses[k])
    return lower, upper


@inlined
def _move_along_sparse_axis(layout, axis, slacks, s, doubt):
    """Change the distances that the axis changes; return how many are too small to be sure of."""
    n_doubtful = 0
    for k in range(layout.column_starts[axis, 0], layout.column_starts[axis, 2]):
        slack = slacks[layout.rows[k]] - s * layout.values[k]
        slacks[layout.rows[k]] = slack
        n_doubtful += not slack > doubt
    return n_doubtful
