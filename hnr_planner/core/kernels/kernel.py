"""
Kernels: functions that run as machine code, or interpreted until there is some.

``@kernel`` makes a function one. Kernels that call each other are compiled together by numba:
without the GIL, so that a node stays responsive while it plans, and into a cache on disk, so that
a machine compiles once. Where Python calls a kernel, the call takes the best tier there is:

1. machine code for these types of arguments, if it is loaded;
2. else machine code from the cache, loaded now;
3. else the interpreted form (``interpreted_form``), and a child process is asked to compile
   (``compilation``). When that is done, the next call finds it.

Both tiers give the same result to the last bit, so nobody needs to know which one answered.
``modes`` has the alternatives: to wait for the compiler, or never to compile.
"""

from collections.abc import Callable
from functools import cached_property
import logging
import threading
from typing import Any, TypeAlias

from hnr_planner.core.kernels import compilation
from hnr_planner.core.kernels.arithmetic import boxed
from hnr_planner.core.kernels.cache_folder import cache_folder, compiler_lock
from hnr_planner.core.kernels.clock import not_working
from hnr_planner.core.kernels.interpreted_form import interpreted_form
from hnr_planner.core.kernels.modes import Mode, mode, mode_of_thread
from hnr_planner.core.kernels.parts import Part
from numba import typeof
from numba.core import config, types
from numba.core.caching import FunctionCache
from numba.core.compiler_lock import global_compiler_lock
from numba.core.dispatcher import OmittedArg
from numba.core.registry import CPUDispatcher
import numpy as np

#: Types of the arguments of a call.
Signature: TypeAlias = tuple[Any, ...]

#: How numba compiles every kernel: without the GIL, with IEEE arithmetic kept to the bit, and
#: without a form that C could call, which nobody does.
OPTIONS: dict[str, Any] = {
    'nopython': True,
    'nogil': True,
    'error_model': 'numpy',
    'no_cfunc_wrapper': True,
}
#: For a kernel whose code is put in wherever a kernel calls it.
INLINED: Any = {'forceinline': True}

_log = logging.getLogger('hnr_planner')


class _OfThread(threading.local):
    """What is known of the calls of one thread."""

    #: Number of calls that ran interpreted.
    interpreted: int = 0
    #: Whether calls without machine code ask for it.
    asks: bool = True


_of_thread = _OfThread()
#: What Python has called in this process, in order.
_called: dict[tuple['Kernel', Signature], None] = {}


