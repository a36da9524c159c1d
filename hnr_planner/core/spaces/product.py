"""
The product of spaces: each factor limits its own consecutive coordinates of a point.

For example, the first factor limits the position of a robot, and the second its velocity.
"""

from functools import cached_property
from itertools import pairwise
import math
from typing import Any, NamedTuple

from hnr_planner.core.checks import check_point, Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.bounds import kernel_origin
from hnr_planner.core.spaces.composed import check_members
from hnr_planner.core.spaces.primitives import (
    CompiledSpace,
    component,
    contains,
    first_entry,
    first_exit,
    touches,
)
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import ArrayLike

#: Bound on the number of components of a factor.
COMPONENTS_MAX = 2**31


class ProductData(NamedTuple):
    """
    A compiled product of two spaces; in a product of more, ``one`` is itself a product.

    Attributes
    ----------
    one, other : NamedTuple
        Compiled spaces, each in its own coordinates.
    split : int
        Number of coordinates of ``one``; ``other`` has the rest.

    """

    one: Any
    other: Any
    split: int


class ProductSpace(Space):
    """
    The points whose first coordinates lie in the first factor, the next in the second, and so on.

    Parameters
    ----------
    *factors : Space
        The factors, at least one; the dimension of the product is the sum of their dimensions.

    Raises
    ------
    SpaceError
        When there is no factor.

    Attributes
    ----------
    factors : tuple of Space

    """

    def __init__(self, *factors: Space) -> None:
        self.factors = check_members(factors)
        ends = np.cumsum([0, *(factor.dim for factor in self.factors)]).tolist()
        self.dim = ends[-1]
        self._slices = [slice(first, last) for first, last in pairwise(ends)]
        self._kernel_origin = kernel_origin(*self.bounds)

    def __repr__(self) -> str:
        """Name the factors."""
        return f'ProductSpace(dim={self.dim}, factors={self.factors!r})'

    @cached_property
    def data(self) -> CompiledSpace:
        """The compiled product, in the kernel frame."""
        return self.compiled_at(self._kernel_origin)

    def compiled_at(self, origin: Floats | None) -> CompiledSpace:
        """
        Return the compiled product, its coordinates along the caller's axes from ``origin``.

        ``origin`` (dim,) is a point of the caller's frame; None keeps the caller's own origin.
        """
        compiled = [
            factor.compiled_at(None if origin is None else origin[own])
            for factor, own in zip(self.factors, self._slices, strict=True)
        ]
        product = compiled[0]
        for factor, own in zip(compiled[1:], self._slices[1:], strict=True):
            product = ProductData(product, factor, own.start)
        return product

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,), caller's frame."""
        lower, upper = zip(*(factor.bounds for factor in self.factors), strict=True)
        return np.concatenate(lower), np.concatenate(upper)

    @cached_property
    def typical_clearance(self) -> float:
        """Typical clearance of the narrowest factor, in the caller's units."""
        return min(factor.typical_clearance * factor.scale for factor in self.factors)

    def covers_box(self, lower: Floats, upper: Floats) -> bool:
        """
        Return whether every factor is known to cover its own coordinates of a box.

        ``lower`` and ``upper`` (dim,) are the corners of the box.
        """
        return all(
            factor.covers_box(lower[own], upper[own])
            for factor, own in zip(self.factors, self._slices, strict=True)
        )

    def why_not_free(self, point: ArrayLike) -> str:
        """Return the reason why ``point`` (dim,) is not free."""
        x = check_point('point', point, self.dim)
        for k, (factor, own) in enumerate(zip(self.factors, self._slices, strict=True)):
            if not factor.contains(x[own]):
                return f'in factor {k}, coordinates {own.start}..{own.stop - 1}, ' + (
                    factor.why_not_free(x[own])
                )
        return 'not in the space'


@contains.register(ProductData)
@kernel
def _contains(product, x):
    """Return whether each factor contains its coordinates of ``x``."""
    k = product.split
    return contains(product.one, x[:k]) and contains(product.other, x[k:])


@touches.register(ProductData)
@kernel
def _touches(product, x):
    """Return whether the closure of each factor contains its coordinates of ``x``."""
    k = product.split
    return touches(product.one, x[:k]) and touches(product.other, x[k:])


@first_exit.register(ProductData)
@kernel
def _first_exit(product, x, u, t, horizon):
    """Return the first parameter from ``t`` on at which the line leaves either factor."""
    k, end = product.split, math.inf
    # The line may be a single point in one of the factors.
    if u[:k].any():
        end = first_exit(product.one, x[:k], u[:k], t, horizon)
    elif not contains(product.one, x[:k]):
        return t
    if u[k:].any():
        end = min(end, first_exit(product.other, x[k:], u[k:], t, horizon))
    elif not contains(product.other, x[k:]):
        return t
    return end


@first_entry.register(ProductData)
@kernel
def _first_entry(product, x, u, t):
    """Return the first parameter from ``t`` on at which the line touches both factors, or inf."""
    k = product.split
    moves, other_moves = u[:k].any(), u[k:].any()
    if not (moves or touches(product.one, x[:k])):
        return math.inf
    if not (other_moves or touches(product.other, x[k:])):
        return math.inf
    before, s = -math.inf, t
    while before < s < math.inf:
        before = s
        if moves:
            s = first_entry(product.one, x[:k], u[:k], s)
        if other_moves and s < math.inf:
            s = first_entry(product.other, x[k:], u[k:], s)
    return s


@component.register(ProductData)
@kernel
def _component(product, x):
    """Return one number for the components of both factors that hold ``x``; 0 if either is 0."""
    k = product.split
    one, other = component(product.one, x[:k]), component(product.other, x[k:])
    return one + COMPONENTS_MAX * (other - 1) if one > 0 and other > 0 else 0
