"""
The guide of a search among poses: the shortest path of the largest disc in the footprint.

``draw_along_guide`` draws poses around it, which a search extends its trees towards.
"""

import math

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.kernels.streams import normal, uniform
from hnr_planner.core.planning.limits import Budget, run
from hnr_planner.core.planning.planner import Problem
from hnr_planner.core.planning.planners.cone_expansion import begin as begin_search
from hnr_planner.core.planning.planners.cones import FINAL, N_VERTICES, NONE
from hnr_planner.core.planning.planners.polyanya import PolyanyaSearch
from hnr_planner.core.planning.planners.taut_path import taut_path
from hnr_planner.core.planning.result import PlannerStatus
from hnr_planner.core.spaces.poses.disc import Disc
from hnr_planner.core.spaces.poses.motion import wrapped
from hnr_planner.core.spaces.primitives import component, contains
import numpy as np

#: Standard deviations of a pose along the guide: of its place, in strides of the
#: robot, at the last of the draws and in proportion before, and of its heading [rad].
SPREAD, SPREAD_YAW = 1.0, 0.3
#: How far before and behind a point of the guide its heading is taken, in strides.
LOOK = 0.5
#: Largest number of draws of a pose along the guide until one is free.
N_DRAWS = 12
#: Side of the square in which the place of a detour is drawn, in two strides, and the largest
#: number of places until a guide goes round.
DETOUR, N_PLACES = 8.0, 20
#: Most expansions of the search for a guide that are made at once, and rows for what they add.
N_AT_ONCE, ROWS_AT_ONCE = 500, 4096
#: Probability that such a pose is near the farthest that its tree has reached, and how far behind
#: that, as a fraction of the distance ahead.
NEARBY, BEHIND = 0.8, 0.5


def shortest_guide(disc: Disc, start: Floats, goal: Floats, budget: Budget) -> Floats:
    """
    Return the shortest path of the disc between two poses (3,) of the robot, kernel frame.

    Returns
    -------
    (k, 3)
        Points in the kernel frame, and the length up to each [cells]; (0, 3) where a limit of the
        budget is met first.

    """
    return _shortest(disc, disc.cell_place(start), disc.cell_place(goal), budget)


def detour_guide(
    disc: Disc,
    start: Floats,
    goal: Floats,
    stuck: Floats,
    stride: float,
    budget: Budget,
    seed: int,
) -> Floats:
    """
    Return a guide between two poses by way of a random place near where a search is stuck.

    Where the shortest path of the disc leads through a place that is too tight for the footprint,
    the way round leads by another place near there, and not through that one if there is a choice.

    Parameters
    ----------
    disc, start, goal, budget
        Those of ``shortest_guide``.
    stuck : (2,)
        Where the search got stuck, kernel frame [cells].
    stride : float
        Length of a short manoeuvre [cells].
    seed : int
        Seed of the random place.

    """
    rng, points = np.random.default_rng(seed), np.empty((0, 3))
    begin, end = disc.cell_place(start), disc.cell_place(goal)
    here = component(disc.space.data, begin)
    for _ in range(N_PLACES):
        place = stuck + DETOUR * stride * rng.uniform(-1.0, 1.0, 2)
        if component(disc.space.data, place) != here:
            continue
        legs = (begin, place), (place, end)
        points = np.vstack([_shortest(disc, *leg, budget) for leg in legs])
        if _distance(points[:, :2], stuck) > stride:
            break
    return with_lengths(points)


def _distance(points: Floats, place: Floats) -> float:
    """Return the distance of a place (2,) from the path along points (k, 2); inf for no path."""
    if len(points) < 2:
        return math.inf
    steps, away = np.diff(points, axis=0), place - points[:-1]
    squared = np.maximum((steps**2).sum(axis=1), np.finfo(float).tiny)
    shares = np.clip((steps * away).sum(axis=1) / squared, 0.0, 1.0)
    return float(np.hypot(*(shares[:, np.newaxis] * steps - away).T).min())


def _shortest(disc: Disc, begin: Floats, end: Floats, budget: Budget) -> Floats:
    """Return the guide (k, 3) along the shortest path of the disc; (0, 3) if it is not found."""
    space = disc.space
    problem = Problem(
        space.data, *space.kernel_bounds, begin, end, 0.0, space.margin, 1.0, space.scale
    )
    # Most guides are found at once. The slabs are made here too, which takes long interpreted.
    guide = budget.within(lambda: guide_at_once(space.slabs, problem), np.empty((0, 3)))
    return guide if len(guide) > 0 else guide_in_batches(disc, problem, budget)


def guide_in_batches(disc: Disc, problem: Problem, budget: Budget) -> Floats:
    """Return the guide along the shortest path; (0, 3) where a limit of the budget is met."""
    search = PolyanyaSearch(problem, disc.space)
    if run(search, budget) is not PlannerStatus.SOLVED:
        return np.empty((0, 3))
    return with_lengths(search.path)


