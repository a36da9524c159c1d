"""Maps on their way from the topic into use, with a line on the log for each."""

from collections.abc import Callable
import time

from hnr_planner.ros.map.subscription import MapSubscription
from hnr_planner.ros.map.updates import MapUpdates
from hnr_planner.ros.messages.maps import grid_from_message, updated
from hnr_planner.server.map_store import Grid, MapError, MapSnapshot, MapStore
from hnr_planner.server.settings import Settings
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.node import Node


class MapInput:
    """
    Listens to maps from when it is made until `close`; `newest` is the last good one.

    Parameters
    ----------
    node : Node
        Subscribes, and has the log.
    settings : Settings
        Decide how a map becomes a space.
    on_change : callable
        Called when another map is in use.

    """

    def __init__(self, node: Node, settings: Settings, on_change: Callable[[], None]) -> None:
        self._logger = node.get_logger()
        self._on_change = on_change
        self._store = MapStore(settings)
        self._came = time.monotonic()
        # Maps and their updates in the order in which they come.
        group = MutuallyExclusiveCallbackGroup()
        self._subscription = MapSubscription(
            node,
            lambda message: self._receive(lambda: grid_from_message(message)),
            settings.map_subscribe_transient_local,
            group,
        )
        self._updates = MapUpdates(
            node,
            f'{self.topic}_updates',
            lambda message: self._receive(lambda: updated(self._store.grid, message)),
            group,
        )

    @property
    def topic(self) -> str:
        """Return the full name of the topic."""
        return self._subscription.topic

    @property
    def age(self) -> float:
        """Return the time since the last good map came [s]."""
        return time.monotonic() - self._came

    def newest(self) -> MapSnapshot:
        """Return the map in use, or raise Refusal (NO_MAP, MAP_NOT_READY)."""
        return self._store.newest()

    def use(self, settings: Settings) -> None:
        """Put changed parameters to use."""
        began, before = time.monotonic(), self._store.snapshot
        try:
            snapshot = self._store.use(settings)
        except MapError as error:
            self._logger.error(str(error))
            return
        if snapshot is not None:
            self._tell('prepared again for changed parameters', snapshot, before, began)

    def close(self) -> None:
        """Listen no more."""
        self._subscription.close()
        self._updates.close()

    def _receive(self, read_grid: Callable[[], Grid]) -> None:
        """Put a new map to use; a bad one is refused and the last good one stays."""
        began, before = time.monotonic(), self._store.snapshot
        try:
            snapshot = self._store.receive(read_grid)
        except MapError as error:
            rest = 'no map is in use' if before is None else 'the last good map stays in use'
            self._logger.error(f'map refused, {rest}: {error}')
            return
        self._came = began
        if snapshot is not before:
            self._tell('received and prepared', snapshot, before, began)

    def _tell(
        self, done: str, snapshot: MapSnapshot, before: MapSnapshot | None, began: float
    ) -> None:
        """Tell of another map; one that differs from the last in its cells only, quietly."""
        taken = time.monotonic() - began
        text = f'map {done} in {taken:.3f} s: {snapshot.grid}'
        if before is None or str(before.grid) != str(snapshot.grid):
            self._logger.info(text)
        else:
            self._logger.debug(text)
        self._on_change()
