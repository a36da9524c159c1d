"""Maps on their way from the topic into use, with a line on the log for each."""

import time

from hnr_planner.ros.map_messages import grid_from_message
from hnr_planner.ros.map_store import MapError, MapSnapshot, MapStore
from hnr_planner.ros.map_subscription import MapSubscription
from hnr_planner.ros.settings import Settings
from nav_msgs.msg import OccupancyGrid
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

    """

    def __init__(self, node: Node, settings: Settings) -> None:
        self._logger = node.get_logger()
        self._store = MapStore(settings)
        self._came = time.monotonic()
        self._subscription = MapSubscription(
            node, self._receive, settings.map_subscribe_transient_local
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
        began = time.monotonic()
        try:
            snapshot = self._store.use(settings)
        except MapError as error:
            self._logger.error(str(error))
            return
        if snapshot is not None:
            self._log('prepared again for changed parameters', snapshot, began)

    def close(self) -> None:
        """Listen no more."""
        self._subscription.close()

    def _receive(self, message: OccupancyGrid) -> None:
        """Put a new map to use; a bad one is refused and the last good one stays."""
        began = time.monotonic()
        try:
            snapshot = self._store.receive(lambda: grid_from_message(message))
        except MapError as error:
            rest = 'the last good map stays in use' if self._store.in_use else 'no map is in use'
            self._logger.error(f'map refused, {rest}: {error}')
            return
        self._came = began
        self._log('received and prepared', snapshot, began)

    def _log(self, done: str, snapshot: MapSnapshot, began: float) -> None:
        taken = time.monotonic() - began
        self._logger.info(f'map {done} in {taken:.3f} s: {snapshot.grid}')
