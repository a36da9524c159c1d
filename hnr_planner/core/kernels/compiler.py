"""
The child process that compiles: ``python -m hnr_planner.core.kernels.compiler PARENT``.

It reads needs and workloads from its standard input, compiles into the cache folder, and writes a
notice for each need and each workload to its standard output. Needs that calls have asked for are
compiled before those of workloads. The process ends when it has had no work for ``PATIENCE``
seconds, and when its parent ends.
"""

import ctypes
import itertools
import os
import pickle
import queue
import signal
import sys
import threading
from typing import Any, BinaryIO

from hnr_planner.core.kernels.background import Notice
from hnr_planner.core.kernels.needs import Need, Workload
from hnr_planner.core.kernels.workloads import needs_of

#: Time [s] without work after which the process ends.
PATIENCE = 5.0
#: Order of work: compile what a call has asked for; find out what a workload needs; compile that.
ASKED, WORKLOAD, GENERAL = range(3)
#: ``PR_SET_PDEATHSIG`` of ``prctl``.
_DEATH_SIGNAL = 1


def main(parent: int) -> None:
    """Work until there was no work for ``PATIENCE`` seconds, or process ``parent`` has ended."""
    notices = os.fdopen(os.dup(1), 'wb')
    os.dup2(2, 1)  # whatever prints does not come between
    _end_with(parent)
    os.nice(19)
    work: Any = queue.PriorityQueue()
    numbers = itertools.count()
    threading.Thread(target=_read, args=(sys.stdin.buffer, work, numbers), daemon=True).start()
    while True:
        try:
            _, _, message = work.get(timeout=PATIENCE)
        except queue.Empty:
            return
        notice = _compile(message) if isinstance(message, Need) else _find_out(message)
        pickle.dump(notice, notices)
        notices.flush()
        if isinstance(notice.about, list):
            for need in notice.about:
                work.put((GENERAL, next(numbers), need))


def _end_with(parent: int) -> None:
    """
    Let the system end this process when process ``parent`` ends, on Linux.

    Elsewhere ``_read`` ends it, when the parent's end of the input is closed. If ``parent`` has
    ended already, end at once.
    """
    if sys.platform == 'linux':
        ctypes.CDLL(None).prctl(_DEATH_SIGNAL, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(1)


def _read(messages: BinaryIO, work: Any, numbers: Any) -> None:
    """Put messages into the queue ``work`` by their order; end the process when input ends."""
    try:
        while True:
            message = pickle.load(messages)
            order = ASKED if isinstance(message, Need) else WORKLOAD
            work.put((order, next(numbers), message))
    finally:
        os._exit(0)


def _compile(need: Need) -> Notice:
    """Compile a need into the cache, unless it is there; return a notice, with any failure."""
    try:
        kernel, signature = need.resolve()
        kernel.ensure_compiled(signature)
    except Exception as error:  # whatever numba, the disk or an import has to say
        return Notice(need, _reason(error))
    return Notice(need)


def _find_out(workload: Workload) -> Notice:
    """Return a notice of all needs of a workload, or of why they could not be found."""
    try:
        return Notice(needs_of(workload))
    except Exception as error:  # whatever its own calls raise
        return Notice([], _reason(error))


def _reason(error: Exception) -> str:
    return f'{type(error).__name__}: {error}'.partition('\n')[0]


if __name__ == '__main__':
    main(int(sys.argv[1]))
