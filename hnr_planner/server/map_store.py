"""
The map in use: the last good one that arrived, prepared as a space.

Maps and changed parameters come from one thread at a time, requests from many. A request takes
a ``MapSnapshot``, which never changes, and so a new map cannot disturb a search.
"""

from collections.abc import Callable
from dataclasses import dataclass
import threading

from hnr_planner.core import GridSpace, HnrError
from hnr_planner.maps import OccupancyMap
from hnr_planner.server.outcomes import Outcome, Refusal
from hnr_planner.server.received_maps import MapError
from hnr_planner.server.settings import Settings


@dataclass(frozen=True)
class MapSnapshot:
    """A map ready for planning; ``number`` counts the preparations."""

    space: GridSpace
    occupancy: OccupancyMap
    number: int

    @property
    def frame(self) -> str:
        """Return the name of the map frame."""
        return self.occupancy.frame


class MapStore:
    """Holds the newest good map as a space for the settings that are in force."""

    def __init__(self, settings: Settings) -> None:
        self._arguments = settings.space_arguments
        self._occupancy: OccupancyMap | None = None
        self._snapshot: MapSnapshot | None = None
        self._missing = (Outcome.NO_MAP, 'no map has arrived yet')
        self._prepared = 0
        self._one_at_a_time = threading.Lock()

    def receive(self, read_map: Callable[[], OccupancyMap]) -> MapSnapshot:
        """
        Put the map that ``read_map`` returns into use and return it as a space.

        One that is the same as the map in use is not prepared again.

        Raises
        ------
        MapError
            When the map cannot be prepared, for whatever reason; what was in use stays in use.

        """
        with self._one_at_a_time:
            try:
                if self._snapshot is None:
                    self._missing = (Outcome.MAP_NOT_READY, 'a map is just being prepared')
                occupancy = read_map()
                if self._snapshot is not None and occupancy.is_same_as(self._occupancy):
                    return self._snapshot
                self._snapshot = self._prepare(occupancy)
                self._occupancy = occupancy
                return self._snapshot
            except Exception as error:  # a map must never take the node down
                why = _in_words(error)
                self._missing = (
                    Outcome.NO_MAP,
                    f'no good map has arrived yet; the last was refused: {why}',
                )
                raise MapError(why) from error

    def use(self, settings: Settings) -> MapSnapshot | None:
        """
        Prepare the map again if ``settings`` ask for another space; return it if they do.

        Raises
        ------
        MapError
            When that fails; then no map is in use.

        """
        with self._one_at_a_time:
            if settings.space_arguments == self._arguments:
                return None
            self._arguments = settings.space_arguments
            if self._occupancy is None:
                return None
            # The space of the former settings would let the robot through where it does not fit.
            self._missing = (
                Outcome.MAP_NOT_READY,
                'the map is just being prepared for changed parameters',
            )
            self._snapshot = None
            try:
                self._snapshot = self._prepare(self._occupancy)
            except Exception as error:  # a parameter must never take the node down
                why = f'parameters were changed, but {_in_words(error)}'
                self._missing = (Outcome.NO_MAP, why)
                raise MapError(why) from error
            return self._snapshot

    @property
    def snapshot(self) -> MapSnapshot | None:
        """Return the map in use, if there is one."""
        return self._snapshot

    @property
    def occupancy(self) -> OccupancyMap | None:
        """Return the last good map, if there was one."""
        return self._occupancy

    def newest(self) -> MapSnapshot:
        """Return the map in use, or raise Refusal (NO_MAP, MAP_NOT_READY)."""
        snapshot = self._snapshot
        if snapshot is None:
            raise Refusal(*self._missing)
        return snapshot

    def _prepare(self, occupancy: OccupancyMap) -> MapSnapshot:
        space = GridSpace.from_occupancy(
            occupancy.data, occupancy.resolution, occupancy.origin, **self._arguments
        )
        self._prepared += 1
        return MapSnapshot(space, occupancy, self._prepared)


def _in_words(error: Exception) -> str:
    """Return in words what is wrong with a map, or what failed in its preparation."""
    if isinstance(error, HnrError):
        return str(error)
    return f'preparing the map failed: {type(error).__name__}: {" ".join(str(error).split())}'
