"""
The image of a ball or a box under a shear, which need not be convex.

This module has the whole kind of space, the class that validates and the kernels.
"""

from functools import cached_property
import math
from typing import NamedTuple

from hnr_planner.core.checks import check_point, check_points, check_real, Floats
from hnr_planner.core.errors import SpaceError
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.ball import BallSpace
from hnr_planner.core.spaces.bounds import box_span, check_bounds, kernel_origin
from hnr_planner.core.spaces.box import BoxSpace
from hnr_planner.core.spaces.curves.polynomials import next_change, value
from hnr_planner.core.spaces.primitives import contains, first_entry, first_exit, touches
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import ArrayLike

#: Largest Lipschitz constant of the shear for which coordinates resolve the image.
STRETCH_MAX = 1e4
#: Bound on the rounding of a coordinate mapped back, as a fraction of its terms.
ROUNDING = 32 * 2.0**-53
#: Distance beyond the bounds up to which a line is followed, as a fraction of their sides.
AROUND = 1e-6


class ShearedData(NamedTuple):
    """
    A compiled ball or box under a shear.

    Attributes
    ----------
    lower, upper : (dim,)
        Corners of the box that is the base, or of a box around the ball that is the base.
    centre : (dim,)
        Centre of the base.
    radius : float
        Radius of the ball; 0 for a box.
    bend : float
        The last coordinate is moved by ``bend`` times the square of the first coordinate, which
        is counted from the centre.
    rounding : float
        Largest computed value of an inequality whose exact value is 0: a length, squared for a
        ball.
    begin, end : (dim,)
        Corners of a box around the image, slightly larger than its bounds.

    """

    lower: Floats
    upper: Floats
    centre: Floats
    radius: float
    bend: float
    rounding: float
    begin: Floats
    end: Floats


class ShearedSpace(Space):
    """
    The image of a ball or a box under a shear that keeps volume.

    The map ``g`` moves the last coordinate by ``bend`` times the square of the first, so that a
    ball becomes a banana. Its Jacobian has determinant 1, so that uniform points of the base go to
    uniform points of the image, and both of its Lipschitz constants are known exactly: what the
    paper's Assumption 2 asks for.

    Parameters
    ----------
    base : BallSpace or BoxSpace
        The convex set, Omega in the paper; of dimension 2 at least.
    bend : float
        The shear [1/m]: ``g(x) = x + bend (x_1 - c_1)^2 e_n``, where c is the centre of the base.

    Raises
    ------
    SpaceError
        When the base is another space or of dimension 1, ``bend`` is not finite or stretches the
        base too much, or the image is not resolved by floating-point numbers.

    Attributes
    ----------
    base : BallSpace or BoxSpace
    bend : float
    stretch : float
        Least Lipschitz constant of g, the paper's L_Sigma, from a closed form.
    shrink : float
        Least Lipschitz constant of the inverse of g, the paper's L_Omega: equal to ``stretch``.

    """

    def __init__(self, base: BallSpace | BoxSpace, bend: float) -> None:
        if not isinstance(base, BallSpace | BoxSpace):
            raise SpaceError(f'base must be a BallSpace or a BoxSpace, got {base!r}')
        if base.dim < 2:
            raise SpaceError('base must have two dimensions at least, it has 1')
        self.base, self.dim, self.centre = base, base.dim, _centre(base)
        self.bend = check_real('bend', bend, SpaceError)
        if not math.isfinite(self.bend):
            raise SpaceError(f'bend must be finite, got {self.bend!r}')
        self.stretch = self.shrink = _largest_stretch(base, self.bend)
        if self.stretch > STRETCH_MAX:
            raise SpaceError(
                f'bend must stretch the base by no more than {STRETCH_MAX:g}, but '
                f'{self.bend!r} stretches it by {self.stretch:g}'
            )
        self._lower, self._upper = _bounds(base, self.bend)
        check_bounds('the sheared space', self._lower, self._upper)
        self._kernel_origin = kernel_origin(self._lower, self._upper)
        self.data = self.compiled_at(self._kernel_origin)

    def __repr__(self) -> str:
        """Name the base and the shear."""
        return f'ShearedSpace(base={self.base!r}, bend={self.bend:g})'

    def compiled_at(self, origin: Floats | None) -> ShearedData:
        """
        Return the compiled space, its coordinates along the caller's axes from ``origin``.

        ``origin`` (dim,) is a point of the caller's frame; None keeps the caller's own origin.
        """
        shift = np.zeros(self.dim) if origin is None else origin
        lower, upper = (corner - shift for corner in self.base.bounds)
        rim = AROUND * (self._upper - self._lower)
        radius = self.base.radius if isinstance(self.base, BallSpace) else 0.0
        return ShearedData(
            lower,
            upper,
            self.centre - shift,
            radius,
            self.bend,
            _rounding(lower, upper, radius, self.bend),
            self._lower - shift - rim,
            self._upper - shift + rim,
        )

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,), caller's frame."""
        return self._lower.copy(), self._upper.copy()

    @cached_property
    def typical_clearance(self) -> float:
        """Typical clearance of the base over ``shrink``."""
        return self.base.typical_clearance / self.shrink

    def image(self, points: ArrayLike) -> Floats:
        """Return the images (k, dim) or (dim,) under the shear g of points of the base."""
        return self._moved(points, self.bend)

    def preimage(self, points: ArrayLike) -> Floats:
        """Return the points (k, dim) or (dim,) that the shear g maps to ``points``."""
        return self._moved(points, -self.bend)

    def why_not_free(self, point: ArrayLike) -> str:
        """Return the reason why ``point`` (dim,) is not free."""
        reason = self.base.why_not_free(self.preimage(check_point('point', point, self.dim)))
        return f'mapped back, {reason}'

    def _moved(self, points: ArrayLike, bend: float) -> Floats:
        """Return points (k, dim) or (dim,) moved by a shear with this ``bend``, in a new array."""
        moved = check_points('points', points, self.dim)
        moved[..., -1] += bend * (moved[..., 0] - self.centre[0]) ** 2
        return moved


