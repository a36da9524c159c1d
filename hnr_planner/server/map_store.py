"""
The map in use: the last good one that arrived, prepared as a space.

Maps and changed parameters come from one thread at a time, requests from many. A request takes
a `MapSnapshot`, which never changes, and so a new map cannot disturb a search.
"""

from collections.abc import Callable
from dataclasses import dataclass
import threading

from hnr_planner.core import GridSpace, HnrError
from hnr_planner.server.outcomes import Outcome, Refusal
from hnr_planner.server.settings import Settings
import numpy as np
from numpy.typing import NDArray


class MapError(HnrError, ValueError):
    """A map cannot be used: the message says why, and the last good map stays."""


@dataclass(frozen=True)
class Grid:
    """
    An occupancy map as it was published.

    Parameters
    ----------
    data : (rows, cols) int8
        -1 unknown, 0 free .. 100 occupied; row 0 lies at the origin.
    resolution : float
        Side of a cell [m].
    origin : (x, y, yaw)
        Pose of the corner of cell [0, 0] in the map frame [m, m, rad].
    frame : str
        Name of the map frame.

    """

    data: NDArray[np.int8]
    resolution: float
    origin: tuple[float, float, float]
    frame: str

    def is_same_as(self, other: 'Grid | None') -> bool:
        """Return whether another map says the same of every place."""
        return (
            other is not None
            and (self.resolution, self.origin, self.frame)
            == (other.resolution, other.origin, other.frame)
            and np.array_equal(self.data, other.data)
        )

    def __str__(self) -> str:
        """Return size, resolution and frame in words."""
        rows, cols = self.data.shape
        return f"{cols} x {rows} cells of {self.resolution:g} m in frame '{self.frame}'"


@dataclass(frozen=True)
class MapSnapshot:
    """A map ready for planning; `number` counts the preparations."""

    space: GridSpace
    grid: Grid
    number: int

    @property
    def frame(self) -> str:
        """Return the name of the map frame."""
        return self.grid.frame


class MapStore:
    """Holds the newest good map as a space for the settings that are in force."""

    def __init__(self, settings: Settings) -> None:
        self._arguments = settings.space_arguments
        self._grid: Grid | None = None
        self._snapshot: MapSnapshot | None = None
        self._missing = (Outcome.NO_MAP, 'no map has arrived yet')
        self._prepared = 0
        self._one_at_a_time = threading.Lock()

    def receive(self, read_grid: Callable[[], Grid]) -> MapSnapshot:
        """
        Put the map that `read_grid` returns to use and return it as a space.

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
                grid = read_grid()
                if self._snapshot is not None and grid.is_same_as(self._grid):
                    return self._snapshot
                self._snapshot = self._prepare(grid)
                self._grid = grid
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
        Prepare the map again if `settings` ask for another space; return it if they do.

        Raises
        ------
        MapError
            When that fails; then no map is in use.

        """
        with self._one_at_a_time:
            if settings.space_arguments == self._arguments:
                return None
            self._arguments = settings.space_arguments
            if self._grid is None:
                return None
            # The space of the former settings would let the robot through where it does not fit.
            self._missing = (
                Outcome.MAP_NOT_READY,
                'the map is just being prepared for changed parameters',
            )
            self._snapshot = None
            try:
                self._snapshot = self._prepare(self._grid)
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
    def grid(self) -> Grid | None:
        """Return the last good map, if there was one."""
        return self._grid

    def newest(self) -> MapSnapshot:
        """Return the map in use, or raise Refusal (NO_MAP, MAP_NOT_READY)."""
        snapshot = self._snapshot
        if snapshot is None:
            raise Refusal(*self._missing)
        return snapshot

    def _prepare(self, grid: Grid) -> MapSnapshot:
        space = GridSpace.from_occupancy(
            grid.data, grid.resolution, grid.origin, **self._arguments
        )
        self._prepared += 1
        return MapSnapshot(space, grid, self._prepared)


def _in_words(error: Exception) -> str:
    """Return what is wrong with a map, or what failed while it was prepared."""
    if isinstance(error, HnrError):
        return str(error)
    return f'preparing the map failed: {type(error).__name__}: {" ".join(str(error).split())}'
