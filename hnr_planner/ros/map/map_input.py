"""Maps on their way from the topic into use, with a line on the log for each."""

from collections.abc import Callable
import time

from hnr_planner.maps import OccupancyMap
from hnr_planner.ros.map.subscription import MapSubscription
from hnr_planner.ros.map.updates import MapUpdates
from hnr_planner.ros.messages.maps import map_from_message, map_with_update
from hnr_planner.server.map_advice import MapAdvice
from hnr_planner.server.map_store import MapSnapshot, MapStore
from hnr_planner.server.received_maps import MapError
from hnr_planner.server.settings import Settings
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.node import Node


class MapInput:
    """
    Subscribes to maps from when it is made until ``close``; ``newest`` is the last good one.

    Parameters
    ----------
    node : Node
        Subscribes, and has the log.
    settings : callable
        Returns the parameters in force.
    on_change : callable
        Called when another map is in use.

    """

    def __init__(
        self, node: Node, settings: Callable[[], Settings], on_change: Callable[[], None]
    ) -> None:
        self._logger = node.get_logger()
        self._settings = settings
        self._on_change = on_change
        self._store = MapStore(settings())
        self._advice = MapAdvice()
        self._received_at = time.monotonic()
        # Maps and their updates in the order in which they come.
        group = MutuallyExclusiveCallbackGroup()
        self._subscription = MapSubscription(
            node,
            lambda message: self._receive(lambda: map_from_message(message)),
            settings().map_subscribe_transient_local,
            group,
        )
        self._updates = MapUpdates(
            node,
            f'{self.topic}_updates',
            lambda message: self._receive(lambda: map_with_update(self._store.occupancy, message)),
            group,
        )

    @property
    def topic(self) -> str:
        """Return the full name of the topic."""
        return self._subscription.topic

    @property
    def age(self) -> float:
        """Return the time since the last good map came [s]."""
        return time.monotonic() - self._received_at

    def newest(self) -> MapSnapshot:
        """Return the map in use, or raise Refusal (NO_MAP, MAP_NOT_READY)."""
        return self._store.newest()

    def use(self, settings: Settings) -> None:
        """Put changed parameters into use."""
        began, before = time.monotonic(), self._store.snapshot
        try:
            snapshot = self._store.use(settings)
        except MapError as error:
            self._logger.error(str(error))
            return
        if snapshot is not None:
            self._log('prepared again for changed parameters', snapshot, before, began)

    def close(self) -> None:
        """Subscribe no more."""
        self._subscription.close()
        self._updates.close()

    def _receive(self, read_map: Callable[[], OccupancyMap]) -> None:
        """Put a new map into use; a bad one is refused and the last good one stays."""
        began, before = time.monotonic(), self._store.snapshot
        try:
            snapshot = self._store.receive(read_map)
        except MapError as error:
            rest = 'no map is in use' if before is None else 'the last good map stays in use'
            self._logger.error(f'map refused, {rest}: {error}')
            return
        self._received_at = began
        if snapshot is not before:
            self._log('received and prepared', snapshot, before, began)

    def _log(
        self, done: str, snapshot: MapSnapshot, before: MapSnapshot | None, began: float
    ) -> None:
        """Log another map: at DEBUG where it differs from the last in its cells only."""
        taken = time.monotonic() - began
        text = f'map {done} in {taken:.3f} s: {snapshot.occupancy}'
        if before is None or str(before.occupancy) != str(snapshot.occupancy):
            self._logger.info(text)
        else:
            self._logger.debug(text)
        for warning in self._advice.warnings(snapshot.occupancy, self._settings()):
            self._logger.warning(warning)
        self._on_change()