class _Cache(FunctionCache):
    """The cache of a kernel: where the disk is full, machine code is used, but not kept."""

    #: Why machine code could not be kept.
    not_kept: OSError | None = None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep machine code, or log that it cannot be kept."""
        try:
            super().save_overload(sig, data)
        except OSError as error:
            if self.not_kept is None:
                _log.warning('the machine code of %s cannot be kept: %s', self._name, error)
            self.not_kept = error


class Kernel(CPUDispatcher):
    """
    A function that numba compiles for each signature, and that runs interpreted until then.

    Numba's dispatcher finds machine code by the types of the arguments, in C: such a call costs
    nothing more. Only what happens where there is none is defined here.
    """

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        #: Signatures that were neither loaded nor in the cache.
        self._missing: set[Signature] = set()

    def _compile_for_args(self, *arguments: Any, **_keywords: Any) -> Callable[..., Any]:
        """Return what numba's dispatcher calls with these arguments, for which it has nothing."""
        wanted = mode()
        signature = None if wanted is Mode.INTERPRETED else _signature(arguments)
        if signature is not None:
            _called[self, signature] = None
        if wanted is Mode.COMPILED:
            with not_working():
                dispatcher: Any = super()
                return dispatcher._compile_for_args(*arguments)
        if signature is None or signature in self._missing:
            return self.interpreted
        with not_working():
            if self.load(signature):
                code: Any = self.overloads[signature]
                return code.entry_point
        if _of_thread.asks:
            self._missing.add(signature)
            compilation.request(self, signature)
        return self.interpreted

    def enable_caching(self) -> None:
        """Keep machine code in the cache folder."""
        self._cache = _Cache(self.py_func)

    @cached_property
    def part(self) -> Any:
        """The kernel as other kernels call it."""
        return Part(self.py_func, self.targetoptions)

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Type a call by another kernel: numba would compile it anew for each constant."""
        plain = {name: types.unliteral(kind) for name, kind in kws.items()}
        return self.part.get_call_template([types.unliteral(kind) for kind in args], plain)

    @property
    def is_compiling(self) -> Any:
        """Whether a call of this kernel, met in compilation, is one by itself."""
        return self._compiling_counter or self.part.is_compiling

    def get_overload(self, sig: Any) -> Any:
        """Return the key of the code that another kernel calls."""
        return self.part.get_overload(sig)

    def load(self, signature: Signature) -> bool:
        """Load machine code from the cache; return whether it is loaded. Never compile."""
        with global_compiler_lock:
            if signature in self.overloads:
                return True
            try:
                code = self._cache.load_overload(signature, self.targetctx)
            except Exception as error:  # whatever a damaged file makes of numba
                _log.warning('the cached machine code of %s cannot be used: %r', self, error)
                return False
            if code is None:
                return False
            self.targetctx.insert_user_function(code.entry_point, code.fndesc, [code.library])
            self.add_overload(code)
            return True

    def ensure_compiled(self, signature: Signature) -> bool:
        """
        Load machine code, or compile it into the cache; return whether it was compiled here.

        Processes that do this at the same time compile once: who waited for another finds what
        that one made.

        Raises
        ------
        OSError
            When it was compiled, but cannot be kept.

        """
        _called[self, signature] = None
        if self.load(signature):
            return False
        with compiler_lock():
            if self.load(signature):
                return False
            self.compile(signature)
            if self._cache.not_kept is not None:
                raise self._cache.not_kept
            return True

    @cached_property
    def interpreted_form(self) -> Callable[..., Any]:
        """The interpreted form, for other interpreted forms to call."""
        return interpreted_form(self.py_func)  # type: ignore[arg-type]

    def interpreted(self, *arguments: Any, **_keywords: Any) -> Any:
        """Run the interpreted form, and return what machine code would."""
        _of_thread.interpreted += 1
        given = [value.value if isinstance(value, OmittedArg) else value for value in arguments]
        with np.errstate(all='ignore'):  # as machine code does
            return boxed(self.interpreted_form(*given))


def _signature(arguments: tuple[Any, ...]) -> Signature | None:
    """Return the types of arguments; None where numba has none for one of them."""
    try:
        return tuple(
            types.Omitted(value.value) if isinstance(value, OmittedArg) else typeof(value)
            for value in arguments
        )
    except ValueError:
        return None


def kernel(function: Callable[..., Any], **more: Any) -> Kernel:
    """Make a function a kernel; ``more`` are further options of numba's."""
    numba_config: Any = config
    before = numba_config.CACHE_DIR
    numba_config.CACHE_DIR = str(cache_folder())
    try:
        made = Kernel(function, targetoptions={'boundscheck': None, **OPTIONS, **more})
        made.enable_caching()
        return made
    finally:
        numba_config.CACHE_DIR = before


def inlined(function: Callable[..., Any]) -> Kernel:
    """
    Make a function a kernel whose code is put in wherever a kernel calls it.

    A call hands on every field of every array: for the small parts of an inner loop that is more
    work than they do themselves.
    """
    return kernel(function, **INLINED)


def another(original: Kernel) -> Kernel:
    """Return another kernel of the same function, which shares the machine code in the cache."""
    is_inlined = original.targetoptions.get('forceinline', False)
    return kernel(original.py_func, **(INLINED if is_inlined else {}))


def interpreted(function: Any) -> Callable[..., Any]:
    """Return a kernel, or a dispatched function, as one that always runs interpreted."""
    return function.interpreted


def interpreted_calls() -> int:
    """
    Return how many calls of kernels this thread has run interpreted so far.

    Compare before and after a piece of work: where it has not changed, machine code did it all.
    """
    return _of_thread.interpreted


def calls_of(work: Callable[[], None], tier: Mode = Mode.AUTO) -> list[tuple[Kernel, Signature]]:
    """
    Return which machine code some work needs: do it, interpreted where there is none.

    Nobody is asked to compile. What this process has called before is in the list too.
    """
    _of_thread.asks = False
    try:
        with mode_of_thread(tier):
            work()
    finally:
        _of_thread.asks = True
    return list(_called)
