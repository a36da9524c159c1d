"""
Arrays lent to a kernel: used without counting references.

Compiled code counts the references to an array wherever it is handed on, sliced or taken out of a
tuple, each time with an atomic instruction: for a ray through a grid that is more work than the
ray. A caller in Python holds the arguments of a kernel until it returns, so the count does not
matter there: a kernel that begins with ``space = borrowed(space)`` runs several times faster.

A kernel must not return a borrowed array, which has no owner that keeps its memory, and must not
borrow an array that it made itself, whose owner would be gone.
"""

from typing import Any

from numba.core import cgutils, types
from numba.extending import lower_builtin, type_callable


def borrowed(value: Any) -> Any:
    """
    Return an argument of a kernel, for which compiled code then counts no references.

    ``value`` is an array, or a tuple of arrays, numbers and tuples. Called from Python, return
    ``value`` unchanged.
    """
    return value


@type_callable(borrowed)
def _type_of_borrowed(_typing_context: Any) -> Any:
    return lambda value: value


@lower_builtin(borrowed, types.Any)
def _without_owner(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    """Lower a call of ``borrowed``: return the same value with the owner of each array cleared."""
    return _disowned(context, builder, signature.return_type, arguments[0])


def _disowned(context: Any, builder: Any, kind: Any, value: Any) -> Any:
    """Return a value of numba type ``kind`` with the owner (meminfo) of each array set to null."""
    if isinstance(kind, types.Array):
        array = context.make_array(kind)(context, builder, value)
        array.meminfo = cgutils.get_null_value(array.meminfo.type)
        return array._getvalue()
    if isinstance(kind, types.BaseTuple):
        members: Any = kind
        for i, member in enumerate(members):
            lent = _disowned(context, builder, member, builder.extract_value(value, i))
            value = builder.insert_value(value, lent, i)
    return value
