"""
Roadmaps of the maps in use, built in the background for requests that come later.

A thread of low priority builds a roadmap for the first map, and repairs it for each newer one. A
request never waits for that: it takes the roadmap of its own map, or does without.
"""

from collections.abc import Callable, Iterable
import dataclasses
import os
import threading
import time
import traceback

from hnr_planner.core import Roadmap
from hnr_planner.core.errors import Cancelled
from hnr_planner.core.spaces.space import Space
from hnr_planner.server.map.map_store import MapSnapshot
import numpy as np

#: Niceness of the thread, so that requests go first.
NICENESS = 10
#: Seed of all roadmaps: equal maps have equal roadmaps.
SEED = 0


@dataclasses.dataclass(frozen=True)
class RoadmapState:
    """
    The state of the roadmap at one moment.

    Attributes
    ----------
    state : str
        'off', 'building' (also while it is repaired for a newer map), or 'ready'.
    build_time, update_time : float
        Time [s] that the last build from nothing and the last repair took; NaN before the first.
    n_bytes : int
        Memory of the arrays of the roadmap, without its map.

    """

    state: str
    build_time: float
    update_time: float
    n_bytes: int


class Roadmaps:
    """
    Keeps the roadmap of the newest map, from ``follow`` on; any thread may ask for it.

    ``report_defect`` is called with the traceback, as text, where a roadmap cannot be made.
    """

    def __init__(self, report_defect: Callable[[str], None]) -> None:
        self._report_defect = report_defect
        self._changed = threading.Condition()
        self._wanted: Space | None = None
        self._tried: Space | None = None
        self._roadmap: Roadmap | None = None
        self._cancel = threading.Event()
        self._thread: threading.Thread | None = None
        self._times = {'build': float('nan'), 'update': float('nan')}

    def follow(self, snapshot: MapSnapshot) -> None:
        """Build or repair the roadmap for a map; what is under way is finished before that."""
        with self._changed:
            self._wanted = snapshot.space
            self._cancel.clear()
            if self._thread is None:
                self._thread = threading.Thread(target=self._work, name='roadmap', daemon=True)
                self._thread.start()
            self._changed.notify()

    def forget(self) -> None:
        """Cancel what is under way, and drop the roadmap."""
        with self._changed:
            self._wanted = self._tried = self._roadmap = None
            self._cancel.set()
            self._changed.notify()
            thread, self._thread = self._thread, None
        if thread is not None:
            thread.join()

    def of(self, snapshot: MapSnapshot) -> Roadmap | None:
        """Return the roadmap of a map; None where there is none for this very map."""
        roadmap = self._roadmap
        return roadmap if roadmap is not None and roadmap.space is snapshot.space else None

    @property
    def state(self) -> RoadmapState:
        """The state of the roadmap."""
        with self._changed:
            wanted, roadmap = self._wanted, self._roadmap
        if wanted is None:
            state = 'off'
        elif roadmap is not None and roadmap.space is wanted:
            state = 'ready'
        else:
            state = 'building'
        return RoadmapState(
            state, self._times['build'], self._times['update'], _n_bytes(vars(roadmap or self))
        )

    def _work(self) -> None:
        """Make the roadmap of each map that is wanted, until none is."""
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), NICENESS)
        while (space := self._next()) is not None:
            try:
                self._make(space)
            except Cancelled:
                return
            except Exception:  # a roadmap must never take the node down
                self._report_defect(traceback.format_exc())

    def _next(self) -> Space | None:
        """Wait for a map without a roadmap and return its space; None at the end."""
        with self._changed:
            while self._wanted is not None and self._tried is self._wanted:
                self._changed.wait()
            self._tried = self._wanted
            return self._wanted

    def _make(self, space: Space) -> None:
        began, before = time.monotonic(), self._roadmap
        if before is None:
            made = Roadmap.build(space, seed=SEED, cancel=self._cancel)
        else:
            made = before.update(space, cancel=self._cancel)
        self._times['build' if before is None else 'update'] = time.monotonic() - began
        with self._changed:
            if not self._cancel.is_set():
                self._roadmap = made


def _n_bytes(value: object) -> int:
    """Return the memory [bytes] of all arrays in a value of nested data, spaces aside."""
    if isinstance(value, np.ndarray):
        return value.nbytes
    if isinstance(value, dict):
        return _sum(value.values())
    if isinstance(value, tuple):
        return _sum(value)
    if dataclasses.is_dataclass(value):
        return _sum(vars(value).values())
    return 0


def _sum(values: Iterable[object]) -> int:
    return sum(_n_bytes(value) for value in values)
