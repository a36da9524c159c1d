"""
Keeping the route: the last path to a goal is taken again unless a new one is much shorter.

Small changes of the map may make a path on another side of an obstacle the shortest, and the next
change that of the first side again. A robot that follows each new path turns back and forth. Here
the rest of the last path is mended, where the robot and the map have moved, and compared with the
new path.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
import threading

from hnr_planner.core import GridSpace, PlanResult
from hnr_planner.core.lengths import path_length
from hnr_planner.server.requests import PlanRequest
import numpy as np
from numpy.typing import NDArray

Path = NDArray[np.float64]

#: Returns a free path (m, 2) from one point to another, or None.
Connect = Callable[[Path, Path], Path | None]

#: Returns a free path (m, 2) that is no longer than the one that it is given.
Shorten = Callable[[Path], Path]


@dataclass(frozen=True)
class Route:
    """The path (m, 2) [m] of the last request for a goal, and that request."""

    request: PlanRequest
    path: Path

    def serves(self, request: PlanRequest) -> bool:
        """Return whether a request is for the same goal, by the same algorithm."""
        mine = self.request
        return (mine.goal.point, mine.algorithm) == (request.goal.point, request.algorithm)


class LastRoute:
    """The route of the last request that was solved; any thread may ask for it."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._route: Route | None = None

    def remember(self, request: PlanRequest, path: Path) -> None:
        """Take the path (m, 2) [m] of a request for the last route."""
        with self._lock:
            self._route = Route(request, path)

    def forget(self) -> None:
        """Forget the last route."""
        with self._lock:
            self._route = None

    def of(self, request: PlanRequest) -> Path | None:
        """Return the last path to the goal of a request; None where that has changed."""
        with self._lock:
            route = self._route
        return route.path if route is not None and route.serves(request) else None


def with_kept_route(
    result: PlanResult,
    last: Path,
    space: GridSpace,
    ratio: float,
    connect: Connect,
    shorten: Shorten,
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
    connect, shorten : callable
        How the last path is mended where it is blocked, and shortened after that.

    """
    mended = mend(last, result.path[0], space, connect)
    if mended is None:
        return _told(result, 'new', 'the last one cannot be mended'), 'new'
    path, how = shorten(mended.path), mended.how
    length = path_length(path)
    if result.length < (1.0 - ratio) * length:
        gain = 100.0 * (1.0 - result.length / length)
        return _told(result, 'new', f'it is shorter than the last one by {gain:.2g} %'), 'new'
    longer = 100.0 * (length / result.length - 1.0) if result.length > 0.0 else 0.0
    why = f'it is longer than a new one by {longer:.2g} %'
    return _told(replace(result, path=path, length=length), how, why), how


@dataclass(frozen=True)
class Mended:
    """A path (m, 2) [m] made of a last one, and 'kept' or 'mended'."""

    path: Path
    how: str


def mend(last: Path, start: Path, space: GridSpace, connect: Connect) -> Mended | None:
    """
    Return the rest of a last path from a start (2,) on, free again; None where that fails.

    What lies between the vertices around all blocked segments is connected anew.
    """
    first = next_vertex(last, start)
    path = np.vstack([start, last[first:]])
    free = space.contains(path)
    segments = [
        bool(free[k] and free[k + 1] and space.is_motion_valid(path[k], path[k + 1]))
        for k in range(len(path) - 1)
    ]
    if all(segments):
        return Mended(path, 'kept')
    if not (free[0] and free[-1]):
        return None
    blocked = np.flatnonzero(~np.array(segments))
    before = int(np.flatnonzero(free[: blocked[0] + 1])[-1])
    behind = int(blocked[-1] + 1)
    after = behind + int(np.flatnonzero(free[behind:])[0])
    between = connect(path[before], path[after])
    if between is None:
        return None
    rest = after + 1
    return Mended(np.vstack([path[:before], between, path[rest:]]), 'mended')


def next_vertex(path: Path, point: Path) -> int:
    """Return the index of the end of the segment of a path (m, 2) that is nearest to a point."""
    begins, steps = path[:-1], np.diff(path, axis=0)
    squares = np.maximum((steps**2).sum(axis=1), np.finfo(np.float64).tiny)
    along = np.clip(((point - begins) * steps).sum(axis=1) / squares, 0.0, 1.0)
    away = np.hypot(*(begins + along[:, np.newaxis] * steps - point).T)
    # Of segments that are as near as each other, the last: what lies before has been passed.
    return len(away) - int(np.argmin(away[::-1]))


def _told(result: PlanResult, how: str, why: str) -> PlanResult:
    return replace(result, message=f'{result.message}; the route is {how}: {why}')
