"""
Modes: what happens where a kernel has no machine code yet.

``auto`` (the default): the call runs interpreted, and a child process compiles meanwhile.
``compiled``: the call waits until the kernel is compiled in this process, as in tests.
``interpreted``: nothing is ever compiled or loaded.

The environment variable ``HNR_PLANNER_KERNELS`` sets the mode of a process; with
``NUMBA_DISABLE_JIT`` it is ``interpreted``.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from enum import Enum
import os
import threading
from typing import Any

from hnr_planner.core.checks import check_choice
from numba.core import config

#: The environment variable that sets the mode.
VARIABLE = 'HNR_PLANNER_KERNELS'


class Mode(Enum):
    """What to do where a kernel has no machine code yet."""

    AUTO = 'auto'
    COMPILED = 'compiled'
    INTERPRETED = 'interpreted'


class _OfThread(threading.local):
    """The mode that one thread has chosen for itself."""

    mode: Mode | None = None


def _checked(name: str, wanted: str) -> Mode:
    """Return the mode of a name, or raise RequestError."""
    return Mode(check_choice(name, wanted, tuple(mode.value for mode in Mode)))


_numba_config: Any = config
_of_process = _checked(VARIABLE, os.environ.get(VARIABLE) or Mode.AUTO.value)
_of_thread = _OfThread()


def mode() -> Mode:
    """Return the mode of this thread."""
    if _numba_config.DISABLE_JIT:
        return Mode.INTERPRETED
    return _of_thread.mode or _of_process


def set_mode(wanted: Mode | str) -> None:
    """
    Set the mode of this process.

    Machine code that is loaded already stays in use.

    Raises
    ------
    RequestError
        When there is no such mode.

    """
    global _of_process
    _of_process = _checked('mode', wanted.value if isinstance(wanted, Mode) else wanted)


@contextmanager
def mode_of_thread(wanted: Mode) -> Iterator[None]:
    """Set the mode of this thread within a block."""
    before = _of_thread.mode
    _of_thread.mode = wanted
    try:
        yield
    finally:
        _of_thread.mode = before


@contextmanager
def waiting_for_machine_code() -> Iterator[None]:
    """Wait for the compiler within a block in which interpreted kernels would take far longer."""
    with mode_of_thread(Mode.COMPILED if mode() is Mode.AUTO else mode()):
        yield
