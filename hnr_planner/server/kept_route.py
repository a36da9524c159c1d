"""
Keeping the route: the last path to a goal is taken again unless a new one is much shorter.

Small changes of the map may make a path on another side of an obstacle the shortest, and the next
change that of the first side again. A robot that follows each new path turns back and forth. Here
the rest of the last path is mended, where the robot and the map have moved, and compared with the
new path.
"""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
import math
import threading

from hnr_planner.core import GridSpace, PlanResult
from hnr_planner.core.lengths import path_length
from hnr_planner.server.requests import PlanRequest
from hnr_planner.server.route_class import Landmarks
import numpy as np
from numpy.typing import NDArray

Path = NDArray[np.float64]

#: Returns a free path (m, 2) of the class of the one that it is given.
Change = Callable[[Path], Path]

#: Returns such a path for one that is blocked, or None where it finds none.
Detour = Callable[[Path], Path | None]

#: Returns a number for the class of a path (m, 2).
ClassOf = Callable[[Path], int]


#: Most routes that are remembered.
MOST_ROUTES = 32

#: A route replaces another to the same goal whose start was within this distance [m], and a robot
#: within this one [m] of a route is on it.
SAME_START, OFF = 1.0, 0.1


@dataclass(frozen=True)
class Route:
    """The path (m, 2) [m] of a request, that request, and the landmarks of all routes."""

    request: PlanRequest
    path: Path
    landmarks: Landmarks

    def serves(self, request: PlanRequest) -> bool:
        """Return whether a request is for the same goal, by the same algorithm."""
        mine = self.request
        return (mine.goal.point, mine.algorithm) == (request.goal.point, request.algorithm)


class LastRoutes:
    """
    The routes of the latest requests that were solved; any thread may ask for them.

    Several robots may ask in turns, for the same goal too: each gets the route that it is on.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._routes: deque[Route] = deque(maxlen=MOST_ROUTES)
        self._landmarks = Landmarks()

    def remember(self, request: PlanRequest, path: Path) -> None:
        """Take the path (m, 2) [m] of a request for the latest route to its goal from there."""
        with self._lock:
            others = [
                route
                for route in self._routes
                if not route.serves(request)
                or math.dist(route.request.start.point, request.start.point) > SAME_START
            ]
            self._routes.clear()
            self._routes.extend([Route(request, path, self._landmarks), *others])

    def forget(self) -> None:
        """Forget all routes, and the landmarks."""
        with self._lock:
            self._routes.clear()
            self._landmarks = Landmarks()

    def of(self, request: PlanRequest) -> Route | None:
        """Return the route to the goal of a request that passes its start, or the nearest one."""
        start = np.array(request.start.point)
        with self._lock:
            routes = [route for route in self._routes if route.serves(request)]
        # The newest of those that pass the start.
        return min(routes, key=lambda route: max(_away(route.path, start), OFF), default=None)


def with_kept_route(
    result: PlanResult,
    last: Path,
    space: GridSpace,
    ratio: float,
    class_of: ClassOf,
    detour: Detour,
    shorten: Change,
) -> tuple[PlanResult, str]:
    """
    Return the result to send, and 'kept', 'mended' or 'new': where its path comes from.

    Parameters
    ----------
    result : PlanResult
        Result of a search that knew nothing of the last path; solved.
    last : (m, 2)
        The last path to the same goal [m], maybe on an older map and from another start.
    space : GridSpace
        Where the path has to be free.
    ratio : float
        The path of ``result`` is taken where it is shorter than the last one, mended, by more
        than this fraction of that one's length.
    class_of, detour, shorten : callable
        What tells the classes of paths, mends the last path where it is blocked, and shortens it
        after that.

    """
    rest = rest_of(last, result.path[0])
    if space.is_path_free(rest):
        path, how = rest, 'kept'
    elif class_of(rest) == class_of(result.path):
        why = 'around what blocks it, the new one passes walls on the same sides'
        return _told(result, 'mended', why), 'mended'
    else:
        around, how = detour(rest), 'mended'
        if around is None:
            return _told(result, 'new', 'nothing free is left of it between the same walls'), 'new'
        path = around
    path = shorten(path)
    length = path_length(path)
    if result.length < (1.0 - ratio) * length:
        gain = 100.0 * (1.0 - result.length / length)
        return _told(result, 'new', f'it is shorter than the last one by {gain:.2g} %'), 'new'
    longer = 100.0 * (length / result.length - 1.0) if result.length > 0.0 else 0.0
    why = f'it is longer than a new one by {longer:.2g} %'
    return _told(replace(result, path=path, length=length), how, why), how


def rest_of(path: Path, start: Path) -> Path:
    """Return the rest (k, 2) of a path (m, 2) for a robot that has come to ``start`` (2,)."""
    first = next_vertex(path, start)
    return np.vstack([start, path[first:]])


def next_vertex(path: Path, point: Path) -> int:
    """Return the index of the end of the segment of a path (m, 2) that is nearest to a point."""
    away = _distances(path, point)
    # Of segments that are as near as each other, the last: what lies before has been passed.
    return len(away) - int(np.argmin(away[::-1]))


def _away(path: Path, point: Path) -> float:
    """Return the distance [m] of a path (m, 2) from a point (2,)."""
    return float(_distances(path, point).min())


def _distances(path: Path, point: Path) -> NDArray[np.float64]:
    """Return the distances (m - 1,) [m] of the segments of a path (m, 2) from a point (2,)."""
    begins, steps = path[:-1], np.diff(path, axis=0)
    squares = np.maximum((steps**2).sum(axis=1), np.finfo(np.float64).tiny)
    along = np.clip(((point - begins) * steps).sum(axis=1) / squares, 0.0, 1.0)
    return np.hypot(*(begins + along[:, np.newaxis] * steps - point).T)


def _told(result: PlanResult, how: str, why: str) -> PlanResult:
    return replace(result, message=f'{result.message}; the route is {how}: {why}')
