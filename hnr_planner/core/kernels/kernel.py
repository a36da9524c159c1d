"""
Kernels: functions that run as machine code, or interpreted until machine code is there.

The decorator ``@kernel`` makes a function a kernel. Kernels that call each other are compiled
together by numba: without the GIL, so that a node stays responsive while it plans, and into a
cache on disk, so that a machine compiles once. When Python calls a kernel, the call runs the first
of these that exists:

1. machine code for these types of arguments, if it is loaded;
2. else machine code from the cache, loaded now;
3. else the interpreted form (``interpreted_form``), and a child process is asked to compile
   (``compilation``). When the machine code is loaded, the next call runs it.

Machine code and the interpreted form give the same result to the last bit. The list above is the
mode ``auto``; module ``modes`` has the others: wait for the compiler, or never compile.
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
from hnr_planner.core.kernels.modes import announce_compilation, Mode, mode, mode_of_thread
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
#: Further options of an inlined kernel: its code is copied into every kernel that calls it.
INLINED: Any = {'forceinline': True}

_log = logging.getLogger('hnr_planner')


class _OfThread(threading.local):
    """Record of the kernel calls of one thread, and whether they ask for machine code."""

    #: Number of calls that ran interpreted.
    interpreted: int = 0
    #: Whether calls without machine code ask for it.
    asks: bool = True


_of_thread = _OfThread()
#: What Python has called in this process, in order.
_called: dict[tuple['Kernel', Signature], None] = {}


class _Cache(FunctionCache):
    """
    The cache of one kernel on disk; machine code that cannot be written is still used.

    What cannot be read is compiled anew: files that are damaged, and an index that names types of
    a module which is gone, because somebody's program has called the kernel with them.
    """

    #: The last error in writing machine code; None if there was none.
    not_kept: OSError | None = None

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return machine code from disk; None if none can be read, with a warning of why."""
        try:
            return super().load_overload(sig, target_context)
        except Exception as error:  # whatever a damaged file makes of numba
            _log.warning('the cached machine code of %s cannot be used: %r', self._name, error)
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Write machine code to disk; if that fails, keep the error, and log the first one."""
        try:
            self._save(sig, data)
        except OSError as error:
            if self.not_kept is None:
                _log.warning('the machine code of %s cannot be kept: %s', self._name, error)
            self.not_kept = error

    def _save(self, sig: Any, data: Any) -> None:
        """Write machine code to disk; begin a new index if the present one cannot be read."""
        try:
            super().save_overload(sig, data)
        except OSError:
            raise
        except Exception:  # whatever a damaged index makes of numba
            self.flush()
            super().save_overload(sig, data)


class Kernel(CPUDispatcher):
    """
    A function that numba compiles for each signature, and that runs interpreted until then.

    Numba's dispatcher finds loaded machine code by the types of the arguments, in C, so that such
    a call costs no more than with numba alone. This class defines what happens if none is loaded.
    """

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        #: Signatures that were neither loaded nor in the cache.
        self._missing: set[Signature] = set()

    def _compile_for_args(self, *arguments: Any, **_keywords: Any) -> Callable[..., Any]:
        """
        Return what numba's dispatcher calls if it has no machine code loaded for the arguments.

        That is machine code, compiled now in the mode ``compiled`` or loaded from the cache in the
        mode ``auto``; else the interpreted form.
        """
        wanted = mode()
        signature = None if wanted is Mode.INTERPRETED else _signature(arguments)
        if signature is not None:
            _called[self, signature] = None
        if wanted is Mode.COMPILED:
            with not_working():
                if signature is not None and not self.load(signature):
                    announce_compilation()
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
        """Read and write the kernel's machine code in the cache folder from now on."""
        self._cache = _Cache(self.py_func)

    @cached_property
    def part(self) -> Any:
        """The ``Part`` that compiles this kernel for calls by other kernels."""
        return Part(self.py_func, self.targetoptions)

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """
        Return numba's template for a call by another kernel.

        Constants among the arguments count as values of their type, since numba would compile the
        kernel anew for each constant.
        """
        plain = {name: types.unliteral(kind) for name, kind in kws.items()}
        return self.part.get_call_template([types.unliteral(kind) for kind in args], plain)

    @property
    def is_compiling(self) -> Any:
        """Whether this kernel or its part is being compiled, so that a call is recursive."""
        return self._compiling_counter or self.part.is_compiling

    def get_overload(self, sig: Any) -> Any:
        """Return numba's key of the code that another kernel calls with signature ``sig``."""
        return self.part.get_overload(sig)

    def load(self, signature: Signature) -> bool:
        """
        Load machine code for ``signature`` from the cache, but never compile.

        Return whether it is loaded now. A cached file that cannot be read counts as missing, with
        a warning in the log.
        """
        with global_compiler_lock:
            if signature in self.overloads:
                return True
            code = self._cache.load_overload(signature, self.targetctx)
            if code is None:
                return False
            self.targetctx.insert_user_function(code.entry_point, code.fndesc, [code.library])
            self.add_overload(code)
            return True

    def ensure_compiled(self, signature: Signature) -> bool:
        """
        Load machine code for ``signature``, or compile it into the cache if it is missing.

        Return whether it was compiled by this call. Of several processes that do this at the same
        time one compiles; the others wait for it, and load what it made.

        Raises
        ------
        OSError
            When it was compiled, but could not be written into the cache.

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
        """This kernel as Python with the arithmetic of machine code; it calls such forms only."""
        return interpreted_form(self.py_func)  # type: ignore[arg-type]

    def interpreted(self, *arguments: Any, **_keywords: Any) -> Any:
        """Run the interpreted form in any mode; return what machine code would return."""
        _of_thread.interpreted += 1
        given = [value.value if isinstance(value, OmittedArg) else value for value in arguments]
        with np.errstate(all='ignore'):  # as machine code does
            return boxed(self.interpreted_form(*given))


def _signature(arguments: tuple[Any, ...]) -> Signature | None:
    """Return numba's types of the arguments; None if one of them has no type in numba."""
    try:
        return tuple(
            types.Omitted(value.value) if isinstance(value, OmittedArg) else typeof(value)
            for value in arguments
        )
    except ValueError:
        return None


