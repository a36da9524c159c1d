"""
Shorten paths by visibility: replace sections by free segments between points of the path.

Every replacement is a straight line, so a path never gets longer, and repeated rounds pull it
taut. The work is bounded by the number of visibility tests.
"""

import math

from hnr_planner.core.checks import check_count, check_number, check_points, check_seed, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.clock import working_time
from hnr_planner.core.kernels.streams import Stream, stream
from hnr_planner.core.lengths import path_length
from hnr_planner.core.planning.homology import Islands, NO_ISLANDS
from hnr_planner.core.planning.limits import Budget
from hnr_planner.core.planning.planner import check_rigid
from hnr_planner.core.planning.postprocessing.shortcuts import join, pull, relax, skip
from hnr_planner.core.spaces.lines import check_straight_lines
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import ArrayLike

#: Largest number of visibility tests for one path, and of those between two checks of the budget.
TESTS_MAX = 100_000
TESTS_IN_A_BATCH = 500
#: Random pairs of points to join for each segment of a path, in the plane and in more dimensions,
#: where the corners of a taut path cannot be found one by one; and pairs between two checks.
PAIRS, PAIRS_IN_SPACE, PAIRS_IN_A_BATCH = 5, 50, 100
#: Number of vertices above which a path is first passed over with few tests for each, again and
#: again while that leaves less than this fraction of them.
MANY = 256
WORTHWHILE = 0.8
#: Rounds of shortening end after a round that shortens the path by less than this fraction.
LEAST_GAIN = 1e-3
#: Ratio of the new length to the old one at and above which a path counts as not shortened.
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
    Return a free path that is no longer than ``path``, from the same start to the same goal.

    Parameters
    ----------
    space : Space
        Where the path has to be free.
    path : (m, dim)
        At least two points in the caller's frame [m], every segment between them free.
    seed : int, optional
        Seed of all random draws; a fresh one when left out.
    max_iterations : int
        Largest number of visibility tests.
    time_limit : float, optional
        Seconds after which the path shortened so far is returned.

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
    budget = Budget(working_time() + seconds)
    return shorten(space, path, stream(check_seed(seed)), budget, max_iterations)


def check_path(space: Space, path: ArrayLike) -> Floats:
    """Return ``path`` (m, dim) as a fresh array of free segments, or raise RequestError."""
    check_straight_lines(space, 'simplify')
    check_rigid(space)
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
    budget: Budget,
    tests_max: int = TESTS_MAX,
    islands: Islands = NO_ISLANDS,
) -> Floats:
    """
    Shorten a free path (m, dim) of the caller's frame within the budget; its ends are kept.

    At most ``tests_max`` visibility tests are made. The result (k, dim) passes each of the
    ``islands`` on the side where ``path`` did; it is ``path`` itself where that cannot be
    shortened. Where the coordinates of the caller's frame round the result into an obstacle, the
    halves of the path are shortened instead, unless it has fewer than 4 vertices.
    """
    shorter, tests = _shortened(space, path, rng, budget, tests_max, islands)
    if path_length(shorter) >= SHORTER * path_length(path):
        return path
    if space.is_path_free(shorter):
        return shorter
    if len(path) < 4:
        return path
    middle, left = len(path) // 2, (tests_max - tests) // 2
    end = middle + 1
    halves = [
        shorten(space, half, rng, budget, left, islands) for half in (path[:end], path[middle:])
    ]
    return np.concatenate([halves[0], halves[1][1:]])


def _shortened(
    space: Space, path: Floats, rng: Stream, budget: Budget, tests_max: int, islands: Islands
) -> tuple[Floats, int]:
    """
    Return a shorter path (k, dim), caller's frame, and the number of visibility tests made.

    The path was tested in the kernel frame; it need not be free in the caller's coordinates.
    """
    points, tests = skip_vertices(space, space.to_kernel(path), budget, tests_max, islands)
    length, gain = path_length(points), math.inf
    while len(points) > 2 and gain > LEAST_GAIN * length and budget.stop() is None:
        points, used = _tighten(space, points, rng, islands, budget, tests_max - tests)
        tests += used
        gain, length = length - path_length(points), path_length(points)
    shorter = space.from_kernel(points)
    shorter[0], shorter[-1] = path[0], path[-1]
    return shorter, tests


