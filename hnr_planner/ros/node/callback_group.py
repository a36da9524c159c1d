"""A callback group that keeps some of the executor's threads for others."""

from collections.abc import Callable
import threading
from typing import Any

from rclpy.callback_groups import CallbackGroup


class BoundedCallbackGroup(CallbackGroup):
    """
    Let at most ``limit`` callbacks of this group run at once; more wait for their turn.

    Searches are in one such group, smaller than the number of threads: so there is always a
    thread for cancelling them. ``afterwards`` is called when a callback of a service has ended and
    its response has been sent, in the same thread.
    """

    def __init__(self, limit: int, afterwards: Callable[[], None]) -> None:
        super().__init__()
        self._free = limit
        self._afterwards = afterwards
        self._lock = threading.Lock()

    def can_execute(self, entity: Any) -> bool:
        """Return whether there is room."""
        return self._free > 0

    def beginning_execution(self, entity: Any) -> bool:
        """Take a place if there is one, and return whether there was."""
        with self._lock:
            if self._free == 0:
                return False
            self._free -= 1
            return True

    def ending_execution(self, entity: Any) -> None:
        """Give the place back."""
        with self._lock:
            self._free += 1
        self._afterwards()
