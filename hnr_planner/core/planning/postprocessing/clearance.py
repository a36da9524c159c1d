"""
Paths that stand off from walls where there is room, and pass narrow doors all the same.

A metre of a path costs 1 metre where the wall is as far as wished, ``clearance``, and
``1 + WEIGHT (clearance / d - 1)`` metres at a distance ``d`` below. So a detour pays where it
brings the path away from a wall, most of all where that is near, and in a door the middle is best.
The path gets vertices where it comes too near; each is moved across the path while that lowers the
cost, and those that are not needed any more are dropped.
"""

from typing import Any, NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.lengths import distance, path_length
from hnr_planner.core.planning.homology import (
    crossings,
    Islands,
    loop_signature,
    NO_ISLANDS,
)
from hnr_planner.core.planning.limits import Budget
from hnr_planner.core.spaces.clearance import clearance_within, FARTHEST_WALL
from hnr_planner.core.spaces.primitives import segment_is_free
from hnr_planner.core.spaces.space import Space
import numpy as np

#: Metres that a metre costs beyond its own where the wall is at half the clearance; and the part
#: of the clearance below which nearer does not count as worse.
WEIGHT, NEAREST = 2.0, 0.01
#: A path is looked at, and gets vertices, as often as the wall is near: about as far apart as it
#: is away, within these bounds in units of the typical clearance of the space.
FINEST, COARSEST = 0.125, 1.0
#: Passes of moving all vertices in a row.
PASSES = 10
#: A step across the path is the coarsest distance at first, and halved where it gains nothing,
#: down to this part of the finest.
LEAST_STEP = 0.125
#: Vertices are dropped where that adds no more than this part of the cost.
ADDED = 5e-4


class ClearanceCost(NamedTuple):
    """
    How far from walls a path should be.

    Attributes
    ----------
    walls : array
        The space's ``walls``.
    clearance : float
        Distance wished, kernel frame.
    finest, coarsest : float
        Bounds on the distance between two looks at the walls, kernel frame.

    """

    walls: Any
    clearance: float
    finest: float
    coarsest: float


def clearance_cost(space: Space, clearance: float) -> ClearanceCost:
    """Return the wish for a clearance above 0 in the caller's units [m]."""
    finest, coarsest = FINEST * space.typical_clearance, COARSEST * space.typical_clearance
    wished = min(clearance / space.scale, FARTHEST_WALL)
    return ClearanceCost(space.walls, wished, finest, max(min(coarsest, wished / 2.0), finest))


def increase_clearance(
    space: Space, path: Floats, clearance: float, limits: Budget, islands: Islands = NO_ISLANDS
) -> Floats:
    """
    Move a free path (m, dim) of the caller's frame away from walls, within limits; the same ends.

    It passes each of the ``islands`` on the side where it did before, and never costs more.
    """
    wish = clearance_cost(space, clearance)
    before = points = space.to_kernel(path)
    # Away from walls first, with few vertices; then with as many as narrow places need.
    for each in (wish._replace(finest=wish.coarsest), wish):
        points = spread(each, points)
        _move_all(space, islands, each, points, limits)
        points = drop(space.data, islands, each, points)
    _move_all(space, islands, wish, points, limits)
    moved = space.from_kernel(points)
    moved[0], moved[-1] = path[0], path[-1]
    is_better = segment_costs(wish, points).sum() < segment_costs(wish, before).sum()
    return moved if is_better and space.is_path_free(moved) else path


def _move_all(
    space: Space, islands: Islands, wish: ClearanceCost, points: Floats, limits: Budget
) -> None:
    """Move the vertices, in passes, until no step is left that is worth it."""
    steps, costs = np.full(len(points), wish.coarsest), segment_costs(wish, points)
    for _ in range(PASSES):
        if limits.stop() is not None or not move(space.data, islands, wish, points, costs, steps):
            break


def path_cost(space: Space, path: Floats, clearance: float) -> float:
    """Return the cost of a path (m, dim) of the caller's frame; its length for clearance 0."""
    if clearance == 0.0:
        return float(path_length(path))
    wish = clearance_cost(space, clearance)
    return float(segment_costs(wish, space.to_kernel(path)).sum()) * space.scale


@kernel
def segment_costs(wish, points):
    """Costs (m,) of the segments to each vertex: their lengths where walls are far enough."""
    costs = np.zeros(len(points))
    for k in range(1, len(points)):
        costs[k] = _segment_cost(wish, points[k - 1], points[k], np.inf)
    return costs


