"""
The cache of a chain in a polytope: the distances from the chain's point to the planes.

A line along ``u`` approaches the planes at the rates ``normals u``; a move by ``s`` subtracts
``s`` times the rates from the distances, without a product with the point. Along an axis the rates
are one column of the normals; where these are stored sparsely, only its nonzero numbers are read.

Rounding lets the distances drift, so they are recomputed every ``REFRESH`` steps, and a move to
less than ``doubt`` from a plane is checked from the point itself: every point of a chain is free.

Lines and moves have a loop each for any direction, and for an axis in the dense and in the sparse
layout of the normals: hence the length of this module.
"""

import math
from typing import Any, NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.spaces.chain_cache import (
    chord_cached,
    clear_axis,
    count_axes,
    memory_size,
    move_along,
    move_if_free,
    NO_AXIS,
    open_cache,
    REFRESH,
    refresh,
    set_axis,
)
from hnr_planner.core.spaces.polytope.planes import LONG, PolytopeData
import numpy as np
from numpy.typing import NDArray

#: Least distance: computed distances that are less are replaced by this one, so that none is 0.
LEAST = float(np.finfo(np.float64).tiny)
#: Largest whole numbers that floats are compared as.
_MOST_SIGNED, _MOST_UNSIGNED = np.int64(2**63 - 1), np.uint64(2**64 - 1)


class PolytopeCache(NamedTuple):
    """
    Position of a chain in a polytope.

    Attributes
    ----------
    x, y : (dim,)
        The chain's point, and a work array for the next point.
    slacks : (m,)
        Distances from the chain's point to the planes.
    rates : (m,)
        Rates at which the line of the last chord approaches the planes.
    ratios : (m,)
        Rates divided by distances: the inverses of the parameters at which the line meets planes.
    ratios_signed, ratios_unsigned : (m,)
        The bits of the ratios as whole numbers, int64 and uint64.

    """

    x: Floats
    y: Floats
    slacks: Floats
    rates: Floats
    ratios: Floats
    ratios_signed: NDArray[np.int64]
    ratios_unsigned: NDArray[np.uint64]


@memory_size.register(PolytopeData)
def _memory_size(polytope: Any, dim: int) -> int:
    """Return the number of floats that store a point, slacks, rates and ratios."""
    return dim + 3 * len(polytope.offsets)


@open_cache.register(PolytopeData)
@inlined
def _open_cache(polytope, x, memory):
    """Return the cache of a chain: views of its point ``x`` (dim,) and of its ``memory``."""
    first, m = len(x), len(polytope.offsets)
    second, third = first + m, first + 2 * m
    ratios = memory[third:]
    return PolytopeCache(
        x=x,
        y=memory[:first],
        slacks=memory[first:second],
        rates=memory[second:third],
        ratios=ratios,
        ratios_signed=ratios.view(np.int64),
        ratios_unsigned=ratios.view(np.uint64),
    )


@refresh.register(PolytopeData)
@kernel
def _refresh(polytope, cache):
    """Compute the distances to the planes from the chain's point."""
    _set_rates(polytope.layout, cache.x, cache.slacks)
    for i in range(len(cache.slacks)):
        cache.slacks[i] = max(polytope.offsets[i] - cache.slacks[i], LEAST)


@count_axes.register(PolytopeData)
@inlined
def _count_axes(polytope, dim):
    """Return the number of directions of coordinate walks."""
    return len(polytope.axes) if len(polytope.axes) > 0 else dim


@set_axis.register(PolytopeData)
@inlined
def _set_axis(polytope, u, axis):
    """Write the direction ``axis`` of coordinate walks into ``u`` (dim,), which is zero."""
    if len(polytope.axes) == 0:
        u[axis] = 1.0
        return
    for i in range(len(u)):
        u[i] = polytope.axes[axis, i]


@clear_axis.register(PolytopeData)
@inlined
def _clear_axis(polytope, u, axis):
    """Set ``u`` (dim,), which is the direction ``axis``, to zero."""
    if len(polytope.axes) == 0:
        u[axis] = 0.0
        return
    for i in range(len(u)):
        u[i] = 0.0


@chord_cached.register(PolytopeData)
@inlined
def _chord_cached(polytope, cache, u, axis):
    """
    Return the chord (lower, upper), from the distances and the rates along ``u`` (dim,).

    The rates are stored for the move that follows, except along an axis.
    """
    layout = polytope.along_axes
    if axis == NO_AXIS:
        _set_rates(polytope.layout, u, cache.rates)
        return _chord_at_rates(cache)
    if _is_dense(layout):
        return _chord_along_dense_axis(layout, axis, cache)
    return _chord_along_sparse_axis(layout, axis, cache.slacks)


@move_along.register(PolytopeData)
@inlined
def _move_along(polytope, cache, u, axis, s):
    """
    Move by ``s`` along ``u``, update the distances, and return whether the chain moved.

    If a distance becomes ``doubt`` or less, the end is checked from the point itself.
    """
    layout = polytope.along_axes
    if axis == NO_AXIS:
        n_doubtful = _move_at_rates(cache, s, polytope.doubt)
    elif _is_dense(layout):
        n_doubtful = _move_along_dense_axis(layout, axis, cache.slacks, s, polytope.doubt)
    else:
        n_doubtful = _move_along_sparse_axis(layout, axis, cache.slacks, s, polytope.doubt)
    if n_doubtful > 0:
        return _move_and_refresh(polytope, cache, u, s)
    if axis == NO_AXIS or len(polytope.axes) > 0:
        for i in range(len(u)):
            cache.x[i] += s * u[i]
    else:
        cache.x[axis] += s
    return True


