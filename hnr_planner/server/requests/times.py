"""The times that the phases of a request took."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hnr_planner.core.planning.result import SearchResult


@dataclass
class Times:
    """
    Times [s] that the phases of one request took so far, by ``time.monotonic``.

    Attributes
    ----------
    map_time : float
        Waiting for a map, transforming the poses, and checking the path on a newer map.
    search_time : float
        Searches, until each found its first path or ended without one.
    shortening_time : float
        What follows a first path: shortening, searches for a better one, alternatives.
    message_time : float
        The clearance and the poses of the path, the message, and sending it.

    """

    map_time: float = 0.0
    search_time: float = 0.0
    shortening_time: float = 0.0
    message_time: float = 0.0

    @contextmanager
    def phase(self, name: str) -> Iterator[None]:
        """Add the time of a ``with`` block to the phase ``name``, such as 'map'."""
        field, began = f'{name}_time', time.monotonic()
        try:
            yield
        finally:
            setattr(self, field, getattr(self, field) + time.monotonic() - began)

    def add_planning(self, result: SearchResult) -> None:
        """Add the times of a planner's result to ``search_time`` and ``shortening_time``."""
        first = result.first_solution
        search = result.elapsed if first is None else first.elapsed
        self.search_time += search
        self.shortening_time += result.elapsed - search
