"""A compiled space placed in another frame: lines go over into lines with the same parameter."""

from typing import Any, NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.primitives import (
    component,
    contains,
    first_entry,
    first_exit,
    touches,
)
import numpy as np


class PlacedData(NamedTuple):
    """
    A compiled space whose frame a point enters as ``matrix x + offset``.

    Attributes
    ----------
    space : NamedTuple
        The compiled space, in its own frame.
    matrix : (dim, dim)
        Invertible.
    offset : (dim,)
        Where the origin goes.

    """

    space: Any
    matrix: Floats
    offset: Floats


@contains.register(PlacedData)
@kernel
def _contains(placed, x):
    return contains(placed.space, _point(placed, x))


@touches.register(PlacedData)
@kernel
def _touches(placed, x):
    return touches(placed.space, _point(placed, x))


@first_exit.register(PlacedData)
@kernel
def _first_exit(placed, x, u, t, enough):
    return first_exit(placed.space, _point(placed, x), _turned(placed.matrix, u), t, enough)


@first_entry.register(PlacedData)
@kernel
def _first_entry(placed, x, u, t):
    return first_entry(placed.space, _point(placed, x), _turned(placed.matrix, u), t)


@component.register(PlacedData)
@kernel
def _component(placed, x):
    return component(placed.space, _point(placed, x))


@kernel
def _point(placed, x):
    y = _turned(placed.matrix, x)
    for i in range(len(y)):
        y[i] += placed.offset[i]
    return y


@kernel
def _turned(matrix, u):
    v = np.zeros(len(matrix))
    for i in range(len(matrix)):
        for j in range(len(u)):
            v[i] += matrix[i, j] * u[j]
    return v
