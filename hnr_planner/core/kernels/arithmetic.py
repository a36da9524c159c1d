"""
Arithmetic of interpreted kernels: that of compiled ones, to the last bit.

Compiled kernels follow IEEE and NumPy where Python raises (``1.0 / 0.0`` is inf,
``math.sqrt(-1.0)`` is nan), and they compute a few functions in another way than Python, with
another last bit: powers by whole numbers are products, ``math.hypot`` is that of the C library, a
sum goes from left to right. ``interpreted_form`` puts the functions of this module in the place
of Python's.
"""

from collections.abc import Callable
import math
from types import SimpleNamespace
from typing import Any

import numpy as np

#: What compiled code gives for a float that no 64-bit integer can hold (on x86).
_NO_INTEGER = -(2**63)


def divide(a: Any, b: Any) -> Any:
    """Return ``a / b``; for b = 0, where Python raises, inf, -inf or nan as in IEEE 754."""
    try:
        return a / b
    except ZeroDivisionError:
        return _over_zero(a, b)


def floor_divide(a: Any, b: Any) -> Any:
    """Return ``a // b``; for b = 0, 0 if both are integers, else inf, -inf or nan."""
    try:
        return a // b
    except ZeroDivisionError:
        return 0 if isinstance(a, int) and isinstance(b, int) else _over_zero(a, b)


def modulo(a: Any, b: Any) -> Any:
    """Return ``a % b``; for b = 0, 0 if both are integers, else nan."""
    try:
        return a % b
    except ZeroDivisionError:
        return 0 if isinstance(a, int) and isinstance(b, int) else math.nan


def _over_zero(a: Any, b: Any) -> float:
    return float(np.float64(a) / np.float64(b))


def power(a: Any, b: Any) -> Any:
    """Return ``a ** b``: as Python for two integers, else a float, as the C library computes."""
    if isinstance(a, int) and isinstance(b, int):
        return a**b
    return float(np.float64(a) ** np.float64(b))


def square(a: Any) -> Any:
    """Return ``a ** 2``, as a product."""
    return a * a


def whole_power(a: Any, exponent: int) -> Any:
    """Return ``a ** exponent`` for an integer exponent >= 0, by repeated squaring."""
    product: Any = 1.0 if isinstance(a, float | np.floating) else 1
    while exponent:
        if exponent & 1:
            product = product * a
        exponent >>= 1
        if exponent:
            a = a * a
    return product


def in_place(operation: Callable[[Any, Any], Any], a: Any, b: Any) -> Any:
    """Return ``operation(a, b)``; if ``a`` is an array, write the result into it and return it."""
    result = operation(a, b)
    if isinstance(a, np.ndarray):
        a[...] = result
        return a
    return result


def left_sum(array: Any) -> Any:
    """Return the sum of an array's elements, from the first to the last."""
    total = array.dtype.type(0).item()
    for element in array.ravel().tolist():
        total += element
    return total


def _sqrt(x: float) -> float:
    try:
        return math.sqrt(x)
    except ValueError:
        return math.nan


def _log(x: float) -> float:
    try:
        return math.log(x)
    except ValueError:
        return -math.inf if x == 0.0 else math.nan


def _exp(x: float) -> float:
    try:
        return math.exp(x)
    except OverflowError:
        return math.inf


def _sin(x: float) -> float:
    try:
        return math.sin(x)
    except ValueError:
        return math.nan


def _cos(x: float) -> float:
    try:
        return math.cos(x)
    except ValueError:
        return math.nan


def _acos(x: float) -> float:
    return math.acos(x) if -1.0 <= x <= 1.0 else math.nan


def _hypot(x: float, y: float) -> float:
    return float(np.hypot(x, y))


def _floor(x: float) -> int:
    try:
        return math.floor(x)
    except (ValueError, OverflowError):
        return _NO_INTEGER


def _ceil(x: float) -> int:
    try:
        return math.ceil(x)
    except (ValueError, OverflowError):
        return _NO_INTEGER


#: The module ``math`` as interpreted kernels see it.
MATH = SimpleNamespace(
    **{
        **vars(math),
        'sqrt': _sqrt,
        'log': _log,
        'exp': _exp,
        'sin': _sin,
        'cos': _cos,
        'acos': _acos,
        'hypot': _hypot,
        'floor': _floor,
        'ceil': _ceil,
    }
)


def boxed(value: Any) -> Any:
    """
    Return the result of an interpreted kernel with the types that machine code would return.

    NumPy's scalars become Python's, in tuples too. So a later call with this result has the same
    types of arguments, whether the kernel ran as machine code or interpreted.
    """
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, tuple):
        members = map(boxed, value)
        return value._make(members) if hasattr(value, '_make') else tuple(members)
    return value
