"""The input of maps: received maps and updates are checked, put into use and logged."""

from collections.abc import Callable
import time

from hnr_planner.maps import OccupancyMap
from hnr_planner.ros.map.keepout import KeepoutMasks
from hnr_planner.ros.map.subscription import MapSubscription
from hnr_planner.ros.map.updates import MapUpdates
from hnr_planner.ros.messages.maps import map_from_message, map_with_update
from hnr_planner.server.map.map_advice import MapAdvice
from hnr_planner.server.map.map_store import MapSnapshot, MapStore
from hnr_planner.server.map.received_maps import MapError
from hnr_planner.server.parameters.settings import Settings
from nav_msgs.msg import OccupancyGrid
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.node import Node


class MapInput:
    """
    Subscribes to maps from construction to ``close``; ``newest`` returns the map in use.

    Parameters
    ----------
    node : Node
        The node that subscribes and logs.
    settings : callable
        Returns the parameters in force.
    on_change : callable
        Called without arguments after another map, or another space of the map, is in use.

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
        # One group, so that maps and updates are handled one at a time.
        group = MutuallyExclusiveCallbackGroup()
        self._subscription = MapSubscription(
            node,
            lambda message: self._receive(lambda: map_from_message(message)),
            settings().map_subscribe_transient_local,
            group,
        )
        self._keepout = KeepoutMasks(node, self._receive_mask, group)
        self._updates = MapUpdates(
            node,
            f'{self.topic}_updates',
            lambda message: self._receive(lambda: map_with_update(self._store.occupancy, message)),
            group,
        )

    @property
    def topic(self) -> str:
        """Full name of the topic of maps."""
        return self._subscription.topic

    @property
    def age(self) -> float:
        """Time [s] since the last good map or update came; since construction before the first."""
        return time.monotonic() - self._received_at

    def newest(self) -> MapSnapshot:
        """Return the map in use, or raise Refusal (NO_MAP, MAP_NOT_READY) when there is none."""
        return self._store.newest()

    def use(self, settings: Settings) -> None:
        """Prepare the map again where changed parameters need it; a failure is logged."""
        began, before = time.monotonic(), self._store.snapshot
        try:
            snapshot = self._store.use(settings)
        except MapError as error:
            self._logger.error(str(error))
            return
        if snapshot is not None:
            self._log('prepared again for changed parameters', snapshot, before, began)

    def close(self) -> None:
        """End the subscriptions to maps and updates."""
        self._subscription.close()
        self._updates.close()
        self._keepout.close()

    def _receive(self, read_map: Callable[[], OccupancyMap]) -> None:
        """Put the map that ``read_map`` returns into use; log a bad map and keep the last one."""
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

    def _receive_mask(self, source: str, message: OccupancyGrid | None) -> None:
        """Put a keepout mask into use, or withdraw it; log a bad one and keep the last one."""
        began, before = time.monotonic(), self._store.snapshot
        try:
            snapshot = self._store.receive_mask(
                source, None if message is None else lambda: map_from_message(message)
            )
        except MapError as error:
            self._logger.error(f'keepout mask from {source} refused: {error}')
            return
        self._logger.info(
            f'keepout mask from {source} {"withdrawn" if message is None else "received"}'
        )
        if snapshot is not None:
            self._log('prepared again with keepout zones', snapshot, before, began)

    def _log(
        self, done: str, snapshot: MapSnapshot, before: MapSnapshot | None, began: float
    ) -> None:
        """
        Log that a map came into use, with warnings about it, and call ``on_change``.

        The line is at INFO for the first map, or where the description differs from that of the
        map ``before``; else at DEBUG. ``began`` is when work on the map began, by
        ``time.monotonic`` [s].
        """
        taken = time.monotonic() - began
        text = f'map {done} in {taken:.3f} s: {snapshot.occupancy}'
        if before is None or str(before.occupancy) != str(snapshot.occupancy):
            self._logger.info(text)
        else:
            self._logger.debug(text)
        for warning in self._advice.warnings(snapshot.occupancy, self._settings()):
            self._logger.warning(warning)
        self._on_change()
