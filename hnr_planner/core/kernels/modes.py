"""
Modes: what happens when Python calls a kernel that has no machine code loaded.

``auto`` (the default): the call loads machine code from the cache; if there is none, it runs
interpreted, and a child process compiles meanwhile.
``compiled``: the call waits until the kernel is loaded or compiled in this process, as in tests.
``interpreted``: nothing is ever compiled or loaded.

The environment variable ``HNR_PLANNER_KERNELS`` sets the mode of a process; with
``NUMBA_DISABLE_JIT`` it is ``interpreted``.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from enum import Enum
from functools import partial
import logging
import os
import threading
from typing import Any, ParamSpec, TypeVar

from hnr_planner.core.checks import check_choice
from numba.core import config

Arguments = ParamSpec('Arguments')
Returned = TypeVar('Returned')

#: The environment variable that sets the mode.
VARIABLE = 'HNR_PLANNER_KERNELS'


class Mode(Enum):
    """
    How a kernel runs that Python calls and that has no machine code loaded.

    AUTO: interpreted, unless the cache has its machine code. COMPILED: once its machine code is
    loaded or compiled. INTERPRETED: interpreted, whatever the cache has.
    """

    AUTO = 'auto'
    COMPILED = 'compiled'
    INTERPRETED = 'interpreted'


class _OfThread(threading.local):
    """The mode that one thread has set for itself, and what it waits for machine code for."""

    #: None if the process's mode applies.
    mode: Mode | None = None
    #: None if no compilation is to be announced.
    purpose: str | None = None


def _checked(name: str, wanted: str) -> Mode:
    """Return the mode called ``wanted``, or raise a RequestError about the argument ``name``."""
    return Mode(check_choice(name, wanted, tuple(mode.value for mode in Mode)))


_log = logging.getLogger('hnr_planner')
_numba_config: Any = config
_of_process = _checked(VARIABLE, os.environ.get(VARIABLE) or Mode.AUTO.value)
_of_thread = _OfThread()


def mode() -> Mode:
    """
    Return the mode that applies in this thread.

    It is ``INTERPRETED`` if numba is disabled, else the thread's own mode if it has set one, else
    the mode of the process.
    """
    if _numba_config.DISABLE_JIT:
        return Mode.INTERPRETED
    return _of_thread.mode or _of_process


def set_mode(wanted: Mode | str) -> None:
    """
    Set the mode of this process, for threads that have not set their own.

    Machine code that is loaded already stays in use in every mode.

    Raises
    ------
    RequestError
        When ``wanted`` is not the name of a mode.

    """
    global _of_process
    _of_process = _checked('mode', wanted.value if isinstance(wanted, Mode) else wanted)


@contextmanager
def mode_of_thread(wanted: Mode) -> Iterator[None]:
    """Set the mode of this thread within a block, and restore the mode before at its end."""
    before = _of_thread.mode
    _of_thread.mode = wanted
    try:
        yield
    finally:
        _of_thread.mode = before


def in_this_mode(function: Callable[Arguments, Returned]) -> Callable[Arguments, Returned]:
    """
    Return ``function`` such that it runs in the present mode of this thread wherever it is called.

    It is for threads, processes and clusters that take over work of this thread. ``auto`` leaves
    the choice to them: then the function itself is returned. Otherwise it can be pickled if the
    function can.
    """
    here = mode()
    return function if here is Mode.AUTO else partial(_run, here, function)


def _run(
    wanted: Mode,
    function: Callable[Arguments, Returned],
    *arguments: Arguments.args,
    **options: Arguments.kwargs,
) -> Returned:
    """Call a function with ``wanted`` as the mode of this thread; return what it returns."""
    with mode_of_thread(wanted):
        return function(*arguments, **options)


@contextmanager
def waiting_for_machine_code(purpose: str) -> Iterator[None]:
    """
    Let calls of this thread wait for the compiler within a block, if the mode is ``auto``.

    It is for work that would take far longer with interpreted kernels. Other modes stay.
    ``purpose`` names the work for the log, which says once in a block that the compiler runs.
    """
    with mode_of_thread(Mode.COMPILED if mode() is Mode.AUTO else mode()):
        before, _of_thread.purpose = _of_thread.purpose, purpose
        try:
            yield
        finally:
            _of_thread.purpose = before


def announce_compilation() -> None:
    """Log that the compiler runs, if this thread waits for it and has not logged that yet."""
    purpose, _of_thread.purpose = _of_thread.purpose, None
    if purpose is not None:
        _log.warning('%s waits for the compiler, once on this machine', purpose)