@kernel
def _segment_cost(wish, a, b, most):
    """Cost of a segment, looked for until it is known to be above ``most``."""
    length, done, lacking = distance(a, b), 0.0, 0.0
    if length == 0.0:
        return 0.0
    x = a.copy()
    room = clearance_within(wish.walls, x, wish.clearance)
    while done < length and length + WEIGHT * lacking < most:
        piece = min(min(max(room, wish.finest), wish.coarsest), length - done)
        for i in range(len(x)):
            x[i] = a[i] + (done + piece / 2.0) / length * (b[i] - a[i])
        room = clearance_within(wish.walls, x, wish.clearance)
        lacking += piece * (wish.clearance / max(room, NEAREST * wish.clearance) - 1.0)
        done += piece
    return length + WEIGHT * lacking


@kernel
def spread(wish, points):
    """Path with vertices at both ends of each piece that lacks room, shorter where it has less."""
    dense, n_dense = np.empty((2 * len(points), points.shape[1])), 1
    dense[0] = points[0]
    for k in range(1, len(points)):
        a, way, length = (
            points[k - 1],
            points[k] - points[k - 1],
            distance(points[k - 1], points[k]),
        )
        done, has_end, end = 0.0, True, a.copy()
        while done < length:
            begin, room = end, clearance_within(wish.walls, end, wish.clearance)
            done = min(done + min(max(2.0 * room, wish.finest), 2.0 * wish.coarsest), length)
            end = a + done / length * way
            enough = (1.0 + ADDED) * distance(begin, end)
            lacks = _segment_cost(wish, begin, end, enough) > enough
            if n_dense + 2 > len(dense):
                dense = np.concatenate((dense, np.empty_like(dense)))
            if lacks and not has_end:
                dense[n_dense] = begin
                n_dense += 1
            has_end = lacks or done == length
            if has_end:
                dense[n_dense] = end
                n_dense += 1
    return dense[:n_dense]


@kernel
def move(space, islands, wish, points, costs, steps):
    """
    Move each vertex a step across the path where that costs less, or halve its step.

    ``costs`` (m,) are those of the segments to each vertex. Returns whether steps are left to try.
    """
    n_left = 0
    for k in range(1, len(points) - 1):
        if steps[k] >= LEAST_STEP * wish.finest:
            n_left += 1
            if not _move_one(space, islands, wish, points, costs, k, steps[k]):
                steps[k] /= 2.0
    return n_left > 0


@kernel
def _move_one(space, islands, wish, points, costs, k, step):
    """Move vertex ``k`` to either side of the line between its neighbours if that costs less."""
    a, x, b, before = points[k - 1], points[k], points[k + 1], costs[k] + costs[k + 1]
    length = distance(a, b)
    if length == 0.0 or before <= length:
        return False
    across = np.array([a[1] - b[1], b[0] - a[0]]) * (step / length)
    for y in (x + across, x - across):
        second = distance(y, b)
        if distance(a, y) + second >= before or not (
            segment_is_free(space, a, y) and segment_is_free(space, y, b)
        ):
            continue
        if loop_signature(islands, a, x, b) != loop_signature(islands, a, y, b):
            continue
        first = _segment_cost(wish, a, y, before - second)
        if first + second < before:
            second = _segment_cost(wish, y, b, before - first)
            if first + second < before:
                x[:], costs[k], costs[k + 1] = y, first, second
                return True
    return False


@kernel
def drop(space, islands, wish, points):
    """Path without the vertices that can be left out at hardly any cost."""
    kept, n_kept, k = np.empty_like(points), 1, 0
    kept[0] = points[0]
    while k < len(points) - 1:
        last = k + 1
        passed = crossings(islands, points[k], points[last])
        before = _segment_cost(wish, points[k], points[last], np.inf)
        while last < len(points) - 1:
            passed += crossings(islands, points[last], points[last + 1])
            before += _segment_cost(wish, points[last], points[last + 1], np.inf)
            if not segment_is_free(space, points[k], points[last + 1]):
                break
            if crossings(islands, points[k], points[last + 1]) != passed:
                break
            most = (1.0 + ADDED) * before
            if _segment_cost(wish, points[k], points[last + 1], most) > most:
                break
            last += 1
        k = last
        kept[n_kept] = points[k]
        n_kept += 1
    return kept[:n_kept]


def compile_clearance(space: Space, ends: Floats, clearance: float) -> None:
    """Compile what ``increase_clearance`` runs on this kind of space."""
    wish = clearance_cost(space, clearance)
    points = spread(wish, ends)
    costs = segment_costs(wish, points)
    move(space.data, NO_ISLANDS, wish, points, costs, np.zeros(len(points)))
    drop(space.data, NO_ISLANDS, wish, points)
