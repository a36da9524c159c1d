"""The register of running searches, which are admitted only while the node is active."""

from collections.abc import Iterator
from contextlib import contextmanager
import threading

from hnr_planner.server.requests.outcomes import Outcome, Refusal

WHY_DISABLED = 'the node is not active: configure and activate it, or start it with autostart true'


class RunningSearches:
    """
    A register of running searches, each by the event that cancels it.

    It admits none until ``enable``. Any number of threads may use it at once.
    """

    def __init__(self) -> None:
        self._events: set[threading.Event] = set()
        self._lock = threading.Lock()
        self._enabled = False

    @contextmanager
    def one(self, cancel: threading.Event) -> Iterator[None]:
        """
        Register a search for the duration of a ``with`` block.

        Parameters
        ----------
        cancel : threading.Event
            The event that the search watches, to end once it is set.

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
        """Admit searches from now on."""
        with self._lock:
            self._enabled = True

    def disable(self) -> None:
        """Admit no searches from now on, and set the events of those that are running."""
        with self._lock:
            self._enabled = False
        self.cancel()
