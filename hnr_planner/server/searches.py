"""The searches that are running; they are admitted while the node is active."""

from collections.abc import Iterator
from contextlib import contextmanager
import threading

from hnr_planner.server.outcomes import Outcome, Refusal

WHY_DISABLED = 'the node is not active: configure and activate it, or start it with autostart true'


class RunningSearches:
    """A register of running searches; each one ends once its own event is set."""

    def __init__(self) -> None:
        self._events: set[threading.Event] = set()
        self._lock = threading.Lock()
        self._enabled = False

    @contextmanager
    def one(self, cancel: threading.Event) -> Iterator[None]:
        """
        Register a search for the length of a ``with`` block; ``cancel`` is the event that ends it.

        Raises
        ------
        Refusal
            NOT_ACTIVE, when no searches are admitted.

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
        """Raise Refusal (NOT_ACTIVE) when no searches are admitted."""
        if not self._enabled:
            raise Refusal(Outcome.NOT_ACTIVE, WHY_DISABLED)

    def __len__(self) -> int:
        """Return how many searches are running."""
        return len(self._events)

    def cancel(self) -> int:
        """Set the events of all running searches and return how many there are."""
        with self._lock:
            for event in self._events:
                event.set()
            return len(self._events)

    def enable(self) -> None:
        """Admit searches."""
        with self._lock:
            self._enabled = True

    def disable(self) -> None:
        """Admit no more searches, and cancel those that run."""
        with self._lock:
            self._enabled = False
        self.cancel()
