"""
Compilation in the background: machine code for later calls, while the present call is interpreted.

A kernel that has no machine code asks for it here (``request``). A child process of low priority
(``compiler``) compiles into the cache on disk, one kernel after the other: what a call has asked
for first, then what a use of the package needs in general (``prepare``). A thread of this process
starts the child, reads its notices, and loads the machine code that it made, so that no call
waits.

The child ends by itself a few seconds after its work, and at once when this process ends, however
that happens. Whatever goes wrong with the child is logged in one line, and calls go on
interpreted.
"""

import atexit
import os
import threading
import time
from typing import Any, NamedTuple

from hnr_planner.core.kernels.background import Background
from hnr_planner.core.kernels.modes import Mode, mode
from hnr_planner.core.kernels.needs import known_needs, Need, need_of, Workload


class Status(NamedTuple):
    """
    State of compilation in the background, for this process.

    Kernels are counted once for each signature (the types of their arguments).
    """

    #: ``'compiled'`` if all machine code that was asked for is loaded; ``'interpreted'`` while
    #: some is pending, if some has failed, and in the mode ``interpreted``.
    tier: str
    #: Number of kernels whose machine code was asked for and is loaded.
    compiled: int
    #: Number of kernels that are asked for and neither loaded nor failed.
    pending: int
    #: Number of kernels that could not be compiled or loaded, and stay interpreted.
    failed: int
    #: Time [s] that children have worked, without their wait for more work.
    elapsed: float
    #: Whether the child is running.
    running: bool

    def __str__(self) -> str:
        """Return the status in words, for messages."""
        if self.pending:
            total = self.compiled + self.pending
            return f'compilation is under way, {self.compiled} of {total} kernels'
        if self.failed:
            return f'{self.failed} kernels could not be compiled and run interpreted'
        return 'all kernels asked for are compiled'


_background = Background()


def request(kernel: Any, signature: Any) -> None:
    """
    Ask the child for machine code of ``kernel`` for ``signature``, which a call has missed.

    Do nothing if it is asked for already, if compilation was given up, or if another process would
    not find the kernel or its types.
    """
    need = None if _background.has_given_up else need_of(kernel, signature)
    with _background.lock:
        if need is None or need in _background.asked:
            return
        _background.asked[need] = kernel, signature
        _background.ask(need)


def prepare(workload: Workload) -> None:
    """
    Load the machine code that a workload needs; have the child compile what the cache lacks.

    Both happen in the background, and only in the mode ``auto``; in other modes, and once
    compilation was given up, do nothing.
    """
    if mode() is Mode.AUTO and not _background.has_given_up:
        threading.Thread(target=_prepare, args=(workload,), daemon=True).start()


def _prepare(workload: Workload) -> None:
    needs = known_needs(workload)
    if needs is not None and all(_is_loaded(need) for need in needs):
        return
    with _background.lock:
        _background.workloads.append(workload)
        _background.ask(workload)


def _is_loaded(need: Need) -> bool:
    """Load the machine code of ``need`` if the cache has it; return whether it is loaded."""
    kernel, signature = need.resolve()
    return bool(kernel.load(signature))


def status() -> Status:
    """Return the present state of compilation in the background."""
    with _background.lock:
        pending = len(_background.asked) + len(_background.general)
        is_waiting = pending > 0 or bool(_background.workloads)
        is_compiled = not (is_waiting or _background.failed or mode() is Mode.INTERPRETED)
        running_for = 0.0
        if _background.is_running:
            until = time.monotonic() if is_waiting else _background.heard
            running_for = until - _background.started
        return Status(
            tier='compiled' if is_compiled else 'interpreted',
            compiled=_background.compiled,
            pending=pending,
            failed=_background.failed,
            elapsed=_background.worked + running_for,
            running=_background.process is not None,
        )


def _forget() -> None:
    """Reset the state in a forked process: the threads and the child belong to its parent."""
    global _background
    _background = Background()


def _end() -> None:
    """Kill the child when this process ends, and wait until the child has ended."""
    _background.is_ending = True
    process = _background.process
    if process is not None:
        process.kill()
        process.wait()


os.register_at_fork(after_in_child=_forget)
atexit.register(_end)