@kernel
def _move_and_refresh(polytope, cache, u, s):
    """
    Move by ``s`` along ``u`` if the end is free; return whether the chain moved.

    The distances are recomputed from the chain's point in either case.
    """
    for i in range(len(u)):
        cache.y[i] = cache.x[i] + s * u[i]
    is_free = move_if_free(polytope, cache)
    _refresh(polytope, cache)
    return is_free


@inlined
def _is_dense(layout):
    """Return whether the normals are stored densely, in ``layout.dense``."""
    return len(layout.dense) > 0


@inlined
def _set_rates(layout, u, rates):
    """Write the product of the normals and ``u`` (dim,) to ``rates`` (m,)."""
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

    Floats above 0 are ordered like their bits read as a signed whole number; floats below 0 have
    the largest bits read as an unsigned one, the lowest float the largest. So the extremes are
    those of whole numbers, which the compiler vectorizes.
    """
    if len(cache.slacks) < LONG:
        most, least = 0.0, 0.0
        for i in range(len(cache.slacks)):
            ratio = cache.rates[i] / cache.slacks[i]
            most, least = max(most, ratio), min(least, ratio)
        return 1.0 / least, 1.0 / most
    for i in range(len(cache.slacks)):
        cache.ratios[i] = cache.rates[i] / cache.slacks[i]
    forwards, backwards = np.int64(0), np.uint64(0)
    for i in range(len(cache.slacks)):
        forwards = max(forwards, cache.ratios_signed[i])
        backwards = max(backwards, cache.ratios_unsigned[i])
    cache.ratios_signed[0] = forwards
    upper = 1.0 / cache.ratios[0]
    cache.ratios_unsigned[0] = backwards
    return 1.0 / cache.ratios[0], upper


@inlined
def _move_at_rates(cache, s, doubt):
    """Update every distance for a move by ``s``; return how many become ``doubt`` or less."""
    n_doubtful = 0
    for i in range(len(cache.slacks)):
        slack = cache.slacks[i] - s * cache.rates[i]
        cache.slacks[i] = slack
        n_doubtful += not slack > doubt
    return n_doubtful


@inlined
def _chord_along_dense_axis(layout, axis, cache):
    """
    Return the chord (lower, upper) along an axis, from the inverses of all rates.

    The parameters at which the line meets planes are compared by their bits, as the ratios of
    ``_chord_at_rates`` are: here the smallest above 0 and the largest below 0 are wanted.
    """
    for i in range(len(cache.slacks)):
        cache.ratios[i] = cache.slacks[i] * layout.dense_inverses[axis, i]
    backwards, forwards = _MOST_SIGNED, _MOST_UNSIGNED
    for i in range(len(cache.slacks)):
        backwards = min(backwards, cache.ratios_signed[i])
        forwards = min(forwards, cache.ratios_unsigned[i])
    cache.ratios_signed[0] = backwards
    lower = cache.ratios[0]
    cache.ratios_unsigned[0] = forwards
    return lower, cache.ratios[0]


@inlined
def _move_along_dense_axis(layout, axis, slacks, s, doubt):
    """
    Update every distance for a move by ``s`` along an axis.

    Return how many become ``doubt`` or less: too short to decide by their sign, after rounding.
    """
    n_doubtful = 0
    for i in range(len(slacks)):
        slack = slacks[i] - s * layout.dense[axis, i]
        slacks[i] = slack
        n_doubtful += not slack > doubt
    return n_doubtful


@inlined
def _chord_along_sparse_axis(layout, axis, slacks):
    """Return the chord (lower, upper) along an axis, from the nonzero numbers of its column."""
    middle = layout.column_starts[axis, 1]
    lower, upper = -math.inf, math.inf
    for k in range(layout.column_starts[axis, 0], middle):
        upper = min(upper, slacks[layout.rows[k]] * layout.inverses[k])
    for k in range(middle, layout.column_starts[axis, 2]):
        lower = max(lower, slacks[layout.rows[k]] * layout.inverses[k])
    return lower, upper


@inlined
def _move_along_sparse_axis(layout, axis, slacks, s, doubt):
    """
    Update the distances that a move by ``s`` along an axis changes.

    Return how many of them become ``doubt`` or less.
    """
    n_doubtful = 0
    for k in range(layout.column_starts[axis, 0], layout.column_starts[axis, 2]):
        slack = slacks[layout.rows[k]] - s * layout.values[k]
        slacks[layout.rows[k]] = slack
        n_doubtful += not slack > doubt
    return n_doubtful


def largest_error(normals: Floats, offsets: Floats, lower: Floats, upper: Floats) -> float:
    """
    Return a bound on the rounding error of a distance to a plane after ``REFRESH`` updates.

    ``lower`` and ``upper`` (dim,) are the corners of a box that holds the chain.
    """
    reach = np.abs(normals) @ np.maximum(np.abs(lower), np.abs(upper)) + np.abs(offsets)
    largest = float(reach.max() + np.linalg.norm(upper - lower))
    return REFRESH * (4 + len(lower)) * float(np.finfo(np.float64).eps) * largest
