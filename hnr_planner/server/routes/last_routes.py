"""Memory of the last routes: the paths of the latest requests, each found again by its goal."""

from collections import deque
from dataclasses import dataclass
import math
import threading

from hnr_planner.server.requests.plan_request import PlanRequest
from hnr_planner.server.routes.route_class import Landmarks
import numpy as np
from numpy.typing import NDArray

Path = NDArray[np.float64]

#: Most routes that are remembered.
MOST_ROUTES = 32

#: A route replaces another to the same goal whose start was within this distance [m].
SAME_START = 1.0

#: A robot within this distance [m] of a route is on it.
ON_ROUTE = 0.1


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
        return min(
            routes, key=lambda route: max(distance_from(route.path, start), ON_ROUTE), default=None
        )


def next_vertex(path: Path, point: Path) -> int:
    """Return the index of the end of the segment of a path (m, 2) that is nearest to a point."""
    away = _distances(path, point)
    # Of segments that are as near as each other, the last: what lies before has been passed.
    return len(away) - int(np.argmin(away[::-1]))


def distance_from(path: Path, point: Path) -> float:
    """Return the distance [m] of a path (m, 2) from a point (2,)."""
    return float(_distances(path, point).min())


def _distances(path: Path, point: Path) -> NDArray[np.float64]:
    """Return the distances (m - 1,) [m] of the segments of a path (m, 2) from a point (2,)."""
    begins, steps = path[:-1], np.diff(path, axis=0)
    squares = np.maximum((steps**2).sum(axis=1), np.finfo(np.float64).tiny)
    along = np.clip(((point - begins) * steps).sum(axis=1) / squares, 0.0, 1.0)
    return np.hypot(*(begins + along[:, np.newaxis] * steps - point).T)
