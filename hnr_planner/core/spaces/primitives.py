"""
The primitives: what a compiled space answers, and all that walks and planners ask.

A compiled space is a NamedTuple of arrays, and registers a kernel of its own for each primitive.
Those with a body here follow from the others: a space registers them where it knows better.

Leaving asks for the open set and entering for its closure: what is taken away from a space is
closed, so that free space stays open.
"""

import math
from typing import Any

from hnr_planner.core.kernels.dispatch import dispatched
from hnr_planner.core.kernels.kernel import kernel
import numpy as np


@dispatched
@kernel
def contains(space: Any, x: Any) -> bool:
    """Say whether ``x`` is a free point of ``space``."""
    raise NotImplementedError


@dispatched
@kernel
def touches(space: Any, x: Any) -> bool:
    """Say whether ``x`` is in the closure of the free points: free, or on the boundary."""
    raise NotImplementedError


@dispatched
@kernel
def first_exit(space: Any, x: Any, u: Any, t: float, enough: float) -> float:
    """
    Return the first parameter ``s >= t`` at which the line ``x + s u`` leaves ``space``.

    That is ``t`` itself where the line is out already. Once the line is known to stay inside until
    ``enough`` the search may stop there: any value above ``enough`` is an answer.
    """
    raise NotImplementedError


@dispatched
@kernel
def first_entry(space: Any, x: Any, u: Any, t: float) -> float:
    """Return the first parameter ``s >= t`` at which the line touches ``space``; inf for never."""
    raise NotImplementedError


@dispatched
@kernel
def around(space: Any, x: Any, u: Any, back: Any) -> tuple[float, float]:
    """
    Return the largest open interval of ``x + s u`` around ``s = 0`` that is free.

    For a free point ``x``; ``back`` is ``-u``.
    """
    return -first_exit(space, x, back, 0.0, math.inf), first_exit(space, x, u, 0.0, math.inf)


@dispatched
@kernel
def apart(space: Any, x: Any, u: Any, back: Any) -> tuple[float, float]:
    """
    Return the largest open interval of ``x + s u`` around ``s = 0`` that does not touch ``space``.

    For a point ``x`` that does not; the ends may be infinite, and ``back`` is ``-u``.
    """
    return -first_entry(space, x, back, 0.0), first_entry(space, x, u, 0.0)


@dispatched
@kernel
def component(space: Any, x: Any) -> int:
    """
    Return the number of the connected part of ``space`` that holds ``x``; 0 where it is not free.

    No path leads from one part to another. A space that does not know its parts gives all free
    points the same number.
    """
    return 1 if contains(space, x) else 0


@dispatched
@kernel
def segment_is_free(space: Any, a: Any, b: Any) -> bool:
    """Say whether the closed segment from ``a`` to ``b`` is free: the chord goes beyond ``b``."""
    if not (contains(space, a) and contains(space, b)):
        return False
    u = b - a
    return not u.any() or first_exit(space, a, u, 0.0, 1.0) > 1.0


@dispatched
@kernel
def flood_path(space: Any, start: Any, goal: Any, goal_radius: float, margin: float) -> Any:
    """
    Return a free path (m, dim) from ``start`` into the goal region, wherever there is one.

    It may be long. It ends at ``goal`` for a ``goal_radius`` of 0, else at a point ``margin`` or
    more inside the space. (0, dim) where there is none, or the space does not know.
    """
    return np.empty((0, len(start)))


def kind_of(space: Any) -> tuple[Any, ...]:
    """Return what compiled code is made for: the type of a compiled space and of its parts."""
    return (type(space), *(kind_of(part) for part in space if contains.knows(part)))


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
def chord(space, x, u):
    """Return the ends of the largest free interval of ``x + s u`` around ``s = 0``."""
    if not contains(space, x):
        return 0.0, 0.0
    return around(space, x, u, -u)


@kernel
def first_blocked_segment(space, points):
    """Index of the first segment of a path (m, dim) that is not free; -1 when all are."""
    for k in range(len(points) - 1):
        if not segment_is_free(space, points[k], points[k + 1]):
            return k
    return -1
