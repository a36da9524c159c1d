"""
Functions of the user that compiled kernels call by address.

A function compiled by numba costs no more than a compiled call. A function in Python takes the
interpreter's lock for each call, a few microseconds. An exception in a function in Python ends the
kernel with an ``OracleError``. The address is a number in the data of a space, so kernels are
compiled, and cached on disk, once for all functions.
"""

from collections.abc import Callable
import ctypes
import threading
from typing import Any

from hnr_planner.core.errors import HnrError
from numba import carray, cfunc, types
from numba.core import cgutils
from numba.core.dispatcher import Dispatcher
from numba.extending import intrinsic, overload
import numpy as np

#: Signature: numbers, their count, and an array for the result; it returns 0 or ``FAILED``.
_C_TYPE = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_int64, ctypes.c_void_p)
_NATIVE = types.int32(types.CPointer(types.float64), types.int64, types.CPointer(types.float64))
#: Bytes of a number.
_FLOAT = 8
#: Returned by a function that raised.
FAILED = -1

_raised = threading.local()


class OracleError(HnrError):
    """
    A function of the user that a space or a walk calls has raised an exception.

    That exception is the ``__cause__`` of this error.
    """

    def __init__(self) -> None:
        self.__cause__ = getattr(_raised, 'error', None)
        super().__init__(f'the function of a space or of a density raised {self.__cause__!r}')


def vector_callback(function: Callable[..., Any]) -> Any:
    """
    Return a function from arrays (dim,) to arrays (dim,) as a C function, for ``ask``.

    Keep a reference to the returned object for as long as its ``address`` is used. The function
    may be compiled by numba or not.
    """
    if not isinstance(function, Dispatcher):
        return _python_vector(function)

    def answer(numbers, count, result):
        image = function(carray(numbers, (count,)))
        for i in range(count):
            result[i] = image[i]
        return 0

    return cfunc(_NATIVE)(answer)


def _python_vector(function: Callable[..., Any]) -> Any:
    """Return a function in Python from arrays to arrays as a C function."""

    def answer(numbers: int, count: int, result: int) -> int:
        try:
            point = np.frombuffer(ctypes.string_at(numbers, _FLOAT * count))
            image = np.array(function(point), dtype=np.float64)
            if image.shape != (count,):
                raise ValueError(f'the image must have shape ({count},), got {image.shape}')
            ctypes.memmove(result, image.ctypes.data, _FLOAT * count)
        except BaseException as error:
            _raised.error = error
            return FAILED
        return 0

    return _C_TYPE(answer)


def callback(function: Callable[..., Any], n_arrays: int) -> Any:
    """
    Return a function as a C function, whose ``address`` ``ask`` calls.

    Keep a reference to the returned object for as long as its address is used.

    Parameters
    ----------
    function : callable
        A function of ``n_arrays`` arrays (dim,) that returns a number or a truth value, compiled
        by numba or not.
    n_arrays : int
        Number of arrays (dim,) that the function takes: 1 or 2.

    """
    if isinstance(function, Dispatcher):
        return _native(function, n_arrays)
    return _python(function, n_arrays)


def address(called_back: Any) -> int:
    """Return the address of a C function that ``callback`` returned."""
    if isinstance(called_back, _C_TYPE):
        return int(ctypes.cast(called_back, ctypes.c_void_p).value or 0)
    return int(called_back.address)


def _python(function: Callable[..., Any], n_arrays: int) -> Any:
    """Return a function in Python as a C function, which takes the interpreter's lock."""

    def answer(numbers: int, count: int, result: int) -> int:
        try:
            # A copy, which the function may keep, and which it cannot change.
            all_numbers = np.frombuffer(ctypes.string_at(numbers, _FLOAT * count))
            arrays = all_numbers.reshape(n_arrays, -1)
            ctypes.c_double.from_address(result).value = float(function(*arrays))
        except BaseException as error:
            _raised.error = error
            return FAILED
        return 0

    return _C_TYPE(answer)


def _native(function: Dispatcher, n_arrays: int) -> Any:
    """Return a function compiled by numba as a C function."""
    if n_arrays == 1:

        def answer(numbers, count, result):
            result[0] = function(carray(numbers, (count,)))
            return 0
    else:

        def answer(numbers, count, result):
            arrays = carray(numbers, (2, count // 2))
            result[0] = function(arrays[0], arrays[1])
            return 0

    return cfunc(_NATIVE)(answer)


def ask(at: int, numbers: Any, result: Any) -> int:
    """
    Call the function at address ``at`` and write its result to ``result``.

    That is (1,), or (dim,) for a function to arrays. ``numbers`` (n,) holds the function's arrays
    (dim,) one after another. Return 0, or ``FAILED``, -1, when the function raised an exception.
    """
    return _C_TYPE(at)(numbers.ctypes.data, len(numbers), result.ctypes.data)


@intrinsic
def _call(_typing_context: Any, at: Any, numbers: Any, count: Any, result: Any) -> Any:
    """Generate the call of the C function at address ``at``, with two pointers and a count."""

    def generate(_context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        ir: Any = cgutils.ir
        word = ir.IntType(64)
        kind = ir.FunctionType(ir.IntType(32), [word, word, word])
        return builder.call(builder.inttoptr(arguments[0], kind.as_pointer()), list(arguments[1:]))

    return types.int32(types.int64, types.uintp, types.int64, types.uintp), generate


@overload(ask)
def _compiled_ask(at, numbers, result):
    return lambda at, numbers, result: _call(  # type: ignore[call-arg]
        at, numbers.ctypes.data, len(numbers), result.ctypes.data
    )
