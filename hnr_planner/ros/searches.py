"""The searches that are running, so that all of them can be told to end."""

from collections.abc import Iterator
from contextlib import contextmanager
import threading


class RunningSearches:
    """A register of running searches; each one watches its own event."""

    def __init__(self) -> None:
        self._events: set[threading.Event] = set()
        self._lock = threading.Lock()
        self._closed = False

    @contextmanager
    def one(self) -> Iterator[threading.Event]:
        """Register a search for the length of a `with` block; its event tells it to end."""
        event = threading.Event()
        with self._lock:
            self._events.add(event)
            if self._closed:
                event.set()
        try:
            yield event
        finally:
            with self._lock:
                self._events.discard(event)

    def __len__(self) -> int:
        """Return how many are running."""
        return len(self._events)

    def cancel(self) -> int:
        """Tell all running searches to end and return how many were told."""
        with self._lock:
            for event in self._events:
                event.set()
            return len(self._events)

    def close(self) -> None:
        """Tell all running searches to end, and every later one at its start."""
        with self._lock:
            self._closed = True
        self.cancel()