def _centre(base: BallSpace | BoxSpace) -> Floats:
    """Return the centre (dim,) of the base."""
    lower, upper = base.bounds
    return base.centre.copy() if isinstance(base, BallSpace) else (lower + upper) / 2.0


def _bounds(base: BallSpace | BoxSpace, bend: float) -> tuple[Floats, Floats]:
    """Return the lower and upper corner (dim,) of the image."""
    lower, upper = base.bounds
    half = (upper[0] - lower[0]) / 2.0
    if isinstance(base, BoxSpace):
        reach = bend * half**2
    elif 2.0 * abs(bend) * half <= 1.0:
        reach = 0.0
    else:
        # The highest point of t + bend (half^2 - t^2), beyond the height of the ball.
        reach = math.copysign(1.0 / (4.0 * abs(bend)) + abs(bend) * half**2 - half, bend)
    lower[-1] += min(reach, 0.0)
    upper[-1] += max(reach, 0.0)
    return lower, upper


def _largest_stretch(base: BallSpace | BoxSpace, bend: float) -> float:
    """
    Return the least Lipschitz constant of g, which is also that of the inverse of g.

    ``g(x) - g(y) = (1 + k e_n e_1^T) (x - y)`` with ``k = bend (x_1 + y_1 - 2 c_1)``, exactly: a
    linear shear, whose largest and whose inverse's largest singular value are both
    ``(|k| + sqrt(k^2 + 4)) / 2``.
    """
    lower, upper = base.bounds
    k = abs(bend) * float(upper[0] - lower[0])
    return (k + math.hypot(k, 2.0)) / 2.0


def _rounding(lower: Floats, upper: Floats, radius: float, bend: float) -> float:
    """
    Return the largest computed value of an inequality whose exact value is 0.

    It is a length for a box, and a squared length for a ball.
    """
    half = float(upper[0] - lower[0]) / 2.0
    size = float(np.abs([lower, upper]).max()) + abs(bend) * half**2
    return ROUNDING * size * (half if radius > 0.0 else 1.0)


