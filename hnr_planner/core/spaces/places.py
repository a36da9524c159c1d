"""
Places: where a chain stands, and what a space keeps about it from one step to the next.

A walk asks for the chord through a point and then moves along it, again and again. A space that
remembers what it worked out there answers the next question with less work: a polytope keeps the
distances to its planes, and changes only those that a step changes. For the type of such a space
these kernels are registered; every other space uses those below, which remember nothing:

``memory_size(space, dim) -> int``
    How many numbers the space keeps for each chain.
``place(space, x, memory) -> NamedTuple``
    Views of a chain's point ``x`` and of its memory, that the other kernels work on; the first
    two fields are ``x``, which they move, and ``y`` (dim,), room for another point.
``remember(space, place)``
    Work out anew, from the point alone, all that is remembered.
``chord_at(space, place, u, axis) -> (float, float)``
    The largest free interval of the line ``x + s u`` around ``s = 0``. ``axis`` says which unit
    vector ``u`` is, and ``NO_AXIS`` that it is none.
``move_along(space, place, u, axis, s) -> bool``
    Move to ``x + s u`` on the line whose chord was asked last; or stay, and return False, where
    that rounds to a point that is not free.
"""

from typing import Any, NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels import INLINED, inlined, interpreted, kernel
from hnr_planner.core.spaces.primitives import around, contains
from numba.core.dispatcher import Dispatcher
from numba.extending import overload

#: Steps after which a chain has all that is remembered worked out anew, so that rounding does not
#: add up. They count from its beginning: a run that was stopped goes on to the same last bit.
REFRESH = 1024
#: Says that a direction is not that of an axis.
NO_AXIS = -1


class Place(NamedTuple):
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


@kernel
def _memory_size(space, dim):
    return 2 * dim


@inlined
def _place(space, x, memory):
    dim = len(x)
    return Place(x, memory[:dim], memory[dim:])


@inlined
def _remember(space, place):
    pass


@inlined
def _chord_at(space, place, u, axis):
    for i in range(len(u)):
        place.back[i] = -u[i]
    return around(space, place.x, u, place.back)


@inlined
def _move_along(space, place, u, axis, s):
    for i in range(len(u)):
        place.y[i] = place.x[i] + s * u[i]
    return move_if_free(space, place)


@inlined
def move_if_free(space, place):
    """Move to ``place.y`` if that is a free point; say whether it is."""
    if not contains(space, place.y):
        return False
    for i in range(len(place.x)):
        place.x[i] = place.y[i]
    return True


class Places(NamedTuple):
    """The kernels of one type of compiled space."""

    memory_size: Dispatcher = _memory_size
    place: Dispatcher = _place
    remember: Dispatcher = _remember
    chord_at: Dispatcher = _chord_at
    move_along: Dispatcher = _move_along


_WITHOUT_MEMORY = Places()
_PLACES: dict[type, Places] = {}


def register_places(data_type: type, places: Places) -> None:
    """Let NamedTuples of ``data_type`` remember."""
    _PLACES[data_type] = places


def _of(data_type: type) -> Places:
    return _PLACES.get(data_type, _WITHOUT_MEMORY)


def memory_size(space: Any, dim: int) -> int:
    """Return how many numbers ``space`` keeps for each chain."""
    return int(interpreted(_of(type(space)).memory_size)(space, dim))


def place(space: Any, x: Any, memory: Any) -> Any:
    """Return views of a chain's point and of its memory."""
    return interpreted(_of(type(space)).place)(space, x, memory)


def remember(space: Any, place: Any) -> None:
    """Work out anew all that is remembered of the point."""
    interpreted(_of(type(space)).remember)(space, place)


def chord_at(space: Any, place: Any, u: Any, axis: int) -> tuple[float, float]:
    """Return the largest free interval of a line around the point."""
    return interpreted(_of(type(space)).chord_at)(space, place, u, axis)


def move_along(space: Any, place: Any, u: Any, axis: int, s: float) -> bool:
    """Move along the line whose chord was asked last, or say that the end is not free."""
    return interpreted(_of(type(space)).move_along)(space, place, u, axis, s)


@overload(place, jit_options=INLINED)
def _compiled_place(space, x, memory):
    compiled = _of(space.instance_class).place
    return lambda space, x, memory: compiled(space, x, memory)


@overload(remember, jit_options=INLINED)
def _compiled_remember(space, place):
    compiled = _of(space.instance_class).remember
    return lambda space, place: compiled(space, place)


@overload(chord_at, jit_options=INLINED)
def _compiled_chord_at(space, place, u, axis):
    compiled = _of(space.instance_class).chord_at
    return lambda space, place, u, axis: compiled(space, place, u, axis)


@overload(move_along, jit_options=INLINED)
def _compiled_move_along(space, place, u, axis, s):
    compiled = _of(space.instance_class).move_along
    return lambda space, place, u, axis, s: compiled(space, place, u, axis, s)
