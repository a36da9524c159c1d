"""The guide of a search among poses: the shortest path of the largest disc in the footprint."""

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.planning.limits import Budget, run
from hnr_planner.core.planning.planner import make_problem
from hnr_planner.core.planning.planners.polyanya import Polyanya
from hnr_planner.core.planning.result import PlannerStatus
from hnr_planner.core.spaces.poses.disc import Disc
import numpy as np


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