@kernel
def guide_at_once(slabs, problem):
    """Return the guide along the shortest path; (0, 3) if it takes over ``N_AT_ONCE`` steps."""
    frontier, _, _ = begin_search(
        slabs, problem.start, problem.goal, 0.0, problem.margin, ROWS_AT_ONCE, N_AT_ONCE
    )
    last = frontier.sizes[FINAL]
    if last == NONE:
        return np.empty((0, 3))
    vertices = frontier.vertices[: frontier.sizes[N_VERTICES]]
    return with_lengths(taut_path(problem, slabs.steps, vertices, last))


@kernel
def with_lengths(points):
    """Return points (k, 2 or more) of a path with the length up to each: (k, 3)."""
    guide, length = np.empty((len(points), 3)), 0.0
    for k in range(len(points)):
        x, y = points[k, 0], points[k, 1]
        if k > 0:
            length += math.hypot(x - points[k - 1, 0], y - points[k - 1, 1])
        guide[k, 0], guide[k, 1], guide[k, 2] = x, y, length
    return guide


def point_of_guide(guide: Floats, along: float) -> Floats:
    """Return the point (2,) of a guide (k, 3) after a length [cells], kernel frame."""
    return np.array([np.interp(along, guide[:, 2], guide[:, axis]) for axis in range(2)])


@kernel
def draw_along_guide(problem, trees, tree, rng):
    """
    Write a pose along the guide to ``trees.work[0]``; return the length of the guide up to there.

    The pose is within ``AHEAD`` of the farthest that the tree has reached, or anywhere. It is
    drawn again, up to ``N_DRAWS`` times, until it is free.
    """
    guide, pose = problem.guide, trees.work[0]
    total, stride = guide[len(guide) - 1, 2], problem.space.stride
    low, high = 0.0, total
    if uniform(rng) < NEARBY:
        way = trees.ahead[tree] if tree == 0 else -trees.ahead[tree]
        low = min(max(trees.progress[tree] - BEHIND * way, 0.0), total)
        high = min(max(trees.progress[tree] + way, 0.0), total)
    along = low
    for draw in range(N_DRAWS):
        along = low + (high - low) * uniform(rng)
        x, y, yaw = _place_along(problem, along)
        spread = SPREAD * stride * (draw + 1) / N_DRAWS
        yaw += SPREAD_YAW * normal(rng)
        x, y = x + spread * normal(rng), y + spread * normal(rng)
        _write_pose(problem, x, y, yaw, pose)
        if contains(problem.space, pose):
            break
    return along


@kernel
def write_pose_along(problem, along, pose):
    """Write the pose along the guide after a length [cells] to ``pose`` (3,)."""
    x, y, yaw = _place_along(problem, along)
    _write_pose(problem, x, y, yaw, pose)


@kernel
def _place_along(problem, along):
    """Return where the disc is after a length of the guide, and where it heads: (x, y, yaw)."""
    look = LOOK * problem.space.stride
    x, y = _point_of_guide(problem, along)
    before_x, before_y = _point_of_guide(problem, along - look)
    after_x, after_y = _point_of_guide(problem, along + look)
    return x, y, math.atan2(after_y - before_y, after_x - before_x)


@inlined
def _write_pose(problem, x, y, yaw, pose):
    """Write the pose (3,) at which the disc is at (x, y)."""
    cos, sin = math.cos(yaw), math.sin(yaw)
    pose[0] = x - cos * problem.disc[0] + sin * problem.disc[1]
    pose[1] = y - sin * problem.disc[0] - cos * problem.disc[1]
    pose[2] = wrapped(yaw)


@kernel
def _point_of_guide(problem, along):
    """
    Return the point (x, y) of the guide after a length, moved away from walls.

    A shortest path passes corners as closely as it can. Its points climb the distance to blocked
    cells, cell by cell, up to a stride: in a door to the middle.
    """
    guide, distance = problem.guide, problem.space.free_distance
    k = 1
    while k < len(guide) - 1 and guide[k, 2] < along:
        k += 1
    length = guide[k, 2] - guide[k - 1, 2]
    share = (along - guide[k - 1, 2]) / length if length > 0.0 else 0.0
    share = min(max(share, 0.0), 1.0)
    x = guide[k - 1, 0] + share * (guide[k, 0] - guide[k - 1, 0])
    y = guide[k - 1, 1] + share * (guide[k, 1] - guide[k - 1, 1])
    column, row = math.floor(x), math.floor(y)
    here = int(distance[row, column])
    while here < problem.space.stride:
        best, step_x, step_y = here, 0, 0
        for dy in range(-1, 2):
            for dx in range(-1, 2):
                there = int(distance[row + dy, column + dx])
                if there > best:
                    best, step_x, step_y = there, dx, dy
        if best == here:
            break
        here, column, row = best, column + step_x, row + step_y
        x, y = x + step_x, y + step_y
    return x, y