def _tighten(
    space: Space,
    points: Floats,
    rng: Stream,
    islands: Islands,
    budget: Budget,
    tests_max: int,
) -> tuple[Floats, int]:
    """
    Join random points of a path, then pull it taut at each vertex.

    Returns (path (k, dim), kernel frame; number of visibility tests, at most ``tests_max``).
    """
    pairs_of_a_segment = PAIRS if space.dim <= 2 else PAIRS_IN_SPACE
    pairs, tests = min(pairs_of_a_segment * (len(points) - 1), tests_max // 3), 0
    while pairs > 0 and budget.stop() is None:
        batch = min(pairs, PAIRS_IN_A_BATCH)
        points = join(space.data, islands, points, rng, batch)
        pairs, tests = pairs - batch, tests + 3 * batch
    k, used = 1, 1
    while used > 0 and k < len(points) - 1 and budget.stop() is None:
        batch = min(TESTS_IN_A_BATCH, tests_max - tests)
        points, k, used = pull(space.data, islands, points, k, space.margin, batch)
        tests += used
    return points, tests


def skip_vertices(
    space: Space,
    points: Floats,
    budget: Budget,
    tests_max: int = TESTS_MAX,
    islands: Islands = NO_ISLANDS,
) -> tuple[Floats, int]:
    """
    Drop vertices of a path (m, dim) of the kernel frame; return (path, number of tests).

    In the plane each vertex is followed by the last one visible from it, since the result is
    easily pulled taut. In more dimensions the result is not easily pulled taut, so the shortest
    path over vertices is taken, unless more than ``MANY`` vertices are left.
    """
    tests, before = 0, math.inf
    while MANY < len(points) < WORTHWHILE * before:
        before = len(points)
        points, used = _pass_over(space, points, False, islands, budget, tests_max - tests)
        tests += used
    if space.dim > 2 and len(points) <= MANY:
        points, used = _shortest_over_vertices(space, points, islands, budget, tests_max - tests)
    else:
        points, used = _pass_over(space, points, True, islands, budget, tests_max - tests)
    return points, tests + used


def _shortest_over_vertices(
    space: Space, points: Floats, islands: Islands, budget: Budget, tests_max: int
) -> tuple[Floats, int]:
    """
    Return the shortest path (k, dim) over some of ``points``, in their order, and the tests made.

    Where a limit of the budget or ``tests_max`` ends the work, the path is the shortest found.
    """
    to_end, following = np.zeros(len(points)), np.arange(1, len(points) + 1)
    i, tests = len(points) - 2, 0
    while i >= 0 and tests < tests_max and budget.stop() is None:
        batch = min(TESTS_IN_A_BATCH, tests_max - tests)
        i, used = relax(space.data, islands, points, to_end, following, i, batch)
        tests += used
    kept, links = [0], following.tolist()
    while kept[-1] < len(points) - 1:
        kept.append(links[kept[-1]])
    return points[kept], tests


def _pass_over(
    space: Space,
    points: Floats,
    every: bool,
    islands: Islands,
    budget: Budget,
    tests_max: int,
) -> tuple[Floats, int]:
    """
    Skip vertices along all of a path (``skip``); return (path (k, dim), number of tests).

    Where a limit of the budget or ``tests_max`` ends the work, the rest of ``points`` is kept.
    """
    kept, n_kept, last = np.zeros(len(points), dtype=np.int64), 1, len(points) - 1
    began, tests = 0, 0
    while began < n_kept and kept[n_kept - 1] < last and budget.stop() is None:
        began = n_kept
        batch = min(max(TESTS_IN_A_BATCH, len(points)), tests_max - tests)
        n_kept, used = skip(space.data, islands, points, kept, n_kept, every, batch)
        tests += used
    rest = np.arange(kept[n_kept - 1] + 1, len(points))
    return points[np.concatenate([kept[:n_kept], rest])], tests
