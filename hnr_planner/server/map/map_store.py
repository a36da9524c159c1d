"""
The store of the map in use: the last good map that arrived, prepared as a ``GridSpace``.

New maps and changed parameters are handled one at a time, while many threads may take the map for
requests. A request takes a ``MapSnapshot``, which never changes: so no new map disturbs a search.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
import threading

from hnr_planner.core import GridSpace, HnrError, PoseSpace, SpaceError
from hnr_planner.maps import OccupancyMap
from hnr_planner.server.map.keepout import with_zones, zones_on
from hnr_planner.server.map.received_maps import MapError
from hnr_planner.server.parameters.arguments import pose_space_arguments, space_arguments
from hnr_planner.server.parameters.settings import Settings
from hnr_planner.server.requests.outcomes import Outcome, Refusal


@dataclass(frozen=True)
class MapSnapshot:
    """
    A map that is ready for planning.

    Parameters
    ----------
    space : GridSpace
        The space that was prepared from the map.
    occupancy : OccupancyMap
        The map as it was received.
    number : int
        Number of this preparation in its store, from 1: a higher one is newer.
    outside_zones : GridSpace, optional
        The space of the same map without its keepout zones; None where there are none.
    poses : PoseSpace or SpaceError, optional
        The poses of a robot with a footprint, or why there are none: it does not fit into the map,
        or its drive is none. None for a robot that is a circle.

    """

    space: GridSpace
    occupancy: OccupancyMap
    number: int
    outside_zones: GridSpace | None = field(default=None, kw_only=True)
    poses: PoseSpace | SpaceError | None = field(default=None, kw_only=True)

    @property
    def pose_space(self) -> PoseSpace | None:
        """
        The poses of a robot with a footprint; None for a robot that is a circle.

        Raise Refusal (BAD_REQUEST) where the parameters describe no robot that fits into the map.
        """
        if isinstance(self.poses, SpaceError):
            raise Refusal(Outcome.BAD_REQUEST, str(self.poses)) from self.poses
        return self.poses

    def is_in_zone(self, point: tuple[float, float]) -> bool:
        """Return whether only a keepout zone blocks a point [m]."""
        outside = self.outside_zones
        return outside is not None and bool(
            outside.contains(point) and not self.space.contains(point)
        )

    @property
    def frame(self) -> str:
        """Name of the map frame; it may be empty."""
        return self.occupancy.frame


class MapStore:
    """Holds the last good map, as a space prepared with the parameters in force."""

    def __init__(self, settings: Settings) -> None:
        self._arguments = space_arguments(settings)
        self._pose_arguments = pose_space_arguments(settings)
        self._occupancy: OccupancyMap | None = None
        self._snapshot: MapSnapshot | None = None
        self._missing = (Outcome.NO_MAP, 'no map has arrived yet')
        self._prepared = 0
        self._masks: dict[str, OccupancyMap] = {}
        self._one_at_a_time = threading.Lock()

    def receive(self, read_map: Callable[[], OccupancyMap]) -> MapSnapshot:
        """
        Put the map that ``read_map`` returns into use, and return it prepared as a space.

        A map with the same cells, place and frame as the map in use is not prepared again: the
        snapshot in use is returned.

        Raises
        ------
        MapError
            When the map cannot be read or prepared, for any reason; the snapshot that was in use,
            if there was one, stays in use.

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

    def receive_mask(
        self, source: str, read_map: Callable[[], OccupancyMap] | None
    ) -> MapSnapshot | None:
        """
        Put the keepout mask that ``read_map`` returns into use, in the place of its source's last.

        Return the map prepared with it; None where there is no map yet, or the mask is the same.
        Where ``read_map`` is None, the source has no mask any more.

        Raises
        ------
        MapError
            When the mask cannot be read or used; the last one of the source stays in use.

        """
        with self._one_at_a_time:
            before = dict(self._masks)
            try:
                if read_map is None:
                    self._masks.pop(source, None)
                else:
                    mask = read_map()
                    if mask.is_same_as(before.get(source)):
                        return None
                    self._masks[source] = mask
                if self._occupancy is None:
                    return None
                self._snapshot = self._prepare(self._occupancy)
                return self._snapshot
            except Exception as error:  # a mask must never take the node down
                self._masks = before
                raise MapError(_in_words(error)) from error

    def use(self, settings: Settings) -> MapSnapshot | None:
        """
        Prepare the last good map again if ``settings`` change a parameter of the space.

        Return the new snapshot; None when no such parameter has changed, or there is no map yet.
        During the preparation no map is in use.

        Raises
        ------
        MapError
            When the preparation fails; then no map is in use.

        """
        with self._one_at_a_time:
            arguments = space_arguments(settings), pose_space_arguments(settings)
            if arguments == (self._arguments, self._pose_arguments):
                return None
            self._arguments, self._pose_arguments = arguments
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
        """The map in use; None when there is none."""
        return self._snapshot

    @property
    def occupancy(self) -> OccupancyMap | None:
        """The last good map as it was received, in use or not; None before the first one."""
        return self._occupancy

    def newest(self) -> MapSnapshot:
        """
        Return the map in use.

        Without one, raise Refusal: MAP_NOT_READY during a preparation, else NO_MAP.
        """
        snapshot = self._snapshot
        if snapshot is None:
            raise Refusal(*self._missing)
        return snapshot

    def _prepare(self, occupancy: OccupancyMap) -> MapSnapshot:
        frame, arguments = (occupancy.resolution, occupancy.origin), self._arguments
        space, outside = GridSpace.from_occupancy(occupancy.data, *frame, **arguments), None
        threshold = arguments['occupied_threshold']
        zones = zones_on(occupancy, self._masks.values(), threshold)
        if zones is not None and zones.any():
            outside = space
            data = with_zones(occupancy.data, zones, arguments['unknown'], threshold)
            space = GridSpace.from_occupancy(data, *frame, **{**arguments, 'unknown': 'blocked'})
        self._prepared += 1
        return MapSnapshot(
            space, occupancy, self._prepared, outside_zones=outside, poses=self._poses_on(space)
        )

    def _poses_on(self, space: GridSpace) -> PoseSpace | SpaceError | None:
        """Return the poses of a robot with a footprint, or why it has none; None for a circle."""
        if self._pose_arguments is None:
            return None
        try:
            poses = PoseSpace(space, **self._pose_arguments)
        except SpaceError as error:  # another parameter may mend it: the map is good
            return error
        _ = poses.disc  # prepared now, so that the first request need not
        return poses


def _in_words(error: Exception) -> str:
    """Return why a map was refused; for errors other than HnrError with the type of the error."""
    if isinstance(error, HnrError):
        return str(error)
    return f'preparing the map failed: {type(error).__name__}: {" ".join(str(error).split())}'
