"""
The paper's claim for positions only: on a spiral Hit-and-Run needs fewer transitions than RRT.

The mean over 500 runs for each planner and width; the claim holds where the 95 % intervals of the
two means are apart.
"""

from test.sweeps import sweep_but

from hnr_planner.core import GridSpace, plan, PlannerStatus
from hnr_planner.maps import Corridor, spiral
import numpy as np
from numpy.typing import NDArray
import pytest

RUNS = 500
#: From the paper's narrowest spiral to its widest, which takes least time.
WIDTHS = sweep_but([2.4], [1.2, 1.6, 2.0, 2.4])


def transitions(space: GridSpace, problem: Corridor, algorithm: str) -> NDArray[np.int64]:
    counts = []
    for seed in range(RUNS):
        result = plan(
            space,
            problem.start,
            problem.goal,
            algorithm=algorithm,
            goal_radius=problem.goal_radius,
            seed=seed,
            simplify=False,
            time_limit=60.0,
        )
        assert result.status is PlannerStatus.SOLVED
        counts.append(result.iterations)
    return np.array(counts)


@pytest.mark.parametrize('width', WIDTHS)
def test_hit_and_run_needs_fewer_transitions_than_rrt(width: float):
    problem = spiral(width)
    space = GridSpace.from_blocked(problem.blocked, problem.resolution)
    walk, tree = (transitions(space, problem, name) for name in ('hit_and_run', 'rrt'))
    half_walk, half_tree = (1.96 * counts.std() / RUNS**0.5 for counts in (walk, tree))
    assert walk.mean() + half_walk < tree.mean() - half_tree
