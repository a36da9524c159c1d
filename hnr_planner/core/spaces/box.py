"""A box whose sides run along the axes."""

import math
from typing import NamedTuple

from hnr_planner.core.checks import check_point, check_vector, Floats
from hnr_planner.core.errors import SpaceError
from hnr_planner.core.kernels.kernel import inlined
from hnr_planner.core.spaces.bounds import check_bounds
from hnr_planner.core.spaces.convex import convex, count, holds, span
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import ArrayLike


@convex
class BoxData(NamedTuple):
    """
    Compiled boxes, as convex pieces.

    Attributes
    ----------
    lower, upper : (k, dim)
        Their corners.
    max_gap : float
        What may lie between two of them.

    """

    lower: Floats
    upper: Floats
    max_gap: float


class BoxSpace(Space):
    """
    The points above ``lower`` and below ``upper`` in every coordinate.

    Parameters
    ----------
    lower, upper : (dim,)
        Two corners, of any dimension.

    Raises
    ------
    SpaceError
        When the numbers describe no box.

    """

    def __init__(self, lower: ArrayLike, upper: ArrayLike) -> None:
        self.lower = check_vector('lower', lower, SpaceError)
        self.upper = check_vector('upper', upper, SpaceError)
        if self.lower.shape != self.upper.shape:
            raise SpaceError(
                f'lower and upper must be of one dimension, got {len(self.lower)} and '
                f'{len(self.upper)}'
            )
        check_bounds('the box', self.lower, self.upper)
        self.dim = len(self.lower)
        self.data = BoxData(self.lower[np.newaxis].copy(), self.upper[np.newaxis].copy(), 0.0)

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,)."""
        return self.lower.copy(), self.upper.copy()

    def covers_box(self, lower: Floats, upper: Floats) -> bool:
        """Say whether the other box lies in this one, faces included."""
        return bool((self.lower <= lower).all() and (upper <= self.upper).all())

    def why_not_free(self, point: ArrayLike) -> str:
        """Say in words why ``point`` (dim,) is not free."""
        x = check_point('point', point, self.dim)
        i = int(np.argmax(np.maximum(self.lower - x, x - self.upper)))
        return (
            f'outside the box: coordinate {i} is {x[i]:g}, not between {self.lower[i]:g} and '
            f'{self.upper[i]:g}'
        )


@count.register(BoxData)
@inlined
def _count(boxes):
    return len(boxes.lower)


@holds.register(BoxData)
@inlined
def _holds(boxes, k, x, closed):
    for i in range(len(x)):
        below, above = x[i] - boxes.lower[k, i], boxes.upper[k, i] - x[i]
        if not (min(below, above) > 0.0 or (closed and min(below, above) == 0.0)):
            return False
    return True


@span.register(BoxData)
@inlined
def _span(boxes, k, x, u, closed):
    """Cut the line with the two faces across each axis."""
    first, last = -math.inf, math.inf
    for i in range(len(x)):
        below, above = boxes.lower[k, i] - x[i], boxes.upper[k, i] - x[i]
        if u[i] > 0.0:
            first, last = max(first, below / u[i]), min(last, above / u[i])
        elif u[i] < 0.0:
            first, last = max(first, above / u[i]), min(last, below / u[i])
        elif not (below < 0.0 < above or (closed and below <= 0.0 <= above)):
            return math.inf, -math.inf
    if first < last or (closed and first == last):
        return first, last
    return math.inf, -math.inf