@contains.register(ShearedData)
@kernel
def _contains(sheared, x):
    """Return whether ``x`` (dim,) satisfies every inequality strictly."""
    return _holds(sheared, x, False)


@touches.register(ShearedData)
@kernel
def _touches(sheared, x):
    """Return whether ``x`` (dim,) satisfies every inequality, or is on its boundary."""
    return _holds(sheared, x, True)


@kernel
def _holds(sheared, x, closed):
    """Return whether every inequality holds at ``x``, strictly unless ``closed``."""
    coefficients, still = np.empty(5), np.zeros(len(x))
    for k in range(_count(sheared)):
        _write(sheared, k, x, still, coefficients)
        if not (coefficients[0] < 0.0 or (closed and coefficients[0] == 0.0)):
            return False
    return True


@first_exit.register(ShearedData)
@kernel
def _first_exit(sheared, x, u, t, horizon):
    """Return the first parameter from ``t`` on at which an inequality fails."""
    _, last = box_span(sheared.begin, sheared.end, x, u)
    if t >= last:
        return t
    coefficients, rounding, s = np.empty(5), sheared.rounding, math.inf
    for k in range(_count(sheared)):
        end = _write(sheared, k, x, u, coefficients) + 1
        if not value(coefficients[:end], t) < 0.0:
            return t
        s = min(s, next_change(coefficients[:end], t, last, False, rounding))
    return s


@first_entry.register(ShearedData)
@kernel
def _first_entry(sheared, x, u, t):
    """
    Return the first parameter from ``t`` on at which all inequalities hold; inf for none.

    The parameter advances to where a violated inequality holds, until all of them hold.
    """
    first, last = box_span(sheared.begin, sheared.end, x, u)
    coefficients, rounding = np.empty(5), sheared.rounding
    s, k, held = max(t, first), 0, 0
    while held < _count(sheared):
        if s >= last:
            return math.inf
        end = _write(sheared, k, x, u, coefficients) + 1
        held += 1
        if not value(coefficients[:end], s) <= 0.0:
            s, held = next_change(coefficients[:end], s, last, True, rounding), 1
        k = (k + 1) % _count(sheared)
    return s


@kernel
def _count(sheared):
    """Return the number of inequalities: one for a ball, one for each face of a box."""
    return 1 if sheared.radius > 0.0 else 2 * len(sheared.centre)


@kernel
def _write(sheared, k, x, u, coefficients):
    """
    Write inequality ``k`` along ``x + s u`` as a polynomial in s, and return its degree.

    The coefficients are written with the constant one first. The polynomial is below 0 inside. The
    inverse of g maps the line to a parabola, of which only the last coordinate is not linear.
    """
    c, n = coefficients, len(x)
    aside = x[0] - sheared.centre[0]
    q0 = x[n - 1] - sheared.bend * aside * aside
    q1 = u[n - 1] - 2.0 * sheared.bend * aside * u[0]
    q2 = -sheared.bend * u[0] * u[0]
    if sheared.radius > 0.0:
        q0 -= sheared.centre[n - 1]
        c[0], c[1], c[2] = q0 * q0, 2.0 * q0 * q1, q1 * q1 + 2.0 * q0 * q2
        c[3], c[4] = 2.0 * q1 * q2, q2 * q2
        for i in range(n - 1):
            offset = x[i] - sheared.centre[i]
            c[0] += offset * offset
            c[1] += 2.0 * offset * u[i]
            c[2] += u[i] * u[i]
        c[0] -= sheared.radius * sheared.radius
        return 4
    i = k // 2
    c[0], c[1], c[2] = (q0, q1, q2) if i == n - 1 else (x[i], u[i], 0.0)
    if k % 2 == 0:
        c[0] -= sheared.upper[i]
    else:
        c[0], c[1], c[2] = sheared.lower[i] - c[0], -c[1], -c[2]
    return 2 if i == n - 1 else 1
