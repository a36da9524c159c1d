"""
Functions whose kernel is picked by the type of their first argument.

What ``functools.singledispatch`` is to Python, ``dispatched`` is to kernels. The decorated
kernel states the contract, and answers for every type that registers no other:

>>> @dispatched
... @kernel
... def area(shape):
...     raise NotImplementedError
>>> @area.register(DiscData)
... @kernel
... def _area(disc):
...     return math.pi * disc.radius**2

Compiled code that calls ``area`` gets the kernel for the NamedTuple that it is compiled for, and
looks nothing up when it runs. A call of ``area`` from Python is a call of the kernel for its
argument, as machine code or interpreted (``kernel``). Interpreted code calls the interpreted form
of that kernel.
"""

from collections.abc import Callable
from functools import cache, wraps
from typing import Any, Protocol

from hnr_planner.core.kernels.kernel import another, Kernel
from numba import typeof
from numba.core import types
from numba.core.typing.templates import infer_global
from numba.extending import models, register_model


class Dispatched(Protocol):
    """A function with a kernel for each type of its first argument."""

    def __call__(self, *arguments: Any) -> Any:
        """Call the kernel for the type of the first argument, and return its result."""

    def interpreted(self, *arguments: Any) -> Any:
        """Run the kernel for the type of the first argument, interpreted in any mode."""

    def interpreted_form(self, *arguments: Any) -> Any:
        """Call the interpreted form of the kernel for the type of the first argument."""

    def kernel_for(self, first: Any) -> Kernel:
        """Return the kernel for the type of ``first``, or the default if none is registered."""

    def register(self, data_type: type) -> Callable[[Kernel], Kernel]:
        """Return a decorator that registers a kernel for first arguments of ``data_type``."""

    def knows(self, data: Any) -> bool:
        """Return whether a kernel is registered for the type of ``data``."""


class _DispatchedType(types.Callable, types.Dummy):
    """Numba's type of a dispatched function: a call of it is a call of the kernel it picks."""

    def __init__(self, function: Any, kernel_for: Callable[[Any], Kernel]) -> None:
        self.kernel_for = kernel_for
        super().__init__(f'dispatched({function.__module__}.{function.__qualname__})')

    def _type_for(self, arguments: Any) -> Any:
        return typeof(self.kernel_for(arguments[0]))

    def get_call_type(self, context: Any, args: Any, kws: Any) -> Any:
        """Return numba's type of a call: that of the kernel for the first argument's type."""
        return self._type_for(args).get_call_type(context, args, kws)

    def get_call_signatures(self) -> tuple[Any, bool]:
        """Return no signatures, since each registered kernel has its own."""
        return (), True

    def get_impl_key(self, sig: Any) -> Any:
        """Return numba's key of the code that a call with signature ``sig`` runs."""
        return self._type_for(sig.args).get_impl_key(sig)


register_model(_DispatchedType)(models.OpaqueModel)


def dispatched(default: Kernel) -> Dispatched:
    """
    Make a kernel the default of a function that picks its kernel by the first argument's type.

    Kernels for other types are added with ``register``.
    """
    kernels: dict[type, Kernel] = {}

    def kernel_for(first: Any) -> Kernel:
        return kernels.get(type(first), default)

    @wraps(default.py_func)
    def call(*arguments: Any) -> Any:
        return kernel_for(arguments[0])(*arguments)

    # What has members asks the same of its members, which may have members as well: to numba that
    # is one kernel that calls itself for other types, which it cannot link. So every such type has
    # a kernel of its own.
    @cache
    def own_kernel(first: Any) -> Kernel:
        registered = kernels.get(first.instance_class, default)
        return another(registered) if _has_members(first) else registered

    infer_global(call, _DispatchedType(call, own_kernel))

    def register(data_type: type) -> Callable[[Kernel], Kernel]:
        def add(answer: Kernel) -> Kernel:
            kernels[data_type] = answer
            return answer

        return add

    def run_interpreted(*arguments: Any) -> Any:
        return kernel_for(arguments[0]).interpreted(*arguments)

    def call_form(*arguments: Any) -> Any:
        return kernels.get(type(arguments[0]), default).interpreted_form(*arguments)

    answering: Any = call
    answering.interpreted = run_interpreted
    answering.interpreted_form = call_form
    answering.kernel_for = kernel_for
    answering.register = register
    answering.knows = lambda data: type(data) in kernels
    return answering


def _has_members(data: Any) -> bool:
    """Return whether numba's tuple type ``data`` holds a NamedTuple, at any depth."""
    return any(
        isinstance(member, types.BaseNamedTuple)
        or (isinstance(member, types.BaseTuple) and _has_members(member))
        for member in data
    )
