"""A callback group that leaves some of the executor's threads to other groups."""

from collections.abc import Callable
import threading
from typing import Any

from rclpy.callback_groups import CallbackGroup


class BoundedCallbackGroup(CallbackGroup):
    """
    A group of which at most ``limit`` callbacks run at once; others wait for their turn.

    Searches are in one such group, with a limit below the number of threads: so there is always a
    thread for cancelling them. ``afterwards`` is called without arguments when a callback of the
    group has ended, in the same thread; the response of a service has been sent by then.
    """

    def __init__(self, limit: int, afterwards: Callable[[], None]) -> None:
        super().__init__()
        self._free = limit
        self._afterwards = afterwards
        self._lock = threading.Lock()

    def can_execute(self, entity: Any) -> bool:
        """Return whether fewer than ``limit`` callbacks of the group are running."""
        return self._free > 0

    def beginning_execution(self, entity: Any) -> bool:
        """Count one more running callback if the limit allows it, and return whether it does."""
        with self._lock:
            if self._free == 0:
                return False
            self._free -= 1
            return True

    def ending_execution(self, entity: Any) -> None:
        """Count one running callback less, and call ``afterwards``."""
        self.end()

    def end(self) -> bool:
        """
        Count one running callback less, and call ``afterwards``.

        Return whether the group was full: whether another callback may have waited for its turn.
        """
        with self._lock:
            was_full = self._free == 0
            self._free += 1
        self._afterwards()
        return was_full