def kernel(function: Callable[..., Any], **more: Any) -> Kernel:
    """Return ``function`` as a kernel; ``more`` are options of numba beyond ``OPTIONS``."""
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
    Return ``function`` as a kernel whose code is copied into every kernel that calls it.

    A call hands on every field of every array: for a small function in an inner loop that is more
    work than the function does itself.
    """
    return kernel(function, **INLINED)


def another(original: Kernel) -> Kernel:
    """Return a further kernel of the function of ``original``, with the same cache on disk."""
    is_inlined = original.targetoptions.get('forceinline', False)
    return kernel(original.py_func, **(INLINED if is_inlined else {}))


def interpreted(function: Any) -> Callable[..., Any]:
    """Return a callable that runs a kernel or dispatched function interpreted in any mode."""
    return function.interpreted


def interpreted_calls() -> int:
    """
    Return how many calls of kernels from Python this thread has run interpreted so far.

    If the number is the same before and after a piece of work, the work ran as machine code alone.
    """
    return _of_thread.interpreted


def calls_of(work: Callable[[], None], tier: Mode = Mode.AUTO) -> list[tuple[Kernel, Signature]]:
    """
    Run ``work``, and return the kernels and signatures that Python has called in this process.

    They name the machine code that the work needs. ``work`` runs in the mode ``tier``; in the mode
    ``auto``, calls without machine code run interpreted and do not ask for it. Calls before
    ``work`` are in the list too.
    """
    _of_thread.asks = False
    try:
        with mode_of_thread(tier):
            work()
    finally:
        _of_thread.asks = True
    return list(_called)
