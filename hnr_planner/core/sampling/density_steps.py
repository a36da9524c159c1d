"""
Steps of Hit-and-Run that draw from a density on the chord.

A density is compiled for a space: its numbers are converted to the kernel frame, or its function
becomes an address that the kernel calls, together with the map to the frame of the function.
"""

from collections.abc import Callable
import math
from typing import Any, NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.kernel import inlined
from hnr_planner.core.sampling.densities import (
    draw_exponential,
    draw_normal_between,
    draw_on_slice,
    Exponential,
    Gaussian,
    map_from_kernel,
)
from hnr_planner.core.sampling.draws import REDRAWS_MAX
from hnr_planner.core.sampling.steps import REDRAWS, take_step, ZERO_CHORDS
from hnr_planner.core.spaces.callbacks import address, callback
from hnr_planner.core.spaces.chain_cache import chord_cached, move_along, NO_AXIS
from hnr_planner.core.spaces.lines import check_straight_lines, uniform_direction
from hnr_planner.core.spaces.space import Space
import numpy as np


class GaussianStep(NamedTuple):
    """
    Hit-and-Run for a normal density, for kernels.

    Attributes
    ----------
    zero_length : float
        Chords shorter than this count as zero chords, kernel frame.
    mean, precision : (dim,), (dim, dim)
        The log-density is ``-(x - mean) precision (x - mean) / 2``, kernel frame.

    """

    zero_length: float
    mean: Floats
    precision: Floats


class ExponentialStep(NamedTuple):
    """
    Hit-and-Run for a density ``exp(-rates x)``, for kernels.

    Attributes
    ----------
    zero_length : float
        Chords shorter than this count as zero chords, kernel frame.
    rates : (dim,)
        Rates in the kernel frame.

    """

    zero_length: float
    rates: Floats


class SliceStep(NamedTuple):
    """
    Hit-and-Run for the density of a function, for kernels.

    Attributes
    ----------
    zero_length : float
        Chords shorter than this count as zero chords, kernel frame.
    address : int
        Address of the log-density, a function of a point in the caller's frame.
    temperature : float
        Number by which the log-density is divided.
    offset, matrix : (n,), (n, dim)
        The map ``offset + matrix x`` from the kernel frame to the caller's.

    """

    zero_length: float
    address: int
    temperature: float
    offset: Floats
    matrix: Floats


class CompiledDensity:
    """
    A log-density in the form for kernels; keep this object for as long as its steps are used.

    Parameters
    ----------
    log_density : callable
        A ``Gaussian``, an ``Exponential``, or another function of a point (dim,).

    Raises
    ------
    RequestError
        When ``log_density`` is not callable.

    """

    def __init__(self, log_density: Callable[[Any], float]) -> None:
        if isinstance(log_density, type) or not callable(log_density):
            raise RequestError(f'log_density must be a function, got {log_density!r}')
        self.log_density = log_density
        has_closed_form = isinstance(log_density, Gaussian | Exponential)
        self._called_back = None if has_closed_form else callback(log_density, 1)

    def step(self, space: Space, temperature: float = 1.0) -> Any:
        """
        Return the NamedTuple that selects the step's kernel.

        Parameters
        ----------
        space : Space
            The space of the walk.
        temperature : float
            Number by which the log-density of a function is divided.

        Raises
        ------
        RequestError
            When the density has another dimension than the space, or the space has no straight
            lines.

        """
        check_straight_lines(space, 'a walk with a density')
        offset, matrix = map_from_kernel(space)
        density = self.log_density
        if isinstance(density, Gaussian):
            _check_dim(space, len(density.mean))
            precision = matrix.T @ density.precision @ matrix
            pull = matrix.T @ density.precision @ (density.mean - offset)
            mean = np.asarray(np.linalg.solve(precision, pull), dtype=np.float64)
            return GaussianStep(space.zero_length, mean, np.ascontiguousarray(precision))
        if isinstance(density, Exponential):
            _check_dim(space, len(density.rates))
            return ExponentialStep(space.zero_length, np.ascontiguousarray(density.rates @ matrix))
        at = address(self._called_back)
        return SliceStep(space.zero_length, at, float(temperature), offset, matrix)

    def check_start(self, point: Floats) -> None:
        """
        Check that a chain can start at ``point`` (dim,), caller's frame.

        Raises
        ------
        RequestError
            When the log-density is no finite number there.

        """
        value = self.log_density(point.copy())
        if not (np.ndim(value) == 0 and math.isfinite(value)):
            raise RequestError(
                f'log_density must be a finite number at a start, but is {value!r} at '
                f'{point.tolist()}'
            )


def _check_dim(space: Space, dim: int) -> None:
    """Raise RequestError for a density of another dimension than the space."""
    if dim != space.dim:
        raise RequestError(f'the density has {dim} dimensions, the space has {space.dim}')


@inlined
def _draw_chord(walk, space, cache, u, rng, counts):
    """Write a uniform direction into ``u``; return the ends of the chord along it."""
    uniform_direction(rng, u)
    lower, upper = chord_cached(space, cache, u, NO_AXIS)
    counts[ZERO_CHORDS] += upper - lower < walk.zero_length
    return lower, upper


@take_step.register(GaussianStep)
@inlined
def _gaussian(walk, space, cache, u, rng, counts):
    """Move by a draw from the normal density on the chord; return whether the chain moved."""
    lower, upper = _draw_chord(walk, space, cache, u, rng, counts)
    curvature, slope = 0.0, 0.0
    for i in range(len(u)):
        along = 0.0
        for j in range(len(u)):
            along += walk.precision[i, j] * u[j]
        curvature += along * u[i]
        slope += along * (walk.mean[i] - cache.x[i])
    middle, deviation = slope / curvature, 1.0 / math.sqrt(curvature)
    begin, end = (lower - middle) / deviation, (upper - middle) / deviation
    for _ in range(REDRAWS_MAX):
        s = middle + deviation * draw_normal_between(begin, end, rng)
        if lower < s < upper and move_along(space, cache, u, NO_AXIS, s):
            return True
        counts[REDRAWS] += 1
    return False


@take_step.register(ExponentialStep)
@inlined
def _exponential(walk, space, cache, u, rng, counts):
    """Move by a draw from the exponential density on the chord; return whether it moved."""
    lower, upper = _draw_chord(walk, space, cache, u, rng, counts)
    rate = 0.0
    for i in range(len(u)):
        rate += walk.rates[i] * u[i]
    for _ in range(REDRAWS_MAX):
        s = draw_exponential(rate, lower, upper, rng)
        if lower < s < upper and move_along(space, cache, u, NO_AXIS, s):
            return True
        counts[REDRAWS] += 1
    return False


@take_step.register(SliceStep)
@inlined
def _slice(walk, space, cache, u, rng, counts):
    """Move by a draw from a slice of the density on the chord; return whether it moved."""
    lower, upper = _draw_chord(walk, space, cache, u, rng, counts)
    n = len(walk.offset)
    line, work = np.empty((2, n)), np.empty(n + 1)
    for i in range(n):
        line[0, i], line[1, i] = walk.offset[i], 0.0
        for j in range(len(u)):
            line[0, i] += walk.matrix[i, j] * cache.x[j]
            line[1, i] += walk.matrix[i, j] * u[j]
    for _ in range(REDRAWS_MAX):
        s = draw_on_slice(walk.address, line, walk.temperature, lower, upper, rng, work)
        if s != 0.0 and lower < s < upper and move_along(space, cache, u, NO_AXIS, s):
            return True
        counts[REDRAWS] += 1
    return False
