"""
Increase the clearance of a path where there is room; it still passes through narrow doors.

The cost of a path is the integral along it of 1 where the nearest wall is at least ``clearance``
away, and of ``1 + WEIGHT (clearance / d - 1)`` where its distance ``d`` is less. So a detour pays
where it moves the path away from a wall, most of all a near one, and in a door the middle is best.
The path gets vertices where it is nearer to a wall than ``clearance``; each vertex is moved across
the path while that lowers the cost. Vertices whose removal adds at most the fraction ``ADDED`` to
the cost are dropped.
"""

from typing import Any, NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.copies import copy_into, copy_rows
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

#: Cost added to each metre of path where the wall is at half the clearance [m]; and the fraction
#: of the clearance such that the cost is the same at all smaller distances from a wall.
WEIGHT, NEAREST = 2.0, 0.01
#: Bounds on the distance between points at which the clearance of a path is measured, and between
#: its vertices, in units of the typical clearance of the space. Within these bounds both distances
#: are in proportion to the distance from the wall.
FINEST, COARSEST = 0.125, 1.0
#: Largest number of passes over all vertices.
PASSES = 10
#: Shortest step of a vertex across the path, as a fraction of ``ClearanceCost.finest``. Steps are
#: ``ClearanceCost.coarsest`` long at first, and are halved where they do not lower the cost.
LEAST_STEP = 0.125
#: Largest increase of the cost of a section when its vertices are dropped, as a fraction of it.
ADDED = 5e-4


class ClearanceCost(NamedTuple):
    """
    Cost of a path that should keep a clearance.

    Attributes
    ----------
    walls : array
        Walls of the space, as ``Space.walls`` holds them for kernels.
    clearance : float
        Distance that the path should keep from walls, kernel frame.
    finest, coarsest : float
        Least and largest distance along the path between points where the clearance is measured,
        kernel frame.

    """

    walls: Any
    clearance: float
    finest: float
    coarsest: float


def clearance_cost(space: Space, clearance: float) -> ClearanceCost:
    """Return the cost, kernel frame, of paths that should keep a ``clearance`` [m] above 0."""
    finest, coarsest = FINEST * space.typical_clearance, COARSEST * space.typical_clearance
    wanted = min(clearance / space.scale, FARTHEST_WALL)
    return ClearanceCost(space.walls, wanted, finest, max(min(coarsest, wanted / 2.0), finest))


def increase_clearance(
    space: Space, path: Floats, clearance: float, budget: Budget, islands: Islands = NO_ISLANDS
) -> Floats:
    """
    Return a free path (m, 2) of the caller's frame moved away from walls, within the budget.

    The ends are kept. The result passes each of the ``islands`` on the side where ``path`` did.
    ``path`` itself is returned where the moved path costs no less or is not free in the caller's
    frame.
    """
    cost = clearance_cost(space, clearance)
    before = points = space.to_kernel(path)
    # First with few vertices; then with as many as narrow passages need.
    for each in (cost._replace(finest=cost.coarsest), cost):
        points = spread(each, points)
        _move_all(space, islands, each, points, budget)
        points = drop(space.data, islands, each, points)
    _move_all(space, islands, cost, points, budget)
    moved = space.from_kernel(points)
    moved[0], moved[-1] = path[0], path[-1]
    is_better = segment_costs(cost, points).sum() < segment_costs(cost, before).sum()
    return moved if is_better and space.is_path_free(moved) else path


def _move_all(
    space: Space, islands: Islands, cost: ClearanceCost, points: Floats, budget: Budget
) -> None:
    """
    Move the vertices of ``points`` (m, 2), in place, until no step lowers the cost.

    At most ``PASSES`` passes over all vertices are made, and a limit of the budget ends them.
    """
    steps, costs = np.full(len(points), cost.coarsest), segment_costs(cost, points)
    for _ in range(PASSES):
        if budget.stop() is not None or not move(space.data, islands, cost, points, costs, steps):
            break


def path_cost(space: Space, path: Floats, clearance: float) -> float:
    """Return the cost [m] of a path (m, dim), caller's frame: its length where clearance is 0."""
    if clearance == 0.0:
        return float(path_length(path))
    cost = clearance_cost(space, clearance)
    return float(segment_costs(cost, space.to_kernel(path)).sum()) * space.scale


@kernel
def segment_costs(cost, points):
    """
    Return the costs (m,) of the segments of a path (m, dim), kernel frame.

    Entry ``k`` is the cost of the segment from vertex ``k`` - 1 to vertex ``k``, and entry 0 is 0.
    The cost is the length where no wall is nearer than the clearance.
    """
    costs = np.zeros(len(points))
    for k in range(1, len(points)):
        costs[k] = _segment_cost(cost, points[k - 1], points[k], np.inf)
    return costs


