"""
The cache of a chain: the chain's point, and what a space stores for the chain between steps.

A walk alternately computes the chord through its point and moves along it. A space may reuse
results of the step before: a polytope stores the distances to its planes, and updates only those
that a step changes. A polytope registers its own versions of the functions of this module; every
other space stores no results.
"""

from functools import singledispatch
from typing import Any, NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.dispatch import dispatched
from hnr_planner.core.kernels.kernel import inlined
from hnr_planner.core.spaces.lines import point_on_line
from hnr_planner.core.spaces.primitives import chord, CompiledSpace, contains

#: Steps of a chain after which its cache is recomputed, so that rounding does not accumulate. They
#: count from the chain's beginning, so that a resumed run gives the same draws to the last bit.
REFRESH = 1024
#: Value of ``axis`` for a direction that is not along an axis.
NO_AXIS = -1


class ChainCache(NamedTuple):
    """
    Position of a chain in a space that caches nothing.

    Attributes
    ----------
    x : (dim,)
        The chain's point.
    y, back : (dim,)
        Work arrays for the next point, and for the opposite direction.

    """

    x: Floats
    y: Floats
    back: Floats


@singledispatch
def memory_size(space: CompiledSpace, dim: int) -> int:
    """Return the number of floats that ``space`` needs for each chain, beside its point."""
    return 2 * dim


@dispatched
@inlined
def open_cache(space: CompiledSpace, x: Floats, memory: Floats) -> Any:
    """
    Return the cache of a chain: views of its point ``x`` (dim,) and of its ``memory``.

    ``memory`` has ``memory_size`` floats. The first two fields of the cache are ``x``, which the
    other kernels move, and ``y`` (dim,), a work array for the next point.
    """
    dim = len(x)
    return ChainCache(x, memory[:dim], memory[dim:])


@dispatched
@inlined
def refresh(space: CompiledSpace, cache: Any) -> None:
    """Recompute the stored results, if there are any, from the chain's point alone."""


@dispatched
@inlined
def count_axes(space: CompiledSpace, dim: int) -> int:
    """Return the number of directions along which coordinate walks move: ``dim`` by default."""
    return dim


@dispatched
@inlined
def set_axis(space: CompiledSpace, u: Floats, axis: int) -> None:
    """Write the direction ``axis``, below ``count_axes``, into ``u`` (dim,), which is zero."""
    u[axis] = 1.0


@dispatched
@inlined
def clear_axis(space: CompiledSpace, u: Floats, axis: int) -> None:
    """Set ``u`` (dim,), which is the direction ``axis``, to zero."""
    u[axis] = 0.0


@dispatched
@inlined
def chord_cached(space: CompiledSpace, cache: Any, u: Floats, axis: int) -> tuple[float, float]:
    """
    Return the chord through the chain's point along ``u`` (dim,): parameters (lower, upper).

    ``axis`` is the index of the axis that ``set_axis`` has written to ``u``, or ``NO_AXIS``, -1.
    """
    for i in range(len(u)):
        cache.back[i] = -u[i]
    return chord(space, cache.x, u, cache.back)


@dispatched
@inlined
def move_along(space: CompiledSpace, cache: Any, u: Floats, axis: int, s: float) -> bool:
    """
    Move the chain to the point at ``s`` of its last chord's line; return whether it moved.

    The chain stays where it is if that rounds to a point that is not free.
    """
    point_on_line(space, cache.x, u, s, cache.y)
    return move_if_free(space, cache)


@inlined
def move_if_free(space, cache):
    """Move the chain to ``cache.y`` if that is a free point; return whether the chain moved."""
    if not contains(space, cache.y):
        return False
    for i in range(len(cache.x)):
        cache.x[i] = cache.y[i]
    return True
