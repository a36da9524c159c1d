"""
Interruption of interpreted kernels: how a time limit or a cancellation ends them.

A compiled kernel works in batches so short that its caller looks at the clock between them. The
same batch interpreted takes hundreds of times longer. So interpreted kernels ask by themselves:

>>> with interruptible(lambda: working_time() > deadline or cancel.is_set()):
...     search.advance(n)  # raises Interrupted soon after the condition holds

The condition belongs to the thread that set it. Blocks may be nested: an inner one asks its own
condition and those of the blocks around it. A kernel that was interrupted leaves the arrays that
it writes to half written: what the caller may still use is what it had before that call.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
import threading
import time

from hnr_planner.core.errors import Interrupted

#: Shortest time [s] between two looks at the condition.
CHECK_INTERVAL = 1e-3


class _Condition(threading.local):
    """The condition of one thread."""

    #: Whether work is to end; None outside of every ``interruptible`` block.
    stop: Callable[[], bool] | None = None
    #: ``time.perf_counter()`` from which the condition is looked at again.
    next_check: float = 0.0


_condition = _Condition()


@contextmanager
def interruptible(stop: Callable[[], bool]) -> Iterator[None]:
    """
    Let interpreted kernels of this thread raise Interrupted once ``stop()`` is true.

    Parameters
    ----------
    stop : callable
        Called about every millisecond, between steps of interpreted kernels, in this thread.

    """
    outer = _condition.stop
    _condition.stop = stop if outer is None else lambda: outer() or stop()
    _condition.next_check = 0.0
    try:
        yield
    finally:
        _condition.stop = outer


def check() -> None:
    """Raise Interrupted if the condition of this thread holds; look at it every millisecond."""
    stop = _condition.stop
    if stop is None:
        return
    now = time.perf_counter()
    if now < _condition.next_check:
        return
    _condition.next_check = now + CHECK_INTERVAL
    if stop():
        raise Interrupted('the work was interrupted before it was done')
