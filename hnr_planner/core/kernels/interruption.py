"""
Interruption of interpreted kernels: how a time limit or a cancellation ends them.

A compiled kernel works in batches so short that its caller looks at the clock between them. The
same batch interpreted takes hundreds of times longer. So interpreted kernels check a condition by
themselves:

>>> with interruptible(lambda: working_time() > deadline or cancel.is_set()):
...     search.advance(n)  # raises Interrupted soon after the condition holds

The condition belongs to the thread that set it. Blocks may be nested: kernels in the inner block
check its condition and those of the blocks around it. A kernel that was interrupted leaves the
arrays that it writes half written: the caller may still use only what it had before that call.
"""

from collections.abc import Callable
import threading
import time

from hnr_planner.core.errors import Interrupted

#: Shortest time [s] between two checks of the condition.
CHECK_INTERVAL = 1e-3


class _Condition(threading.local):
    """The condition on which one thread's interpreted kernels are interrupted."""

    #: Whether work is to end; None outside of every ``interruptible`` block.
    stop: Callable[[], bool] | None = None
    #: Value of ``time.perf_counter()`` from which the condition is checked again.
    next_check: float = 0.0


_condition = _Condition()


class interruptible:
    """
    Let interpreted kernels of this thread raise Interrupted once ``stop()`` is true in a block.

    Compiled kernels do not check the condition. It is a class since every request enters several
    blocks, and a generator costs three times as much.

    Parameters
    ----------
    stop : callable
        Called without arguments, in this thread, at most every millisecond, by the loops of
        interpreted kernels.

    """

    __slots__ = ('_outer', '_stop')

    def __init__(self, stop: Callable[[], bool]) -> None:
        self._stop = stop

    def __enter__(self) -> None:
        """Add the condition to those of the blocks around this one."""
        stop, outer = self._stop, _condition.stop
        self._outer = outer
        _condition.stop = stop if outer is None else lambda: outer() or stop()
        _condition.next_check = 0.0

    def __exit__(self, *_: object) -> None:
        """Restore the condition of the blocks around this one."""
        _condition.stop = self._outer


def check() -> None:
    """
    Raise Interrupted if the condition of this thread holds.

    Evaluate the condition at most every ``CHECK_INTERVAL`` seconds; outside of every
    ``interruptible`` block, do nothing.
    """
    stop = _condition.stop
    if stop is None:
        return
    now = time.perf_counter()
    if now < _condition.next_check:
        return
    _condition.next_check = now + CHECK_INTERVAL
    if stop():
        raise Interrupted('the work was interrupted before it was done')
