"""
The clock of time limits: time of a thread without what it spent on machine code.

The first call of a kernel may compile it or load its machine code. How long that takes depends
on the machine's past, not on the request, so a time limit does not count it: ``working_time()``
stands still inside ``with not_working():``.
"""

from collections.abc import Iterator
from contextlib import contextmanager
import threading
import time


class _Waiting(threading.local):
    """Time that one thread has spent in ``not_working`` blocks."""

    #: Time [s] in blocks that have ended.
    total: float = 0.0
    #: Number of blocks that are open, one in the other.
    depth: int = 0
    #: ``time.perf_counter()`` when the outermost open block began.
    since: float = 0.0


_waiting = _Waiting()


def working_time() -> float:
    """Return ``time.perf_counter()`` [s] less what this thread spent in ``not_working`` blocks."""
    now = _waiting.since if _waiting.depth else time.perf_counter()
    return now - _waiting.total


@contextmanager
def not_working() -> Iterator[None]:
    """Stop ``working_time`` of this thread within a block that compiles or loads machine code."""
    if _waiting.depth == 0:
        _waiting.since = time.perf_counter()
    _waiting.depth += 1
    try:
        yield
    finally:
        _waiting.depth -= 1
        if _waiting.depth == 0:
            _waiting.total += time.perf_counter() - _waiting.since
