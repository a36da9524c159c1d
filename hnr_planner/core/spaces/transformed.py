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


class TransformedData(NamedTuple):
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


@contains.register(TransformedData)
@kernel
def _contains(transformed, x):
    return contains(transformed.space, _point(transformed, x))


@touches.register(TransformedData)
@kernel
def _touches(transformed, x):
    return touches(transformed.space, _point(transformed, x))


@first_exit.register(TransformedData)
@kernel
def _first_exit(transformed, x, u, t, enough):
    return first_exit(
        transformed.space, _point(transformed, x), _rotated(transformed.matrix, u), t, enough
    )


@first_entry.register(TransformedData)
@kernel
def _first_entry(transformed, x, u, t):
    return first_entry(
        transformed.space, _point(transformed, x), _rotated(transformed.matrix, u), t
    )


@component.register(TransformedData)
@kernel
def _component(transformed, x):
    return component(transformed.space, _point(transformed, x))


@kernel
def _point(transformed, x):
    y = _rotated(transformed.matrix, x)
    for i in range(len(y)):
        y[i] += transformed.offset[i]
    return y


@kernel
def _rotated(matrix, u):
    v = np.zeros(len(matrix))
    for i in range(len(matrix)):
        for j in range(len(u)):
            v[i] += matrix[i, j] * u[j]
    return v
