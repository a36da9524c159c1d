"""The product of spaces, such as position and velocity."""

from itertools import pairwise
import math
from typing import Any, NamedTuple

from hnr_planner.core.checks import check_point, Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.composed import check_members
from hnr_planner.core.spaces.primitives import (
    component,
    contains,
    first_entry,
    first_exit,
    touches,
)
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import ArrayLike

#: No factor has more parts than this.
COMPONENTS_MAX = 2**31


class ProductData(NamedTuple):
    """
    A compiled product of two; that of more is nested.

    Attributes
    ----------
    one, other : NamedTuple
        Compiled spaces.
    split : int
        ``one`` sees the coordinates before it, ``other`` the rest.

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
        At least one; the dimension is the sum of theirs.

    Raises
    ------
    SpaceError
        When there is no factor.

    """

    def __init__(self, *factors: Space) -> None:
        self.factors = check_members(factors)
        ends = np.cumsum([0, *(factor.dim for factor in self.factors)]).tolist()
        self.dim = ends[-1]
        self._slices = [slice(first, last) for first, last in pairwise(ends)]
        self.data = self.factors[0].compiled
        for factor, part in zip(self.factors[1:], self._slices[1:], strict=True):
            self.data = ProductData(self.data, factor.compiled, part.start)

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,)."""
        lower, upper = zip(*(factor.bounds for factor in self.factors), strict=True)
        return np.concatenate(lower), np.concatenate(upper)

    @property
    def typical_clearance(self) -> float:
        """That of the narrowest factor, in the caller's units."""
        return min(factor.typical_clearance * factor.scale for factor in self.factors)

    def covers_box(self, lower: Floats, upper: Floats) -> bool:
        """Say whether every factor is known to."""
        return all(
            factor.covers_box(lower[part], upper[part])
            for factor, part in zip(self.factors, self._slices, strict=True)
        )

    def why_not_free(self, point: ArrayLike) -> str:
        """Say in words why ``point`` (dim,) is not free."""
        x = check_point('point', point, self.dim)
        for k, (factor, part) in enumerate(zip(self.factors, self._slices, strict=True)):
            if not factor.contains(x[part]):
                return f'in factor {k}, coordinates {part.start}..{part.stop - 1}, ' + (
                    factor.why_not_free(x[part])
                )
        return 'not in the space'


@contains.register(ProductData)
@kernel
def _contains(product, x):
    k = product.split
    return contains(product.one, x[:k]) and contains(product.other, x[k:])


@touches.register(ProductData)
@kernel
def _touches(product, x):
    k = product.split
    return touches(product.one, x[:k]) and touches(product.other, x[k:])


@first_exit.register(ProductData)
@kernel
def _first_exit(product, x, u, t, enough):
    """Leave the factor that is left first."""
    k, end = product.split, math.inf
    # A line may stand still in one of the factors.
    if u[:k].any():
        end = first_exit(product.one, x[:k], u[:k], t, enough)
    elif not contains(product.one, x[:k]):
        return t
    if u[k:].any():
        end = min(end, first_exit(product.other, x[k:], u[k:], t, enough))
    elif not contains(product.other, x[k:]):
        return t
    return end


@first_entry.register(ProductData)
@kernel
def _first_entry(product, x, u, t):
    """Go on to where the other factor is entered, until both are at once."""
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
    """Return a number for each pair of parts."""
    k = product.split
    one, other = component(product.one, x[:k]), component(product.other, x[k:])
    return one + COMPONENTS_MAX * (other - 1) if one > 0 and other > 0 else 0
