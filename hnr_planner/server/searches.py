"""The searches that are running, let in while the node is active."""

from collections.abc import Iterator
from contextlib import contextmanager
import threading

from hnr_planner.server.outcomes import Outcome, Refusal

WHY_DISABLED = 'the node is not active: configure and activate it, or start it with autostart true'


class RunningSearches:
    """A register of running searches; each one watches its own event."""

    def __init__(self) -> None:
        self._events: set[threading.Event] = set()
        self._lock = threading.Lock()
        self._enabled = False

    @contextmanager
    def one(self, cancel: threading.Event) -> Iterator[None]:
        """
        Register a search for the length of a `with` block; `cancel` tells it to end.

        Raises
        ------
        Refusal
            NOT_ACTIVE, when no searches are let in.

        """
        with self._lock:
            self.check_enabled()
            self._events.add(cancel)
        try:
            yield
        finally:
            with self._lock:
                self._events.discard(cancel)

    def check_enabled(self) -> None:
        """Raise Refusal (NOT_ACTIVE) when no searches are let in."""
        if not self._enabled:
            raise Refusal(Outcome.NOT_ACTIVE, WHY_DISABLED)

    def __len__(self) -> int:
        """Return how many are running."""
        return len(self._events)

    def cancel(self) -> int:
        """Tell all running searches to end and return how many were told."""
        with self._lock:
            for event in self._events:
                event.set()
            return len(self._events)

    def enable(self) -> None:
        """Let searches in."""
        with self._lock:
            self._enabled = True

    def disable(self) -> None:
        """Let no more searches in, and tell those that run to end."""
        with self._lock:
            self._enabled = False
        self.cancel()
