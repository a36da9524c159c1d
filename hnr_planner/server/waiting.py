"""Waiting for the first map: a request that comes before it is not refused at once."""

from collections.abc import Callable
import threading
import time

from hnr_planner.server.map_store import MapSnapshot
from hnr_planner.server.outcomes import Outcome, Refusal

NewestMap = Callable[[], MapSnapshot]

#: Seconds between looks for a map; a cancellation ends the wait at once.
LOOK_EVERY = 0.01


def wait_for_map(newest_map: NewestMap, patience: float, cancel: threading.Event) -> MapSnapshot:
    """
    Return the map in use, as soon as there is one.

    Parameters
    ----------
    newest_map : callable
        Returns the map in use, or raises Refusal.
    patience : float
        Longest wait [s].
    cancel : threading.Event
        Ends the wait when it is set.

    Raises
    ------
    Refusal
        NO_MAP or MAP_NOT_READY when none came in time; CANCELLED; whatever else ``newest_map``
        refuses for.

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
