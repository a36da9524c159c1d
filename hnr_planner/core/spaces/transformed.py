"""A compiled space in another frame: an affine map takes lines to lines, parameters unchanged."""

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
    A compiled space in another frame: a point ``x`` of that frame is ``matrix x + offset``.

    Attributes
    ----------
    space : NamedTuple
        The compiled space, in its own frame.
    matrix : (dim, dim)
        Invertible.
    offset : (dim,)
        Image of the other frame's origin.

    """

    space: Any
    matrix: Floats
    offset: Floats


def shifted(space: CompiledSpace, origin: Floats | None, new: Floats | None) -> CompiledSpace:
    """Return a compiled space with its origin moved from ``origin`` to ``new`` (dim,)."""
    if origin is None and new is None:
        return space
    offset = (0.0 if new is None else new) - (0.0 if origin is None else origin)
    offset = np.asarray(offset)
    return TransformedData(space, np.eye(len(offset)), offset) if offset.any() else space


@contains.register(TransformedData)
@kernel
def _contains(transformed, x):
    """Return whether the image of ``x`` is free."""
    return contains(transformed.space, _point(transformed, x))


@touches.register(TransformedData)
@kernel
def _touches(transformed, x):
    """Return whether the image of ``x`` is in the closure."""
    return touches(transformed.space, _point(transformed, x))


@first_exit.register(TransformedData)
@kernel
def _first_exit(transformed, x, u, t, horizon):
    """Return where the image of the line leaves the space."""
    return first_exit(
        transformed.space, _point(transformed, x), _product(transformed.matrix, u), t, horizon
    )


@first_entry.register(TransformedData)
@kernel
def _first_entry(transformed, x, u, t):
    """Return where the image of the line touches the space."""
    return first_entry(
        transformed.space, _point(transformed, x), _product(transformed.matrix, u), t
    )


@component.register(TransformedData)
@kernel
def _component(transformed, x):
    """Return the component that holds the image of ``x``."""
    return component(transformed.space, _point(transformed, x))


@kernel
def _point(transformed, x):
    """Return the image (dim,) of a point ``x`` (dim,)."""
    y = _product(transformed.matrix, x)
    for i in range(len(y)):
        y[i] += transformed.offset[i]
    return y


@kernel
def _product(matrix, u):
    """Return the product of a matrix (dim, dim) and a vector ``u`` (dim,), in a fixed order."""
    v = np.zeros(len(matrix))
    for i in range(len(matrix)):
        for j in range(len(u)):
            v[i] += matrix[i, j] * u[j]
    return v
