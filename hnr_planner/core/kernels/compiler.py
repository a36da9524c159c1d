"""
The child process that compiles: ``python -m hnr_planner.core.kernels.compiler PARENT``.

It reads needs and workloads from its standard input, compiles into the cache folder, and writes a
notice for each need to its standard output. Needs that were asked for come before those that a
workload has. It ends when it has had nothing to do for a while, and with its parent.
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

from hnr_planner.core.kernels.compilation import Notice
from hnr_planner.core.kernels.kernel import calls_of
from hnr_planner.core.kernels.needs import keep_needs, known_needs, Need, need_of, Workload

#: Time [s] after which it ends for want of work.
PATIENCE = 5.0
#: Order of work: what a call waits for, what uses need, and to find out what that is.
ASKED, GENERAL = 0, 2
FIND_OUT = 1
#: ``PR_SET_PDEATHSIG`` of ``prctl``.
_DEATH_SIGNAL = 1


def main(parent: int) -> None:
    """Work until there is nothing to do, or ``parent`` has ended."""
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
        if isinstance(message, Need):
            _tell(notices, Notice(message, _compile(message)))
        else:
            try:
                needs, failure = needs_of(message), ''
            except Exception as error:
                needs, failure = [], _reason(error)
            _tell(notices, Notice(needs, failure))
            for need in needs:
                work.put((GENERAL, next(numbers), need))


def _end_with(parent: int) -> None:
    """Let the system end this process when its parent ends, where it can; see ``_read`` too."""
    if sys.platform == 'linux':
        ctypes.CDLL(None).prctl(_DEATH_SIGNAL, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(1)


def _read(messages: BinaryIO, work: Any, numbers: Any) -> None:
    """Put messages in order as they come; end the process when the other end is closed."""
    try:
        while True:
            message = pickle.load(messages)
            order = ASKED if isinstance(message, Need) else FIND_OUT
            work.put((order, next(numbers), message))
    finally:
        os._exit(0)


def _tell(notices: BinaryIO, notice: Notice) -> None:
    pickle.dump(notice, notices)
    notices.flush()


def _compile(need: Need) -> str:
    """Have machine code in the cache; return why not, or nothing."""
    try:
        kernel, signature = need.resolve()
        kernel.ensure_compiled(signature)
    except Exception as error:  # whatever numba, the disk or an import has to say
        return _reason(error)
    return ''


def _reason(error: Exception) -> str:
    return f'{type(error).__name__}: {error}'.partition('\n')[0]


def needs_of(workload: Workload) -> list[Need]:
    """Return what a workload needs: as it was found before, or by running it interpreted."""
    known = known_needs(workload)
    if known is not None:
        return known
    needs = [need for call in calls_of(workload.run) if (need := need_of(*call)) is not None]
    keep_needs(workload, needs)
    return needs


if __name__ == '__main__':
    main(int(sys.argv[1]))
