"""Searches without a clock: success must not depend on how fast the machine is."""

import math
from typing import Any

from hnr_planner.core import GridSpace, PlanResult
from hnr_planner.core import plan as plan_in_time
from hnr_planner.core.kernels.streams import stream
from hnr_planner.core.planning.planner import for_space, make_problem
from hnr_planner.core.planning.registry import make_planner
import numpy as np
from numpy.typing import NDArray


def start_search(
    algorithm: str,
    blocked: NDArray[np.bool_],
    seed: int,
    goal_radius: float = 0.0,
    **settings: Any,
):
    """Start a search in cells, from the lower left to the upper right cell."""
    space = GridSpace.from_blocked(blocked)
    lower, upper = space.bounds
    problem = make_problem(space, lower + 0.5, upper - 0.5, goal_radius)
    return for_space(make_planner(algorithm, settings), space).start(problem, stream(seed))


def plan(*request: Any, **given: Any) -> PlanResult:
    """Plan without a time limit, unless one is given."""
    return plan_in_time(*request, **{'time_limit': math.inf, **given})
