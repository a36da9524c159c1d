"""Long work in parts, between which a cancellation is looked at."""

from collections.abc import Iterator

from hnr_planner.core.errors import Cancelled
from hnr_planner.core.planning.limits import Event

#: Rows that are handled between two looks at a cancellation.
ROWS = 64


def in_parts(n_rows: int, cancel: Event | None) -> Iterator[slice]:
    """Yield slices of so many rows, and look at the cancellation before each."""
    for first in range(0, n_rows, ROWS):
        if cancel is not None and cancel.is_set():
            raise Cancelled('the roadmap was cancelled before it was ready')
        yield slice(first, min(first + ROWS, n_rows))
