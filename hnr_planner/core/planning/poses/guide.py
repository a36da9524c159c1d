"""
The guide of a search among poses: the shortest path of the largest disc in the footprint.

``draw_along_guide`` draws poses around it, which a search extends its trees towards.
"""

import math

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import normal, Stream, uniform
from hnr_planner.core.planning.limits import Budget, run
from hnr_planner.core.planning.planner import make_problem
from hnr_planner.core.planning.planners.polyanya import Polyanya
from hnr_planner.core.planning.result import PlannerStatus
from hnr_planner.core.spaces.poses.disc import Disc
from hnr_planner.core.spaces.poses.motion import wrapped
from hnr_planner.core.spaces.primitives import contains
import numpy as np

#: Standard deviations of a pose along the guide: of its place, as a fraction of the footprint's
#: reach, at the last of the draws and in proportion before, and of its heading [rad].
SPREAD, SPREAD_YAW = 1.0, 0.3
#: How far before and behind a point of the guide its heading is taken, in reaches.
LOOK = 0.5
#: Largest number of draws of a pose along the guide until one is free.
N_DRAWS = 12
#: Probability that such a pose is near the farthest that its tree has reached, and how near, in
#: reaches of the footprint.
NEARBY, AHEAD = 0.8, 12.0


def shortest_guide(disc: Disc, start: Floats, goal: Floats, rng: Stream, budget: Budget) -> Floats:
    """
    Return the shortest path of the disc between two poses (3,) of the robot, map frame.

    Returns
    -------
    (k, 3)
        Points in the kernel frame, and the length up to each [cells]; (0, 3) where a limit of the
        budget is met first.

    """
    problem = make_problem(disc.space, disc.place(start), disc.place(goal), 0.0)
    search = Polyanya().for_space(disc.space).start(problem, rng)
    if run(search, budget) is not PlannerStatus.SOLVED:
        return np.empty((0, 3))
    points = search.path
    lengths = np.hypot(*np.diff(points, axis=0).T)
    return np.column_stack([points, np.append(0.0, np.cumsum(lengths))])


@kernel
def draw_along_guide(problem, trees, tree, rng):
    """
    Write a pose along the guide to ``trees.work[0]``; return the length of the guide up to there.

    The pose is within ``AHEAD`` of the farthest that the tree has reached, or anywhere. It is
    drawn again, up to ``N_DRAWS`` times, until it is free.
    """
    guide, pose = problem.guide, trees.work[0]
    total, reach = guide[len(guide) - 1, 2], problem.space.reach
    low, high = 0.0, total
    if uniform(rng) < NEARBY:
        low = max(trees.progress[tree] - AHEAD * reach, 0.0)
        high = min(trees.progress[tree] + AHEAD * reach, total)
    along = low
    for draw in range(N_DRAWS):
        along = low + (high - low) * uniform(rng)
        x, y = _point_of_guide(problem, along)
        before_x, before_y = _point_of_guide(problem, along - LOOK * reach)
        after_x, after_y = _point_of_guide(problem, along + LOOK * reach)
        spread = SPREAD * reach * (draw + 1) / N_DRAWS
        yaw = math.atan2(after_y - before_y, after_x - before_x) + SPREAD_YAW * normal(rng)
        cos, sin = math.cos(yaw), math.sin(yaw)
        pose[0] = x + spread * normal(rng) - cos * problem.disc[0] + sin * problem.disc[1]
        pose[1] = y + spread * normal(rng) - sin * problem.disc[0] - cos * problem.disc[1]
        pose[2] = wrapped(yaw)
        if contains(problem.space, pose):
            break
    return along


@kernel
def _point_of_guide(problem, along):
    """
    Return the point (x, y) of the guide after a length, moved away from walls.

    A shortest path passes corners as closely as it can. Its points climb the distance to blocked
    cells, cell by cell, up to the footprint's reach: in a door to the middle.
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
    while here < problem.space.reach:
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
