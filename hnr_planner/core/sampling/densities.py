"""
Log-densities that walks draw from, with exact draws on a chord for two of them.

A log-density is a function of a point (dim,) in the caller's frame. ``Gaussian`` and
``Exponential`` are such functions for whose restriction to a line there is a closed form, so that
a step draws from it exactly and independently of the point before. For any other function, a step
draws by slice sampling on the chord (``draw_on_slice``).
"""

from dataclasses import dataclass, field
import math
from typing import NamedTuple

from hnr_planner.core.checks import check_numbers, check_point, check_vector, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.kernels.streams import normal, uniform
from hnr_planner.core.spaces.callbacks import ask, OracleError
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import ArrayLike

#: Draws of a slice after which a step leaves the chain where it is.
SHRINKS_MAX = 200
#: Half-width of a standard normal interval up to which a uniform proposal is accepted often.
NARROW = 1.5


@dataclass(frozen=True, eq=False)
class Gaussian:
    """
    The log-density of a normal distribution, up to a constant: a function of a point (dim,).

    Attributes
    ----------
    mean : (dim,)
        Its mean, which need not be a free point.
    covariance : (dim, dim)
        Its covariance, symmetric and positive definite.
    precision : (dim, dim)
        The inverse of the covariance.

    Raises
    ------
    RequestError
        When the numbers are not those of a normal distribution.

    """

    mean: Floats
    covariance: Floats
    precision: Floats = field(init=False, repr=False)

    def __init__(self, mean: ArrayLike, covariance: ArrayLike) -> None:
        centre = check_vector('mean', mean)
        matrix = check_numbers('covariance', covariance)
        if matrix.shape != (len(centre), len(centre)):
            raise RequestError(
                f'covariance must have shape ({len(centre)}, {len(centre)}), got {matrix.shape}'
            )
        if not (np.isfinite(matrix).all() and np.allclose(matrix, matrix.T)):
            raise RequestError('covariance must be finite and symmetric, and is not')
        least = float(np.linalg.eigvalsh(matrix)[0])
        if not least > 0.0:
            raise RequestError(
                f'covariance must be positive definite, but has an eigenvalue of {least:g}'
            )
        inverse = np.linalg.inv(matrix)
        for name, value in (
            ('mean', centre),
            ('covariance', matrix),
            ('precision', (inverse + inverse.T) / 2.0),
        ):
            object.__setattr__(self, name, value)

    def __call__(self, point: ArrayLike) -> float:
        """Return the log-density at a point (dim,), up to a constant."""
        offset = check_point('point', point, len(self.mean)) - self.mean
        return float(-0.5 * offset @ self.precision @ offset)


@dataclass(frozen=True, eq=False)
class Exponential:
    """
    The log-density ``-rates x``, up to a constant: a function of a point (dim,).

    Attributes
    ----------
    rates : (dim,)
        Rates at which the density falls along the axes, of any sign.

    Raises
    ------
    RequestError
        When the rates are not a vector of finite numbers.

    """

    rates: Floats

    def __init__(self, rates: ArrayLike) -> None:
        object.__setattr__(self, 'rates', check_vector('rates', rates))

    def __call__(self, point: ArrayLike) -> float:
        """Return the log-density at a point (dim,), up to a constant."""
        return float(-self.rates @ check_point('point', point, len(self.rates)))


class AffineMap(NamedTuple):
    """
    The map from the kernel frame of a space to the caller's: ``offset + matrix x``.

    Attributes
    ----------
    offset : (dim,)
        The origin of the kernel frame, in the caller's frame.
    matrix : (dim, kernel_dim)
        The axes of the kernel frame, in columns.

    """

    offset: Floats
    matrix: Floats


def map_from_kernel(space: Space) -> AffineMap:
    """Return the map from the kernel frame of a space to the caller's frame."""
    axes = np.vstack([np.zeros(space.kernel_dim), np.eye(space.kernel_dim)])
    images = space.from_kernel(axes)
    return AffineMap(images[0].copy(), np.ascontiguousarray((images[1:] - images[0]).T))


