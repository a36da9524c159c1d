"""
The primitives: what a compiled space answers, and all that walks and planners ask.

A compiled space is a NamedTuple of arrays. For its type these kernels are registered:

``contains(space, x) -> bool``
    Whether ``x`` is a free point.
``touches(space, x) -> bool``
    Whether ``x`` is in the closure of the free points: free, or on the boundary.
``leave(space, x, u, t, enough) -> float``
    The first parameter ``s >= t`` at which the line ``x + s u`` leaves the space; ``t`` itself
    where the line is out already. Once the line is known to stay inside until ``enough`` the
    search may stop there: any value above ``enough`` is an answer.
``enter(space, x, u, t) -> float``
    The first parameter ``s >= t`` at which the line touches the space; inf where it never does.
``around(space, x, u, back) -> (float, float)``
    The largest open interval of the line ``x + s u`` around ``s = 0`` that is free, for a free
    point ``x``; ``back`` is ``-u``.
``apart(space, x, u, back) -> (float, float)``
    The largest one that does not touch the space, for a point that does not; ends may be infinite.
``component(space, x) -> int``
    Which connected part of the space holds ``x``; 0 where it is not free. No path leads from one
    part to another. A space that does not know its parts gives all free points the same number.
``sees(space, a, b) -> bool``
    Whether the closed segment from ``a`` to ``b`` is free: the chord goes beyond ``b``.

Leaving asks for the open set and entering for its closure: what is taken away from a space is
closed, so that free space stays open. Compiled code calls the primitives by these names for any
space: numba picks the kernel by the type of the NamedTuple. Interpreted code reaches the same
kernels interpreted, so that both can be compared.
"""

from functools import cache
import math
from typing import Any, NamedTuple

from hnr_planner.core.kernels import compiled_apart, INLINED, interpreted, kernel
from numba.core.dispatcher import Dispatcher
from numba.extending import overload
import numpy as np


def contains(space: Any, x: Any) -> bool:
    """Say whether ``x`` is a free point of ``space``."""
    return interpreted(_PRIMITIVES[type(space)].contains)(space, x)


def touches(space: Any, x: Any) -> bool:
    """Say whether ``x`` is a free point of ``space`` or on its boundary."""
    return interpreted(_PRIMITIVES[type(space)].touches)(space, x)


def leave(space: Any, x: Any, u: Any, t: float, enough: float) -> float:
    """Return the first parameter >= ``t`` at which the line ``x + s u`` leaves ``space``."""
    return interpreted(_PRIMITIVES[type(space)].leave)(space, x, u, t, enough)


def enter(space: Any, x: Any, u: Any, t: float) -> float:
    """Return the first parameter >= ``t`` at which the line ``x + s u`` touches ``space``."""
    return interpreted(_PRIMITIVES[type(space)].enter)(space, x, u, t)


def around(space: Any, x: Any, u: Any, back: Any) -> tuple[float, float]:
    """Return the largest free interval of the line ``x + s u`` around ``s = 0``."""
    return interpreted(_PRIMITIVES[type(space)].around)(space, x, u, back)


def apart(space: Any, x: Any, u: Any, back: Any) -> tuple[float, float]:
    """Return the largest interval around ``s = 0`` that does not touch ``space``."""
    return interpreted(_PRIMITIVES[type(space)].apart)(space, x, u, back)


def component(space: Any, x: Any) -> int:
    """Return the number of the connected part of ``space`` that holds ``x``; 0 for none."""
    return interpreted(_PRIMITIVES[type(space)].component)(space, x)


def sees(space: Any, a: Any, b: Any) -> bool:
    """Say whether the closed segment from ``a`` to ``b`` is free."""
    return interpreted(_PRIMITIVES[type(space)].sees)(space, a, b)


@cache
def _own(function: Dispatcher, space_type: Any) -> Dispatcher:
    """
    Compile a primitive apart for each type of space.

    The primitives of a composed space call those of its parts, which may be composed as well: to
    numba a kernel that calls itself for other types, which it cannot link.
    """
    return compiled_apart(function)


@overload(contains, jit_options=INLINED)
def _compiled_contains(space, x):
    compiled = _own(_PRIMITIVES[space.instance_class].contains, space)
    return lambda space, x: compiled(space, x)


