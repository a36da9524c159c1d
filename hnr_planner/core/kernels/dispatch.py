"""
Functions whose kernel is picked by the type of their first argument.

What ``functools.singledispatch`` is to Python, ``dispatched`` is to kernels. The decorated
function says what is asked, and is the answer for every type that registers no other:

>>> @dispatched
... @kernel
... def area(shape):
...     raise NotImplementedError
>>> @area.register(DiscData)
... @kernel
... def _area(disc):
...     return math.pi * disc.radius**2

Compiled code that calls ``area`` gets the kernel for the NamedTuple that it is compiled for, and
looks nothing up when it runs. Interpreted code reaches the same kernels interpreted, so that both
can be compared.
"""

from collections.abc import Callable
from functools import cache, wraps
from typing import Any, Protocol

from hnr_planner.core.kernels.kernel import INLINED, interpreted, recompiled
from numba.core.dispatcher import Dispatcher
from numba.extending import overload


class Dispatched(Protocol):
    """A function with a kernel for each type of its first argument."""

    def __call__(self, *arguments: Any) -> Any:
        """Run the kernel for the first argument, interpreted."""

    def register(self, data_type: type) -> Callable[[Dispatcher], Dispatcher]:
        """Return a decorator: its kernel answers for NamedTuples of ``data_type``."""

    def knows(self, data: Any) -> bool:
        """Say whether a kernel is registered for the type of ``data``."""


def dispatched(default: Dispatcher) -> Dispatched:
    """Let other kernels answer for a kernel, each for a type of its first argument."""
    kernels: dict[type, Dispatcher] = {}

    @wraps(default.py_func)
    def call(*arguments: Any) -> Any:
        return interpreted(kernels.get(type(arguments[0]), default))(*arguments)

    # What is made of parts asks the same of its parts, which may be made of parts as well: to
    # numba that is one kernel that calls itself for other types, which it cannot link. So every
    # type has a kernel of its own.
    @cache
    def own_kernel(first: Any) -> Dispatcher:
        return recompiled(kernels.get(first.instance_class, default))

    @overload(call, jit_options=INLINED)
    def compile_call(first, *rest):
        own = own_kernel(first)
        return lambda first, *rest: own(first, *rest)

    def register(data_type: type) -> Callable[[Dispatcher], Dispatcher]:
        def add(answer: Dispatcher) -> Dispatcher:
            kernels[data_type] = answer
            return answer

        return add

    answering: Any = call
    answering.register = register
    answering.knows = lambda data: type(data) in kernels
    return answering
