"""
The class of a route: on which side it passes walls, rooms and other large obstacles.

Two routes with the same ends are of one class when the loop that both make winds around no large
obstacle. Large is what a driver would name for a direction, as in "left of the shelf": an island
(an obstacle with free space all around it) at least ``LEAST_SIZE`` wide or high, inflation
included. A person or a chair is none: a route that swerves to its other side is the same.
"""

from itertools import pairwise
import math
import threading

from hnr_planner.core import GridSpace, plan, PlannerStatus
from hnr_planner.core.planning.homology import Islands, islands_at, signature
import numpy as np
from numpy.typing import NDArray

Path = NDArray[np.float64]

#: Least width or height [m] of a large obstacle.
LEAST_SIZE = 2.0

#: Most points of earlier maps that are remembered.
MOST_POINTS = 500

#: Distances [m] from a route within which a detour may pass what blocks it, tried in this order;
#: and how far [m] before and behind the block it may leave the route.
WIDTHS, REACH = (3.0, 1.2), 4.0


class Landmarks:
    """
    Points in the large islands of the maps so far; any thread may ask for them.

    A door that closes, or a person between two shelves, makes one island of two. So the points of
    earlier maps count too, as long as they are blocked.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._points = np.empty((0, 2))

    def on(self, space: GridSpace) -> Islands:
        """Return the islands of all points, which include those of the grid ``space``."""
        new = _island_points(space)
        with self._lock:
            before = self._points[~space.contains(self._points)]
            points = np.unique(np.vstack([before[:MOST_POINTS], new]), axis=0)
            self._points = points
        return islands_at(space.to_kernel(points))


def _island_points(space: GridSpace) -> NDArray[np.float64]:
    """Return one point (k, 2) [m] in each large island of a grid."""
    import cv2  # only here: it takes as long to load as all else

    blocked = np.ascontiguousarray(space.data.free_distance == 0).view(np.uint8)
    n_labels, labels, boxes, _ = cv2.connectedComponentsWithStats(
        blocked, connectivity=8, ltype=cv2.CV_32S
    )
    least, points = LEAST_SIZE / space.resolution, []
    for label in range(1, n_labels):
        left, top, width, height, _ = boxes[label].tolist()
        # The rim around the map is no island.
        if max(width, height) < least or (left, top) == (0, 0):
            continue
        # In the middle, where nobody who stands at an end of it is taken for the island itself.
        row, column = top + height // 2, left + width // 2
        if width > height:
            row = int(np.flatnonzero(labels[:, column] == label)[0])
        else:
            column = int(np.flatnonzero(labels[row] == label)[0])
        points.append((column + 0.5, row + 0.5))
    return space.from_kernel(np.array(points).reshape(-1, 2))


def route_class(space: GridSpace, islands: Islands, path: Path) -> int:
    """Return a number for the class of a path (m, 2) [m] that need not be free."""
    return int(signature(islands, space.to_kernel(path)))


def detour(
    space: GridSpace, islands: Islands, path: Path, time_limit: float, cancel: threading.Event
) -> Path | None:
    """
    Return a free path (k, 2) [m] that leaves a blocked one near the blocks only; else None.

    It is of the class of ``path`` (m, 2), whose ends are free. Near the blocks it is the shortest
    path within one of ``WIDTHS`` of ``path``, with free ends ``REACH`` before and behind them.
    """
    points, free = _sampled(space, path)
    blocked = np.flatnonzero(~free)
    if len(blocked) == 0 or blocked[0] == 0 or blocked[-1] == len(points) - 1:
        return None
    reach = round(REACH / space.resolution)
    first, last = max(blocked[0] - reach, 0), min(blocked[-1] + reach, len(points) - 1)
    after = last + 1
    for width in WIDTHS:
        tube = _tube(space, points[first:after], width)
        between = plan(
            tube,
            points[first],
            points[last],
            algorithm='polyanya',
            simplify=False,
            time_limit=time_limit,
            cancel=cancel,
        )
        if between.status is not PlannerStatus.SOLVED:
            continue
        way = np.vstack([path[0], points[1:first], between.path, points[after:-1], path[-1]])
        same = route_class(space, islands, way) == route_class(space, islands, path)
        if same and space.is_path_free(way):
            return way
    return None


def _sampled(space: GridSpace, path: Path) -> tuple[Path, NDArray[np.bool_]]:
    """
    Return points (n, 2) on a path, at most a cell apart, and whether each is free.

    All points inside a segment that is blocked between them count as blocked.
    """
    steps = np.diff(path, axis=0)
    pieces = 1 + (np.hypot(*steps.T) / space.resolution).astype(int)
    first = np.concatenate([[0], np.cumsum(pieces)])
    segment = np.repeat(np.arange(len(steps)), pieces)
    fraction = (np.arange(first[-1]) - first[segment]) / pieces[segment]
    points = np.vstack([path[segment] + fraction[:, np.newaxis] * steps[segment], path[-1:]])
    free = np.asarray(space.contains(points))
    for k, (begin, end) in enumerate(pairwise(first.tolist())):
        inside = slice(begin + 1, end)
        if free[inside].all() and not space.is_motion_valid(path[k], path[k + 1]):
            free[inside] = False
    return points, free


def _tube(space: GridSpace, points: Path, width: float) -> GridSpace:
    """Return the part of a grid within ``width`` [m] of a path through points (n, 2) [m]."""
    import cv2

    cells = space.to_cells(points)
    reach = math.ceil(width / space.resolution)
    low = np.maximum(np.floor(cells.min(axis=0)).astype(int) - reach, 0)
    high = np.minimum(np.ceil(cells.max(axis=0)).astype(int) + reach, space.shape[::-1])
    window = slice(low[1], high[1]), slice(low[0], high[0])
    near = np.zeros((high - low)[::-1], dtype=np.uint8)
    corners = np.floor(cells - low).astype(np.int32)
    cv2.polylines(near, [corners], False, 1, thickness=2 * reach)
    origin = space.from_kernel(low.astype(float) + space.frame.RIM)
    return GridSpace.from_blocked(
        space.blocked[window] | (near == 0), space.resolution, (*origin.tolist(), space.origin[2])
    )
