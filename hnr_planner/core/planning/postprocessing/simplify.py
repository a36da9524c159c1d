"""
Shorter paths by visibility: any two points of a path that see each other may be joined directly.

Every replacement is a straight line, so a path never gets longer, and in rounds it becomes taut.
The work is bounded by the number of visibility tests.
"""

import math

from hnr_planner.core.checks import check_count, check_number, check_points, check_seed, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.clock import working_time
from hnr_planner.core.kernels.streams import Stream, stream
from hnr_planner.core.lengths import path_length
from hnr_planner.core.planning.homology import Islands, NO_ISLANDS
from hnr_planner.core.planning.limits import Budget
from hnr_planner.core.planning.postprocessing.shortcuts import join, pull, skip
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import ArrayLike

#: Visibility tests for one path, and how many go by between two looks at the clock.
TESTS_MAX = 100_000
TESTS_IN_A_BATCH = 500
#: Random pairs of points to join for each segment of a path, and between two looks at the clock.
PAIRS, PAIRS_IN_A_BATCH = 5, 100
#: Paths with more vertices are first passed over with a few looks from each, again and again while
#: that leaves less than this part of them.
MANY = 256
WORTHWHILE = 0.8
#: Rounds end with one that gains less than this part of the length.
LEAST_GAIN = 1e-3
#: What gains less than this is the same path, rounded.
SHORTER = 1.0 - 1e-12


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
    compile_shorten(space, path)
    limits = Budget(working_time() + seconds)
    return shorten(space, path, stream(check_seed(seed)), limits, max_iterations)


def check_path(space: Space, path: ArrayLike) -> Floats:
    """Return ``path`` (m, dim) as a fresh array of free segments, or raise RequestError."""
    points = check_points('path', path, space.dim)
    if points.ndim != 2 or len(points) < 2:
        raise RequestError(f'path must have at least two points, got shape {points.shape}')
    if not np.isfinite(points).all():
        raise RequestError(f'path must be finite, got {points.tolist()}')
    k = space.first_blocked_segment(points)
    if k is not None:
        ends = f'{points[k].tolist()} to {points[k + 1].tolist()}'
        raise RequestError(f'path must be free, but segment {k} from {ends} is not')
    return points


def shorten(
    space: Space,
    path: Floats,
    rng: Stream,
    limits: Budget,
    tests_max: int = TESTS_MAX,
    islands: Islands = NO_ISLANDS,
) -> Floats:
    """
    Shorten a free path (m, dim) of the caller's frame within limits; the same ends.

    It passes each of the ``islands`` on the side where it did before.
    """
    points = space.to_kernel(path)
    points, tests = skip_vertices(space, points, limits, tests_max, islands)
    length, gain = path_length(points), math.inf
    while len(points) > 2 and gain > LEAST_GAIN * length and limits.stop() is None:
        points, used = _tighten(space, points, rng, islands, limits, tests_max - tests)
        tests += used
        gain, length = length - path_length(points), path_length(points)
    shorter = space.from_kernel(points)
    shorter[0], shorter[-1] = path[0], path[-1]
    if path_length(shorter) < SHORTER * path_length(path) and space.is_path_free(shorter):
        return shorter
    return path


def _tighten(
    space: Space,
    points: Floats,
    rng: Stream,
    islands: Islands,
    limits: Budget,
    tests_max: int,
) -> tuple[Floats, int]:
    """Join random points of a path, then pull it taut at each vertex, within limits: likewise."""
    pairs, tests = min(PAIRS * (len(points) - 1), tests_max // 3), 0
    while pairs > 0 and limits.stop() is None:
        batch = min(pairs, PAIRS_IN_A_BATCH)
        points = join(space.data, islands, points, rng, batch)
        pairs, tests = pairs - batch, tests + 3 * batch
    k, used = 1, 1
    while used > 0 and limits.stop() is None:
        batch = min(TESTS_IN_A_BATCH, tests_max - tests)
        points, k, used = pull(space.data, islands, points, k, space.margin, batch)
        tests += used
    return points, tests


def skip_vertices(
    space: Space,
    points: Floats,
    limits: Budget,
    tests_max: int = TESTS_MAX,
    islands: Islands = NO_ISLANDS,
) -> tuple[Floats, int]:
    """Keep only vertices that follow each other as the last one seen: (path, tests)."""
    tests, before = 0, math.inf
    while MANY < len(points) < WORTHWHILE * before:
        before = len(points)
        points, used = _pass_over(space, points, False, islands, limits, tests_max - tests)
        tests += used
    points, used = _pass_over(space, points, True, islands, limits, tests_max - tests)
    return points, tests + used


def _pass_over(
    space: Space,
    points: Floats,
    every: bool,
    islands: Islands,
    limits: Budget,
    tests_max: int,
) -> tuple[Floats, int]:
    """Skip along all of a path, within limits: (path, tests)."""
    kept, n_kept, last = np.zeros(len(points), dtype=np.int64), 1, len(points) - 1
    began, tests = 0, 0
    while began < n_kept and kept[n_kept - 1] < last and limits.stop() is None:
        began = n_kept
        batch = min(max(TESTS_IN_A_BATCH, len(points)), tests_max - tests)
        n_kept, used = skip(space.data, islands, points, kept, n_kept, every, batch)
        tests += used
    rest = np.arange(kept[n_kept - 1] + 1, len(points))
    return points[np.concatenate([kept[:n_kept], rest])], tests


def compile_shorten(space: Space, points: Floats) -> None:
    """Compile what ``shorten`` runs on this kind of space, without doing anything."""
    skip(space.data, NO_ISLANDS, points, np.zeros(1, dtype=np.int64), 1, True, 0)
    join(space.data, NO_ISLANDS, points, stream(0), 0)
    pull(space.data, NO_ISLANDS, points, 1, space.margin, 0)
    path_length(points)
