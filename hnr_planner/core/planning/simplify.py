"""
Shorter paths by visibility: any two points of a path that see each other may be joined directly.

First the vertices: each is followed by the last one that it sees. Then points anywhere on the
path, drawn in pairs uniformly along its length. Every replacement is a straight line, so a path
never gets longer; the work is bounded by the number of visibility tests.
"""

import math
import time

from hnr_planner.core.checks import check_count, check_number, check_points, check_seed, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels import kernel
from hnr_planner.core.planning.limits import Limits
from hnr_planner.core.planning.result import path_length
from hnr_planner.core.spaces.primitives import sees
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import ArrayLike

#: Visibility tests for one path, and how many of them go by between two looks at the clock.
TESTS_MAX = 100_000
TESTS_IN_A_BATCH = 1000
#: Shortcuts tried for each vertex that the first pass has left.
SHORTCUTS_PER_VERTEX = 50


def simplify(
    space: Space,
    path: ArrayLike,
    *,
    seed: int | None = None,
    max_iterations: int = TESTS_MAX,
    time_limit: float | None = None,
) -> Floats:
    """
    Shorten a free path.

    Parameters
    ----------
    space : Space
        Where the path has to be free.
    path : (m, dim)
        At least two points, every segment free.
    seed : int, optional
        Fresh when left out.
    max_iterations : int
        Visibility tests at most.
    time_limit : float, optional
        Seconds after which the path is returned as it is by then.

    Returns
    -------
    (k, dim)
        A free path with the same ends, never longer.

    Raises
    ------
    RequestError
        When an argument is malformed or a segment of the path is not free.

    """
    path = check_path(space, path)
    max_iterations = check_count('max_iterations', max_iterations, 0)
    seconds = math.inf if time_limit is None else check_number('time_limit', time_limit, 0.0)
    limits = Limits(time.perf_counter() + seconds)
    rng = np.random.default_rng(check_seed(seed))
    return shorten(space, path, rng, limits, max_iterations)


def check_path(space: Space, path: ArrayLike) -> Floats:
    """Return ``path`` (m, dim) as a fresh array of free segments, or raise RequestError."""
    points = check_points('path', path, space.dim)
    if points.ndim != 2 or len(points) < 2:
        raise RequestError(f'path must have at least two points, got shape {points.shape}')
    for k in range(len(points) - 1):
        if not space.is_motion_valid(points[k], points[k + 1]):
            ends = f'{points[k].tolist()} to {points[k + 1].tolist()}'
            raise RequestError(f'path must be free, but segment {k} from {ends} is not')
    return points


def shorten(
    space: Space,
    path: Floats,
    rng: np.random.Generator,
    limits: Limits,
    tests_max: int = TESTS_MAX,
) -> Floats:
    """Shorten a free path (m, dim) of the caller's frame within limits; the same ends."""
    points = space.to_kernel(path)
    points, tests = _skip_vertices(space, points, limits, tests_max)
    tries = min(SHORTCUTS_PER_VERTEX * (len(points) - 1), tests_max - tests)
    while len(points) > 2 and tries > 0 and limits.stop() is None:
        batch = min(tries, TESTS_IN_A_BATCH)
        points = _shortcut(space.data, points, rng, batch)
        tries -= batch
    shorter = space.from_kernel(points)
    shorter[0], shorter[-1] = path[0], path[-1]
    return shorter if path_length(shorter) < path_length(path) else path


def _skip_vertices(
    space: Space, points: Floats, limits: Limits, tests_max: int
) -> tuple[Floats, int]:
    """Keep only vertices that follow each other as the last one seen; count the tests."""
    kept, last, candidate, tests = [0], len(points) - 1, len(points) - 1, 0
    while kept[-1] < last and tests < tests_max and limits.stop() is None:
        batch = min(TESTS_IN_A_BATCH, tests_max - tests)
        seen, candidate, used = _last_seen(space.data, points, kept[-1], candidate, batch)
        tests += used
        if seen:
            kept.append(candidate)
            candidate = last
    return points[kept + list(range(kept[-1] + 1, len(points)))], tests


@kernel
def _last_seen(space, points, k, candidate, tests_max):
    """Go back from ``candidate`` to a vertex that ``k`` sees: (found, candidate, tests)."""
    for tests in range(tests_max):
        if candidate == k + 1:
            return True, candidate, tests
        if sees(space, points[k], points[candidate]):
            return True, candidate, tests + 1
        candidate -= 1
    return False, candidate, tests_max


@kernel
def _shortcut(space, points, rng, tries):
    """Try to join random pairs of points of the path directly."""
    along = _lengths_along(points)
    for _ in range(tries):
        s, t = along[-1] * rng.random(), along[-1] * rng.random()
        if s > t:
            s, t = t, s
        i, j = _segment_at(along, s), _segment_at(along, t)
        if i == j:
            continue
        a = _point_on(points, along, i, s)
        b = _point_on(points, along, j, t)
        if sees(space, points[i], a) and sees(space, a, b) and sees(space, b, points[j + 1]):
            points = _joined(points, i, a, b, j + 1)
            along = _lengths_along(points)
    return points


@kernel
def _lengths_along(points):
    """Length of the path up to each of its vertices (m,)."""
    along = np.zeros(len(points))
    for k in range(1, len(points)):
        squared = 0.0
        for i in range(points.shape[1]):
            squared += (points[k, i] - points[k - 1, i]) ** 2
        along[k] = along[k - 1] + math.sqrt(squared)
    return along


@kernel
def _segment_at(along, s):
    """Index of the segment that holds the point at length ``s``."""
    k = 0
    while k < len(along) - 2 and along[k + 1] <= s:
        k += 1
    return k


@kernel
def _point_on(points, along, k, s):
    """Point at length ``s`` on segment ``k``."""
    length = along[k + 1] - along[k]
    fraction = (s - along[k]) / length if length > 0.0 else 0.0
    return points[k] + fraction * (points[k + 1] - points[k])


@kernel
def _joined(points, i, a, b, j):
    """Path with everything between vertices ``i`` and ``j`` replaced by the segment a-b."""
    kept = i + 1
    shorter = np.empty((kept + 2 + len(points) - j, points.shape[1]))
    shorter[:kept] = points[:kept]
    shorter[kept], shorter[kept + 1] = a, b
    tail = kept + 2
    shorter[tail:] = points[j:]
    return shorter