@inlined
def draw_exponential(rate, lower, upper, rng):
    """
    Return a draw from the density ``exp(-rate s)`` on (lower, upper), which may round to an end.

    It is computed from the end where the density is largest, by the inverse of the distribution.
    """
    width = upper - lower
    fall = abs(rate) * width
    v = uniform(rng)
    if fall < 1e-8:
        return lower + width * v
    way = -math.log1p(v * math.expm1(-fall)) / abs(rate)
    return lower + way if rate > 0.0 else upper - way


@kernel
def draw_normal_between(lower, upper, rng):
    """
    Return a draw from the standard normal distribution on (lower, upper), by exact rejection.

    The proposal is normal where the interval is wide around 0, exponential in a tail, and else
    uniform (Robert, "Simulation of truncated normal variables", 1995).
    """
    if not lower < upper:
        return lower  # of a chord without length, or of numbers that overflow
    if lower > 0.0:
        return _draw_in_tail(lower, upper, rng)
    if upper < 0.0:
        return -_draw_in_tail(-upper, -lower, rng)
    if upper - lower > NARROW:
        while True:
            x = normal(rng)
            if lower < x < upper:
                return x
    while True:
        x = lower + (upper - lower) * uniform(rng)
        if uniform(rng) < math.exp(-0.5 * x * x):
            return x


@kernel
def _draw_in_tail(lower, upper, rng):
    """Return a draw from the standard normal distribution on (lower, upper), with lower > 0."""
    rate = 0.5 * (lower + math.sqrt(lower * lower + 4.0))
    if (upper - lower) * lower < 1.0 and upper - lower < 1.0:
        while True:
            x = lower + (upper - lower) * uniform(rng)
            if uniform(rng) < math.exp(0.5 * (lower - x) * (lower + x)):
                return x
    while True:
        x = draw_exponential(rate, lower, upper, rng)
        if uniform(rng) < math.exp(-0.5 * (x - rate) * (x - rate)):
            return x


@kernel
def draw_on_slice(at, line, temperature, lower, upper, rng, work):
    """
    Return a parameter drawn by slice sampling on a chord, which keeps the density on the chord.

    A level is drawn below the log-density at parameter 0, and the chord is shrunk towards 0 at
    each draw whose log-density is below the level (Neal, "Slice sampling", 2003, Section 4).

    Parameters
    ----------
    at : int
        Address of the log-density, a function of a point in the caller's frame.
    line : (2, dim)
        The chain's point and the direction of the chord, in the caller's frame.
    temperature : float
        Number by which the log-density is divided.
    lower, upper : float
        Ends of the chord.
    rng : (4,) uint64
        Random stream.
    work : (dim + 1,)
        Work array for a point and the result.

    Raises
    ------
    RequestError
        When the log-density is nan or inf at a point, or -inf at the chain's point.
    OracleError
        When the log-density raised an exception.

    """
    level = _value(at, line, 0.0, work)
    if level == -math.inf:
        raise RequestError('log_density is -inf at a point of the chain')
    level += temperature * math.log(1.0 - uniform(rng))
    for _ in range(SHRINKS_MAX):
        s = lower + (upper - lower) * uniform(rng)
        if _value(at, line, s, work) >= level:
            return s
        if s < 0.0:
            lower = s
        else:
            upper = s
    return 0.0


@kernel
def _value(at, line, s, work):
    """Return the log-density at parameter ``s`` of a line, or raise RequestError if nan or inf."""
    n = line.shape[1]
    for i in range(n):
        work[i] = line[0, i] + s * line[1, i]
    point, answer = work[:n], work[n:]
    if ask(at, point, answer) != 0:
        raise OracleError
    value = answer[0]
    if not value < math.inf:
        raise RequestError(
            'a log_density, or the negative of an objective, is nan or inf at a point'
        )
    return value
