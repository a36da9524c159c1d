"""
The primitives: what a compiled space answers, and all that walks and planners ask.

A compiled space is a NamedTuple of arrays. For its type three kernels are registered:

``contains(space, x) -> bool``
    Whether ``x`` is a free point.
``component(space, x) -> int``
    Which connected part of the space holds ``x``; 0 where it is not free. No path leads from one
    part to another. A space that does not know its parts gives all free points the same number.
``leave(space, x, u, t, enough) -> float``
    The first parameter ``s >= t`` at which the line ``x + s u`` leaves the space; ``t`` itself
    where the line is out already. Once the line is known to stay inside until ``enough`` the
    search may stop there: any value above ``enough`` is an answer.
``sees(space, a, b) -> bool``
    Whether the closed segment from ``a`` to ``b`` is free: the chord goes beyond ``b``.

Compiled code calls them by these names for any space: numba picks the kernel by the type of the
NamedTuple. Interpreted code reaches the same kernels interpreted, so that both can be compared.
"""

import math
from typing import Any, NamedTuple

from hnr_planner.core.kernels import interpreted, kernel
from numba.core.dispatcher import Dispatcher
from numba.extending import overload
import numpy as np


class Primitives(NamedTuple):
    """The kernels of one type of compiled space."""

    contains: Dispatcher
    component: Dispatcher
    leave: Dispatcher
    sees: Dispatcher


_PRIMITIVES: dict[type, Primitives] = {}


def register(data_type: type, primitives: Primitives) -> None:
    """Let the primitives answer for NamedTuples of ``data_type``."""
    _PRIMITIVES[data_type] = primitives


def contains(space: Any, x: Any) -> bool:
    """Say whether ``x`` is a free point of ``space``."""
    return interpreted(_PRIMITIVES[type(space)].contains)(space, x)


def component(space: Any, x: Any) -> int:
    """Return the number of the connected part of ``space`` that holds ``x``; 0 for none."""
    return interpreted(_PRIMITIVES[type(space)].component)(space, x)


def leave(space: Any, x: Any, u: Any, t: float, enough: float) -> float:
    """Return the first parameter >= ``t`` at which the line ``x + s u`` leaves ``space``."""
    return interpreted(_PRIMITIVES[type(space)].leave)(space, x, u, t, enough)


def sees(space: Any, a: Any, b: Any) -> bool:
    """Say whether the closed segment from ``a`` to ``b`` is free."""
    return interpreted(_PRIMITIVES[type(space)].sees)(space, a, b)


@overload(contains)
def _compiled_contains(space, x):
    compiled = _PRIMITIVES[space.instance_class].contains
    return lambda space, x: compiled(space, x)


@overload(component)
def _compiled_component(space, x):
    compiled = _PRIMITIVES[space.instance_class].component
    return lambda space, x: compiled(space, x)


@overload(leave)
def _compiled_leave(space, x, u, t, enough):
    compiled = _PRIMITIVES[space.instance_class].leave
    return lambda space, x, u, t, enough: compiled(space, x, u, t, enough)


@overload(sees)
def _compiled_sees(space, a, b):
    compiled = _PRIMITIVES[space.instance_class].sees
    return lambda space, a, b: compiled(space, a, b)


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
    return -leave(space, x, -u, 0.0, math.inf), leave(space, x, u, 0.0, math.inf)


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