@kernel
def _segment_cost(cost, a, b, most):
    """
    Return the cost of the segment a-b (dim,), kernel frame.

    Where the cost reaches ``most``, some value of at least ``most`` is returned instead.
    """
    length, covered, lack = distance(a, b), 0.0, 0.0
    if length == 0.0:
        return 0.0
    x = a.copy()
    gap = clearance_within(cost.walls, x, cost.clearance)
    while covered < length and length + WEIGHT * lack < most:
        piece = min(min(max(gap, cost.finest), cost.coarsest), length - covered)
        for i in range(len(x)):
            x[i] = a[i] + (covered + piece / 2.0) / length * (b[i] - a[i])
        gap = clearance_within(cost.walls, x, cost.clearance)
        lack += piece * (cost.clearance / max(gap, NEAREST * cost.clearance) - 1.0)
        covered += piece
    return length + WEIGHT * lack


@kernel
def spread(cost, points):
    """Return ``points`` (m, dim) with vertices added where walls are near, denser near walls."""
    dense, n_dense = np.empty((2 * len(points), points.shape[1])), 1
    copy_into(dense[0], points[0])
    for k in range(1, len(points)):
        a, way, length = (
            points[k - 1],
            points[k] - points[k - 1],
            distance(points[k - 1], points[k]),
        )
        covered, has_end, end = 0.0, True, a.copy()
        while covered < length:
            begin, gap = end, clearance_within(cost.walls, end, cost.clearance)
            covered = min(covered + min(max(2.0 * gap, cost.finest), 2.0 * cost.coarsest), length)
            end = a + covered / length * way
            enough = (1.0 + ADDED) * distance(begin, end)
            lacks = _segment_cost(cost, begin, end, enough) > enough
            if n_dense + 2 > len(dense):
                larger = np.empty((2 * len(dense), points.shape[1]))
                copy_rows(larger[:n_dense], dense)
                dense = larger
            if lacks and not has_end:
                copy_into(dense[n_dense], begin)
                n_dense += 1
            has_end = lacks or covered == length
            if has_end:
                copy_into(dense[n_dense], end)
                n_dense += 1
    return dense[:n_dense]


@kernel
def move(space, islands, cost, points, costs, steps):
    """
    Move each inner vertex of ``points`` (m, 2) a step across the path; return whether to go on.

    A vertex is moved where the path then costs less; else its entry in ``steps`` (m,) is halved.
    ``costs`` (m,) holds the cost of the segment that ends at each vertex. Returns False once all
    steps are below ``LEAST_STEP`` times the finest distance.
    """
    n_left = 0
    for k in range(1, len(points) - 1):
        if steps[k] >= LEAST_STEP * cost.finest:
            n_left += 1
            if not _move_one(space, islands, cost, points, costs, k, steps[k]):
                steps[k] /= 2.0
    return n_left > 0


@kernel
def _move_one(space, islands, cost, points, costs, k, step):
    """
    Move vertex ``k`` by ``step`` across the line between its neighbours, where that costs less.

    Both segments at the vertex have to stay free, on the same side of each island. Returns whether
    the vertex was moved; then its entries of ``costs`` are updated too.
    """
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
        first = _segment_cost(cost, a, y, before - second)
        if first + second < before:
            second = _segment_cost(cost, y, b, before - first)
            if first + second < before:
                copy_into(x, y)
                costs[k], costs[k + 1] = first, second
                return True
    return False


@kernel
def drop(space, islands, cost, points):
    """
    Return the path (k, 2) without the vertices of ``points`` (m, 2) that it can do without.

    From each vertex that is kept, the vertices after it are left out one by one, as long as the
    segment that replaces them is free, passes each of the ``islands`` on the same side, and costs
    at most the fraction ``ADDED`` more than the section that it replaces. The ends are kept.
    """
    kept, n_kept, k = np.empty_like(points), 1, 0
    copy_into(kept[0], points[0])
    while k < len(points) - 1:
        last = k + 1
        passed = crossings(islands, points[k], points[last])
        before = _segment_cost(cost, points[k], points[last], np.inf)
        while last < len(points) - 1:
            passed += crossings(islands, points[last], points[last + 1])
            before += _segment_cost(cost, points[last], points[last + 1], np.inf)
            if not segment_is_free(space, points[k], points[last + 1]):
                break
            if crossings(islands, points[k], points[last + 1]) != passed:
                break
            most = (1.0 + ADDED) * before
            if _segment_cost(cost, points[k], points[last + 1], most) > most:
                break
            last += 1
        k = last
        copy_into(kept[n_kept], points[k])
        n_kept += 1
    return kept[:n_kept]
