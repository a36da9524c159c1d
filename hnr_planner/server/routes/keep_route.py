"""
The parameter ``keep_route``: the last path to a goal is kept unless a new one is much shorter.

Small changes of the map may make a path on another side of an obstacle the shortest, and the next
change that of the first side again. A robot that follows each new path turns back and forth. Here
the rest of the last path is mended, where the robot and the map have moved, and compared with the
new path.
"""

from dataclasses import dataclass, replace

from hnr_planner.core import GridSpace, PlannerStatus, PlanResult
from hnr_planner.core.kernels.streams import Stream, stream
from hnr_planner.core.lengths import path_length
from hnr_planner.core.planning.homology import Islands
from hnr_planner.core.planning.limits import Budget
from hnr_planner.core.planning.postprocessing.clearance import increase_clearance
from hnr_planner.core.planning.postprocessing.simplify import shorten
from hnr_planner.server.parameters.settings import Settings
from hnr_planner.server.requests.limits import RequestLimits
from hnr_planner.server.routes.last_routes import next_vertex, Route
from hnr_planner.server.routes.route_class import detour, route_class
import numpy as np
from numpy.typing import NDArray

Path = NDArray[np.float64]


def keep_route(
    result: PlanResult,
    last: Route | None,
    space: GridSpace,
    settings: Settings,
    limits: RequestLimits,
) -> tuple[PlanResult, str]:
    """
    Return the result to send, and where its path comes from: 'kept', 'mended' or 'new'.

    It is ``result``, and the origin is empty, where ``settings`` keep no route or nothing was
    found. A route is kept only where both paths have the ends that were requested.

    Parameters
    ----------
    result : PlanResult
        Result of a search that knew nothing of the last path.
    last : Route, optional
        The last route to the same goal; None where there is none.
    space : GridSpace
        Where the path has to be free.
    settings, limits
        The parameters in force, and the limits of the request.

    """
    if settings.keep_route == 0.0 or result.status is not PlannerStatus.SOLVED:
        return result, ''
    exact = result.escape == result.goal_offset == settings.goal_radius == 0.0
    if last is None or not exact or not np.array_equal(last.path[-1], result.path[-1]):
        return result, 'new'

    def choose() -> tuple[PlanResult, str]:
        islands = last.landmarks.on(space)
        choice = _Choice(space, islands, settings, limits, stream(result.seed))
        return choice.between(result, last.path)

    kept = limits.within(choose, None)
    return (result, 'new') if kept is None else kept


@dataclass(frozen=True)
class _Choice:
    """
    The choice between the last path to a goal and a new one.

    Attributes
    ----------
    space : GridSpace
        Where the path has to be free.
    islands : Islands
        The large obstacles that tell the classes of paths.
    settings, limits
        The parameters in force, and the limits of the request.
    rng : Stream
        Random stream by which a mended path is shortened.

    """

    space: GridSpace
    islands: Islands
    settings: Settings
    limits: RequestLimits
    rng: Stream

    def between(self, result: PlanResult, last: Path) -> tuple[PlanResult, str]:
        """
        Return the result to send, and 'kept', 'mended' or 'new': where its path comes from.

        The new path is taken where it is shorter than the last one, mended, by more than the
        fraction ``keep_route`` of that one's length.

        Parameters
        ----------
        result : PlanResult
            Result of the search for a new path; solved.
        last : (m, 2)
            The last path to the same goal [m], maybe on an older map and from another start.

        """
        rest, how = rest_of(last, result.path[0]), 'kept'
        if not self.space.is_path_free(rest):
            if self._class_of(rest) == self._class_of(result.path):
                why = 'around what blocks it, the new one passes walls on the same sides'
                return _with_route(result, 'mended', why), 'mended'
            around, how = self._detour(rest), 'mended'
            if around is None:
                why = 'nothing free is left of it between the same walls'
                return _with_route(result, 'new', why), 'new'
            rest = around
        path = self._shortened(rest)
        length = path_length(path)
        if result.length < (1.0 - self.settings.keep_route) * length:
            gain = 100.0 * (1.0 - result.length / length)
            why = f'it is shorter than the last one by {gain:.2g} %'
            return _with_route(result, 'new', why), 'new'
        longer = 100.0 * (length / result.length - 1.0) if result.length > 0.0 else 0.0
        why = f'it is longer than a new one by {longer:.2g} %'
        return _with_route(replace(result, path=path, length=length), how, why), how

    @property
    def _budget(self) -> Budget:
        return Budget(self.limits.deadline, cancel=self.limits.cancel)

    def _class_of(self, path: Path) -> int:
        """Return a number for the class of a path (m, 2) [m]."""
        return route_class(self.space, self.islands, path)

    def _detour(self, path: Path) -> Path | None:
        """Return a free path (k, 2) [m] around what blocks one (m, 2), of its class; else None."""
        space, islands, limits = self.space, self.islands, self.limits
        way = detour(space, islands, path, limits.time_left, limits.cancel)
        if way is not None and self.settings.clearance > 0.0:
            way = increase_clearance(space, way, self.settings.clearance, self._budget, islands)
        return way

    def _shortened(self, path: Path) -> Path:
        """Return a path (k, 2) [m] of the class of one (m, 2), shortened as parameters allow."""
        # Shortening would take away the clearance that the path has.
        if not self.settings.simplify or self.settings.clearance > 0.0:
            return path
        return shorten(self.space, path, self.rng, self._budget, islands=self.islands)


def rest_of(path: Path, start: Path) -> Path:
    """Return the rest (k, 2) of a path (m, 2) for a robot that has come to ``start`` (2,)."""
    first = next_vertex(path, start)
    return np.vstack([start, path[first:]])


def _with_route(result: PlanResult, how: str, why: str) -> PlanResult:
    """Return the result with where its path comes from, and why, at the end of its message."""
    return replace(result, message=f'{result.message}; the route is {how}: {why}')