@overload(touches, jit_options=INLINED)
def _compiled_touches(space, x):
    compiled = _own(_PRIMITIVES[space.instance_class].touches, space)
    return lambda space, x: compiled(space, x)


@overload(leave, jit_options=INLINED)
def _compiled_leave(space, x, u, t, enough):
    compiled = _own(_PRIMITIVES[space.instance_class].leave, space)
    return lambda space, x, u, t, enough: compiled(space, x, u, t, enough)


@overload(enter, jit_options=INLINED)
def _compiled_enter(space, x, u, t):
    compiled = _own(_PRIMITIVES[space.instance_class].enter, space)
    return lambda space, x, u, t: compiled(space, x, u, t)


@overload(around, jit_options=INLINED)
def _compiled_around(space, x, u, back):
    compiled = _own(_PRIMITIVES[space.instance_class].around, space)
    return lambda space, x, u, back: compiled(space, x, u, back)


@overload(apart, jit_options=INLINED)
def _compiled_apart(space, x, u, back):
    compiled = _own(_PRIMITIVES[space.instance_class].apart, space)
    return lambda space, x, u, back: compiled(space, x, u, back)


@overload(component, jit_options=INLINED)
def _compiled_component(space, x):
    compiled = _own(_PRIMITIVES[space.instance_class].component, space)
    return lambda space, x: compiled(space, x)


@overload(sees, jit_options=INLINED)
def _compiled_sees(space, a, b):
    compiled = _own(_PRIMITIVES[space.instance_class].sees, space)
    return lambda space, a, b: compiled(space, a, b)


@kernel
def around_by_leaving(space, x, u, back):
    """Leave the space both ways: ``around`` for any space."""
    return -leave(space, x, back, 0.0, math.inf), leave(space, x, u, 0.0, math.inf)


@kernel
def _apart_by_entering(space, x, u, back):
    return -enter(space, x, back, 0.0), enter(space, x, u, 0.0)


@kernel
def _one_part(space, x):
    return 1 if contains(space, x) else 0


@kernel
def _sees_by_leaving(space, a, b):
    if not (contains(space, a) and contains(space, b)):
        return False
    u = b - a
    return not u.any() or leave(space, a, u, 0.0, 1.0) > 1.0


class Primitives(NamedTuple):
    """The kernels of one type of compiled space."""

    contains: Dispatcher
    touches: Dispatcher
    leave: Dispatcher
    enter: Dispatcher
    component: Dispatcher = _one_part
    sees: Dispatcher = _sees_by_leaving
    around: Dispatcher = around_by_leaving
    apart: Dispatcher = _apart_by_entering


_PRIMITIVES: dict[type, Primitives] = {}


def register(data_type: type, primitives: Primitives) -> None:
    """Let the primitives answer for NamedTuples of ``data_type``."""
    _PRIMITIVES[data_type] = primitives


def kind_of(space: Any) -> tuple[Any, ...]:
    """Return what compiled code is made for: the type of a compiled space and of its parts."""
    return (type(space), *(kind_of(part) for part in space if type(part) in _PRIMITIVES))


@kernel
def are_free(space, points):
    """Say which of ``points`` (k, dim) are free: (k,) bool."""
    free = np.empty(len(points), dtype=np.bool_)
    for k in range(len(points)):
        free[k] = contains(space, points[k])
    return free


@kernel
def contains_around(space, x, slack):
    """Say whether ``x`` stays free when any of its coordinates changes by ``slack``."""
    y = x.copy()
    for i in range(len(x)):
        for offset in (-slack, slack):
            y[i] = x[i] + offset
            if not contains(space, y):
                return False
        y[i] = x[i]
    return contains(space, x)


@kernel
def part_of(space, x):
    """Return the number of the connected part that holds ``x``: ``component`` for Python."""
    return component(space, x)


@kernel
def chord(space, x, u):
    """Return the ends of the largest free interval of ``x + s u`` around ``s = 0``."""
    if not contains(space, x):
        return 0.0, 0.0
    return around(space, x, u, -u)


@kernel
def sees_from(space, a, b):
    """Say whether the closed segment from ``a`` to ``b`` is free: ``sees`` for Python."""
    return sees(space, a, b)


@kernel
def first_blocked_segment(space, points):
    """Index of the first segment of a path (m, dim) that is not free; -1 when all are."""
    for k in range(len(points) - 1):
        if not sees(space, points[k], points[k + 1]):
            return k
    return -1
