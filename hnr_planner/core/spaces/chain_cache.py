"""
Places: where a chain stands, and what a space keeps about it from one step to the next.

A walk asks for the chord through a point and then moves along it, again and again. A space that
remembers what it worked out there answers the next question with less work: a polytope keeps the
distances to its planes, and changes only those that a step changes. It registers kernels of its
own for what follows; every other space remembers nothing.
"""

from typing import Any, NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.dispatch import dispatched
from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.spaces.primitives import chord, contains

#: Steps after which a chain has all that is remembered worked out anew, so that rounding does not
#: add up. They count from its beginning: a run that was stopped goes on to the same last bit.
REFRESH = 1024
#: Says that a direction is not that of an axis.
NO_AXIS = -1


class ChainCache(NamedTuple):
    """
    Where a chain stands in a space that remembers nothing.

    Attributes
    ----------
    x : (dim,)
        The chain's point.
    y, back : (dim,)
        Room for the next one, and for the opposite direction.

    """

    x: Floats
    y: Floats
    back: Floats


@dispatched
@kernel
def memory_size(space: Any, dim: int) -> int:
    """Return how many numbers ``space`` keeps for each chain."""
    return 2 * dim


@dispatched
@inlined
def open_cache(space: Any, x: Any, memory: Any) -> Any:
    """
    Return views of a chain's point ``x`` and of its memory, that the other kernels work on.

    The first two fields are ``x``, which they move, and ``y`` (dim,), room for another point.
    """
    dim = len(x)
    return ChainCache(x, memory[:dim], memory[dim:])


@dispatched
@inlined
def refresh(space: Any, cache: Any) -> None:
    """Work out anew, from the point alone, all that is remembered."""


@dispatched
@inlined
def chord_cached(space: Any, cache: Any, u: Any, axis: int) -> tuple[float, float]:
    """
    Return the largest free interval of the line ``x + s u`` around ``s = 0``.

    ``axis`` says which unit vector ``u`` is, and ``NO_AXIS`` that it is none.
    """
    for i in range(len(u)):
        cache.back[i] = -u[i]
    return chord(space, cache.x, u, cache.back)


@dispatched
@inlined
def move_along(space: Any, cache: Any, u: Any, axis: int, s: float) -> bool:
    """
    Move to ``x + s u`` on the line whose chord was asked last.

    Or stay, and return False, where that rounds to a point that is not free.
    """
    for i in range(len(u)):
        cache.y[i] = cache.x[i] + s * u[i]
    return move_if_free(space, cache)


@inlined
def move_if_free(space, cache):
    """Move to ``cache.y`` if that is a free point; say whether it is."""
    if not contains(space, cache.y):
        return False
    for i in range(len(cache.x)):
        cache.x[i] = cache.y[i]
    return True
