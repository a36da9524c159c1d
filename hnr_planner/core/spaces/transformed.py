"""
A compiled space in another frame, from which an affine map leads to its own frame.

An affine map takes lines to lines, with unchanged parameters: so chords need no conversion.
"""

from typing import Any, NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.primitives import (
    CompiledSpace,
    component,
    contains,
    first_entry,
    first_exit,
    touches,
)
import numpy as np


class TransformedData(NamedTuple):
    """
    A compiled space in another frame: ``x`` there is ``matrix x + offset`` in its own frame.

    Attributes
    ----------
    space : NamedTuple
        The compiled space, in its own frame.
    matrix : (dim, dim)
        Invertible matrix from the other frame to the own frame of the space.
    offset : (dim,)
        The other frame's origin, in the own frame of the space.

    """

    space: Any
    matrix: Floats
    offset: Floats


def shifted(space: CompiledSpace, origin: Floats | None, new: Floats | None) -> CompiledSpace:
    """
    Return a compiled space with its origin moved from ``origin`` to ``new`` (dim,).

    Both are points of one frame, with parallel axes; None is its zero point.
    """
    if origin is None and new is None:
        return space
    offset = (0.0 if new is None else new) - (0.0 if origin is None else origin)
    offset = np.asarray(offset)
    return TransformedData(space, np.eye(len(offset)), offset) if offset.any() else space


@contains.register(TransformedData)
@kernel
def _contains(transformed, x):
    """Return whether ``x`` (dim,), converted to the frame of the space, is free."""
    return contains(transformed.space, _point(transformed, x))


@touches.register(TransformedData)
@kernel
def _touches(transformed, x):
    """Return whether ``x`` (dim,), converted to the frame of the space, is in its closure."""
    return touches(transformed.space, _point(transformed, x))


@first_exit.register(TransformedData)
@kernel
def _first_exit(transformed, x, u, t, horizon):
    """Return the first parameter from ``t`` on at which the converted line leaves the space."""
    return first_exit(
        transformed.space, _point(transformed, x), product(transformed.matrix, u), t, horizon
    )


@first_entry.register(TransformedData)
@kernel
def _first_entry(transformed, x, u, t):
    """Return the first parameter from ``t`` on at which the converted line touches the space."""
    return first_entry(
        transformed.space, _point(transformed, x), product(transformed.matrix, u), t
    )


@component.register(TransformedData)
@kernel
def _component(transformed, x):
    """Return the component, from 1, that holds ``x`` (dim,); 0 where ``x`` is not free."""
    return component(transformed.space, _point(transformed, x))


@kernel
def _point(transformed, x):
    """Return a point ``x`` (dim,) of the other frame in the own frame of the space."""
    y = product(transformed.matrix, x)
    for i in range(len(y)):
        y[i] += transformed.offset[i]
    return y


@kernel
def product(matrix, u):
    """Return the product of a matrix (dim, dim) and a vector ``u`` (dim,), in a fixed order."""
    v = np.zeros(len(matrix))
    for i in range(len(matrix)):
        for j in range(len(u)):
            v[i] += matrix[i, j] * u[j]
    return v


@kernel
def multiply(columns, u, v):
    """
    Write the product of a matrix, given by its columns (k, m), and ``u`` (k,) into ``v`` (m,).

    The numbers are those of ``product``; column by column the compiler vectorizes.
    """
    for i in range(len(v)):
        v[i] = 0.0
    for j in range(len(u)):
        for i in range(len(v)):
            v[i] += columns[j, i] * u[j]
