"""A ball in any dimension."""

import math
from typing import NamedTuple

from hnr_planner.core.checks import check_point, check_real, check_vector, Floats
from hnr_planner.core.errors import SpaceError
from hnr_planner.core.kernels.kernel import inlined
from hnr_planner.core.spaces.bounds import check_bounds
from hnr_planner.core.spaces.convex import convex, count, holds, span
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import ArrayLike


@convex
class BallData(NamedTuple):
    """
    Compiled balls, as convex pieces.

    Attributes
    ----------
    centres : (k, dim)
        Their centres.
    radii : (k,)
        Their radii.
    max_gap : float
        What may lie between two of them.

    """

    centres: Floats
    radii: Floats
    max_gap: float


class BallSpace(Space):
    """
    The points nearer than ``radius`` to ``centre``.

    Parameters
    ----------
    centre : (dim,)
        Any dimension.
    radius : float
        Above 0.

    Raises
    ------
    SpaceError
        When the numbers describe no ball.

    """

    def __init__(self, centre: ArrayLike, radius: float) -> None:
        self.centre = check_vector('centre', centre, SpaceError)
        self.radius = check_real('radius', radius, SpaceError)
        if not 0.0 < self.radius < math.inf:
            raise SpaceError(f'radius must be above 0 and finite, got {self.radius!r}')
        self.dim = len(self.centre)
        check_bounds('the ball', *self.bounds)
        self.data = BallData(self.centre[np.newaxis].copy(), np.array([self.radius]), 0.0)

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,)."""
        return self.centre - self.radius, self.centre + self.radius

    @property
    def typical_clearance(self) -> float:
        """Mean distance from a point to the sphere."""
        return self.radius / (self.dim + 1)

    def covers_box(self, lower: Floats, upper: Floats) -> bool:
        """Say whether the corner that is farthest away lies in the closed ball."""
        farthest = np.maximum(np.abs(lower - self.centre), np.abs(upper - self.centre))
        return bool(np.linalg.norm(farthest) <= self.radius)

    def why_not_free(self, point: ArrayLike) -> str:
        """Say in words why ``point`` (dim,) is not free."""
        distance = np.linalg.norm(check_point('point', point, self.dim) - self.centre)
        return f'{distance:g} away from the centre of a ball of radius {self.radius:g}'


@count.register(BallData)
@inlined
def _count(balls):
    return len(balls.radii)


@holds.register(BallData)
@inlined
def _holds(balls, k, x, closed):
    squared = 0.0
    for i in range(len(x)):
        squared += (x[i] - balls.centres[k, i]) ** 2
    excess = squared - balls.radii[k] ** 2
    return excess < 0.0 or (closed and excess == 0.0)


@span.register(BallData)
@inlined
def _span(balls, k, x, u, closed):
    """Solve a s^2 + 2 b s + c = 0, where c has the sign that ``_holds`` sees."""
    a, b, squared = 0.0, 0.0, 0.0
    for i in range(len(x)):
        offset = x[i] - balls.centres[k, i]
        a += u[i] * u[i]
        b += u[i] * offset
        squared += offset * offset
    c = squared - balls.radii[k] ** 2
    discriminant = b * b - a * c
    if discriminant < 0.0 or (discriminant == 0.0 and not closed):
        return math.inf, -math.inf
    root = math.sqrt(discriminant)
    # Of the two forms of each solution, the one that subtracts nothing.
    if b > 0.0:
        return -(b + root) / a, -c / (b + root)
    if root > b:
        return c / (root - b), (root - b) / a
    return 0.0, 0.0
