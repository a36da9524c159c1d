"""Waiting for the first map, so that a request that comes before a map is not refused at once."""

from collections.abc import Callable
import threading
import time

from hnr_planner.server.map.map_store import MapSnapshot
from hnr_planner.server.requests.outcomes import Outcome, Refusal

NewestMap = Callable[[], MapSnapshot]

#: Time [s] between two looks for a map; a cancellation does not wait for the next look.
LOOK_EVERY = 0.01


def wait_for_map(newest_map: NewestMap, patience: float, cancel: threading.Event) -> MapSnapshot:
    """
    Return the map in use, after waiting for it while there is none.

    Parameters
    ----------
    newest_map : callable
        Returns the map in use, or raises Refusal.
    patience : float
        Longest wait [s], by ``time.monotonic``; with 0 there is one look for a map.
    cancel : threading.Event
        Ends the wait when it is set.

    Raises
    ------
    Refusal
        NO_MAP or MAP_NOT_READY when no map came in time; CANCELLED when ``cancel`` was set during
        the wait; any other refusal of ``newest_map``, at once.

    """
    deadline = time.monotonic() + patience
    while True:
        try:
            return newest_map()
        except Refusal as refusal:
            awaited = refusal.outcome in (Outcome.NO_MAP, Outcome.MAP_NOT_READY)
            left = deadline - time.monotonic()
            if not awaited or left <= 0.0:
                raise
        if cancel.wait(min(left, LOOK_EVERY)):
            raise Refusal(Outcome.CANCELLED, 'the request was cancelled before there was a map')
