"""Checks of arguments: convert them once, or raise an error with the value and the rule."""

import math
import operator
import secrets
from typing import Any, TypeAlias

from hnr_planner.core.errors import HnrError, RequestError
import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]

#: What is taken as a seed: ``check_seed`` makes a whole number of it.
Seed: TypeAlias = (
    int | np.integer[Any] | np.random.SeedSequence | np.random.Generator | np.random.BitGenerator
) | None
#: Seeds drawn from a generator or a seed sequence are below this.
SEED_MAX = 2**63


def check_numbers(name: str, values: ArrayLike, error: type[HnrError] = RequestError) -> Floats:
    """
    Return ``values`` of any shape as a fresh float array, or raise ``error``.

    The numbers may be nan or infinite.
    """
    try:
        return np.array(values, dtype=np.float64, order='C')
    except (TypeError, ValueError, OverflowError):
        raise error(f'{name} must be numbers, got {values!r}') from None


def check_points(name: str, points: ArrayLike, dim: int) -> Floats:
    """
    Return ``points`` (k, dim) or (dim,) as a fresh float array, or raise RequestError.

    The coordinates may be nan or infinite; only the shape is checked.
    """
    array = check_numbers(name, points)
    if array.ndim not in (1, 2) or array.shape[-1] != dim:
        raise RequestError(f'{name} must have shape (k, {dim}) or ({dim},), got {array.shape}')
    return array


def check_point(name: str, point: ArrayLike, dim: int) -> Floats:
    """Return ``point`` (dim,) as a fresh array of finite floats, or raise RequestError."""
    array = check_points(name, point, dim)
    if array.ndim != 1:
        raise RequestError(f'{name} must have shape ({dim},), got {array.shape}')
    if not all(map(math.isfinite, array.tolist())):
        raise RequestError(f'{name} must be finite, got {array.tolist()}')
    return array


def check_vector(name: str, vector: ArrayLike, error: type[HnrError] = RequestError) -> Floats:
    """Return ``vector`` (dim,) of any dimension as fresh finite floats, or raise ``error``."""
    array = check_numbers(name, vector, error)
    if array.ndim != 1 or array.size == 0:
        raise error(f'{name} must have shape (dim,) with dim at least 1, got {array.shape}')
    if not np.isfinite(array).all():
        raise error(f'{name} must be finite, got {array.tolist()}')
    return array


def check_direction(name: str, direction: ArrayLike, dim: int) -> Floats:
    """Return ``direction`` (dim,) as a fresh array; raise RequestError if zero or not finite."""
    array = check_point(name, direction, dim)
    if not array.any():
        raise RequestError(f'{name} must not be zero, got {array.tolist()}')
    return array


def check_real(name: str, value: Any, error: type[HnrError] = RequestError) -> float:
    """Return ``value`` as a float, nan and inf included, or raise ``error``."""
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise error(f'{name} must be a number, got {value!r}') from None


def check_number(name: str, value: Any, lower: float, upper: float = math.inf) -> float:
    """Return ``value`` as a float in [lower, upper], never nan, or raise RequestError."""
    number = check_real(name, value)
    if not lower <= number <= upper:
        raise RequestError(f'{name} must be in {lower:g}..{upper:g}, got {number!r}')
    return number


def check_positive(name: str, value: Any) -> float:
    """Return ``value`` as a float above 0, which may be inf, or raise RequestError."""
    number = check_number(name, value, 0.0)
    if number == 0.0:
        raise RequestError(f'{name} must be above 0, got 0.0')
    return number


def check_count(name: str, value: Any, lower: int) -> int:
    """Return ``value`` as an int of at least ``lower``, or raise RequestError."""
    try:
        count = operator.index(value)
    except TypeError:
        raise RequestError(f'{name} must be a whole number, got {value!r}') from None
    if count < lower:
        raise RequestError(f'{name} must be at least {lower}, got {count}')
    return count


def check_choice(name: str, value: Any, choices: tuple[str, ...]) -> str:
    """Return ``value`` unchanged if it is one of ``choices``; raise RequestError otherwise."""
    if value not in choices:
        raise RequestError(f'{name} must be one of {", ".join(choices)}, got {value!r}')
    return str(value)


def check_seed(seed: Seed) -> int:
    """
    Return a seed as an int of at least 0, or raise RequestError.

    Results state that int; given as the seed again, it repeats the same random draws.

    Parameters
    ----------
    seed : int, numpy.random.SeedSequence, numpy.random.Generator or None
        A seed sequence always gives the same int, computed from its state. From a generator (or a
        bit generator) an int is drawn, which advances the generator. None gives a random int of
        the operating system.

    Raises
    ------
    RequestError
        When ``seed`` is of none of these types, or a number below 0.

    """
    if seed is None:
        return secrets.randbelow(2**31)
    if isinstance(seed, np.random.BitGenerator):
        seed = np.random.Generator(seed)
    if isinstance(seed, np.random.Generator):
        return int(seed.integers(SEED_MAX))
    if isinstance(seed, np.random.SeedSequence):
        return int(seed.generate_state(1, np.uint64)[0]) % SEED_MAX
    return check_count('seed', seed, 0)
