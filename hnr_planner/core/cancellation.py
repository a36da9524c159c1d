"""Chunks of rows for long work, which a cancellation can end between two chunks."""

from collections.abc import Iterator
from typing import Protocol

from hnr_planner.core.errors import Cancelled

#: Rows handled between two checks for cancellation.
ROWS = 64


class Event(Protocol):
    """An event that another thread can set, such as ``threading.Event``."""

    def is_set(self) -> bool:
        """Return whether the event was set."""


def in_chunks(n_rows: int, cancel: Event | None, rows: int = ROWS) -> Iterator[slice]:
    """
    Yield consecutive slices of ``rows`` rows, the last one shorter, that cover ``n_rows`` rows.

    Before each slice, raise Cancelled if the event ``cancel`` was set; None is never set.
    """
    for first in range(0, n_rows, rows):
        if cancel is not None and cancel.is_set():
            raise Cancelled('the work was cancelled before it was done')
        yield slice(first, min(first + rows, n_rows))
