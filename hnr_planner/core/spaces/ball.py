"""An open ball as a space, in any dimension."""

from functools import cached_property
import math
from typing import NamedTuple

from hnr_planner.core.checks import check_point, check_real, check_vector, Floats
from hnr_planner.core.errors import SpaceError
from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.spaces.bounds import check_bounds, in_words, kernel_origin
from hnr_planner.core.spaces.convex import convex, count_pieces, piece_contains, piece_span
from hnr_planner.core.spaces.curves.curve import first_exit_on_curve
from hnr_planner.core.spaces.curves.surfaces import (
    add_crossings,
    add_sphere_crossings,
    first_exit_between_surfaces,
    max_gap_of,
    own_max_gap,
)
from hnr_planner.core.spaces.primitives import longest_apart
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import ArrayLike

#: Rounding of a distance, as a fraction of it.
ROUNDING = 1e-14


@convex
class BallData(NamedTuple):
    """
    Compiled balls, as convex pieces.

    Attributes
    ----------
    centres : (k, dim)
        Centres of the balls.
    radii : (k,)
        Radii of the balls.
    max_gap : float
        Longest gap between two balls that counts as free: a ray passes over it.

    """

    centres: Floats
    radii: Floats
    max_gap: float

    @property
    def boxes(self) -> tuple[Floats, Floats]:
        """Lower and upper corners (k, dim) of boxes around the balls."""
        radii = self.radii[:, np.newaxis]
        return self.centres - radii, self.centres + radii

    @property
    def tree_from(self) -> int:
        """Number of balls from which a tree over them makes chords faster (measured)."""
        return 128


class BallSpace(Space):
    """
    The points nearer than ``radius`` to ``centre``: an open ball.

    Parameters
    ----------
    centre : (dim,)
        Centre of the ball, of any dimension.
    radius : float
        Radius of the ball, above 0.

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
        self._kernel_origin = kernel_origin(*self.bounds)
        self.data = self.compiled_at(self._kernel_origin)

    def __repr__(self) -> str:
        """Name the centre and the radius."""
        return f'BallSpace(centre={in_words(self.centre)}, radius={self.radius:g})'

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,), caller's frame."""
        return self.centre - self.radius, self.centre + self.radius

    @cached_property
    def typical_clearance(self) -> float:
        """Mean distance from a point of the ball to the sphere, exact."""
        return self.radius / (self.dim + 1)

    def compiled_at(self, origin: Floats | None) -> BallData:
        """
        Return the compiled ball with coordinates counted from ``origin``, along the caller's axes.

        ``origin`` (dim,) is a point of the caller's frame; None keeps the caller's own origin.
        """
        shift = np.zeros(self.dim) if origin is None else origin
        return BallData((self.centre - shift)[np.newaxis], np.array([self.radius]), 0.0)

    def covers_box(self, lower: Floats, upper: Floats) -> bool:
        """Return whether the closed ball contains the box between two corners (dim,)."""
        farthest = np.maximum(np.abs(lower - self.centre), np.abs(upper - self.centre))
        return bool(np.linalg.norm(farthest) <= self.radius)

    def why_not_free(self, point: ArrayLike) -> str:
        """Return the reason why ``point`` (dim,) is not free."""
        distance = np.linalg.norm(check_point('point', point, self.dim) - self.centre)
        return f'{distance:g} away from the centre of a ball of radius {self.radius:g}'


first_exit_on_curve.register(BallData)(first_exit_between_surfaces)
max_gap_of.register(BallData)(own_max_gap)


@count_pieces.register(BallData)
@inlined
def _count_pieces(balls):
    """Return the number of balls."""
    return len(balls.radii)


@piece_contains.register(BallData)
@inlined
def _piece_contains(balls, k, x, closed):
    """Return whether ball ``k`` contains ``x`` (dim,), its sphere included when ``closed``."""
    squared = 0.0
    for i in range(len(x)):
        squared += (x[i] - balls.centres[k, i]) ** 2
    excess = squared - balls.radii[k] ** 2
    return excess < 0.0 or (closed and excess == 0.0)


@piece_span.register(BallData)
@inlined
def _piece_span(balls, k, x, u, closed):
    """Return the interval of the line ``x + s u`` in ball ``k``; (inf, -inf) for none."""
    a, b, squared = 0.0, 0.0, 0.0
    for i in range(len(x)):
        offset = x[i] - balls.centres[k, i]
        a += u[i] * u[i]
        b += u[i] * offset
        squared += offset * offset
    return _between_roots(a, b, squared - balls.radii[k] ** 2, closed)


@inlined
def _between_roots(a, b, c, closed):
    """
    Return the interval of s at which a s^2 + 2 b s + c is below 0: its ends are the roots.

    It is (inf, -inf) where there is none; a single point counts when ``closed``.
    """
    discriminant = b * b - a * c
    if discriminant < 0.0 or (discriminant == 0.0 and not closed):
        return math.inf, -math.inf
    root = math.sqrt(discriminant)
    # Of the two forms of each solution take the one without cancellation.
    if b > 0.0:
        return -(b + root) / a, -c / (b + root)
    if root > b:
        return c / (root - b), (root - b) / a
    return 0.0, 0.0


@longest_apart.register(BallData)
@kernel
def _longest_apart(balls, x, directions, ends):
    """
    Return which ray from ``x`` touches a ball last, and the parameter where it does.

    Distances from ``x`` are computed once for all rays, and a ray looks only at balls that are
    nearer than its end.
    """
    gaps, powers = np.empty(len(balls.radii)), np.empty(len(balls.radii))
    for k in range(len(balls.radii)):
        squared = 0.0
        for i in range(len(x)):
            squared += (x[i] - balls.centres[k, i]) ** 2
        powers[k] = squared - balls.radii[k] ** 2
        gaps[k] = (1.0 - ROUNDING) * math.sqrt(squared) - balls.radii[k]
    longest, end = 0, 0.0
    for k in range(len(directions)):
        if ends[k] > end:
            reach = _reach(balls, x, directions[k], gaps, powers, end, ends[k])
            if reach > end:
                longest, end = k, reach
    return longest, end


@inlined
def _reach(balls, x, u, gaps, powers, t, end):
    """
    Return the first parameter up to ``end`` at which a ray touches a ball; or a value up to ``t``.

    ``gaps`` (k,) are the distances from ``x`` to the balls, not rounded up, and ``powers`` (k,)
    those of ``x`` with respect to the spheres: squared distance from the centre minus that of the
    sphere.
    """
    a = 0.0
    for i in range(len(u)):
        a += u[i] * u[i]
    length = math.sqrt(a)
    for k in range(len(gaps)):
        if gaps[k] < end * length:
            b = 0.0
            for i in range(len(u)):
                b += u[i] * (x[i] - balls.centres[k, i])
            lower, upper = _between_roots(a, b, powers[k], True)
            if lower <= end and upper >= 0.0:
                end = max(0.0, lower)
                if end <= t:
                    break
    return end


@add_crossings.register(BallData)
@kernel
def _add_crossings(balls, curve, end, crossings, n):
    """
    Append to ``crossings``, from index ``n``, the parameters where a curve meets the spheres.

    Return ``n`` plus their number, also of those that do not fit.
    """
    for k in range(len(balls.radii)):
        n = add_sphere_crossings(curve, balls.centres[k], balls.radii[k], end, crossings, n)
    return n
