"""
The messages that all viewers of the page are to see, and those that each has not got yet.

Messages of one kind share a slot: a newer message takes the place of the one before it.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable

#: Most pages that are open at once.
MOST_VIEWERS = 32


class Viewer:
    """
    The messages that wait for one page: of each slot of the hub the newest.

    So a page that reads slowly misses messages, and holds nobody up.
    """

    def __init__(self) -> None:
        self._waiting: dict[str, bytes] = {}
        self._is_waiting = asyncio.Event()

    def put(self, slot: str, message: bytes) -> None:
        """Let a message wait for the page, in the place of the last one of its slot."""
        self._waiting.pop(slot, None)  # the order is that in which the messages came
        self._waiting[slot] = message
        self._is_waiting.set()

    async def get(self) -> bytes:
        """Return the message that has waited longest; wait for one where there is none."""
        while not self._waiting:
            self._is_waiting.clear()
            await self._is_waiting.wait()
        return self._waiting.pop(next(iter(self._waiting)))


class Hub:
    """
    The last message of each slot, and the viewers that get it.

    It belongs to the thread of the event loop.

    Parameters
    ----------
    watch : callable
        Called with True when the first viewer comes, and with False when the last one has gone.

    """

    def __init__(self, watch: Callable[[bool], None]) -> None:
        self._watch = watch
        self._last: dict[str, bytes] = {}
        self._viewers: set[Viewer] = set()

    @property
    def is_full(self) -> bool:
        """Whether there are ``MOST_VIEWERS`` viewers."""
        return len(self._viewers) >= MOST_VIEWERS

    def put(self, slot: str, message: bytes) -> None:
        """Send a message to all viewers, and to those that come later until there is another."""
        self._last.pop(slot, None)
        self._last[slot] = message
        for viewer in self._viewers:
            viewer.put(slot, message)

    def forget(self, *slots: str) -> None:
        """Forget the last messages of some slots."""
        for slot in slots:
            self._last.pop(slot, None)

    def enter(self, viewer: Viewer) -> None:
        """Add a viewer, for which all last messages wait at once."""
        for slot, message in self._last.items():
            viewer.put(slot, message)
        self._viewers.add(viewer)
        if len(self._viewers) == 1:
            self._watch(True)

    def leave(self, viewer: Viewer) -> None:
        """Remove a viewer."""
        self._viewers.remove(viewer)
        if not self._viewers:
            self._watch(False)
