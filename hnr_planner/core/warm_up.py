"""Compiling everything before anyone waits for it."""

from hnr_planner.core.planning.algorithms import ALGORITHMS
from hnr_planner.core.planning.kinodynamic.algorithms import KINODYNAMIC_PLANNERS
from hnr_planner.core.planning.plan import plan
from hnr_planner.core.sampling.sample import sample
from hnr_planner.core.sampling.steps import WALKS
from hnr_planner.core.spaces.grid import GridSpace
from hnr_planner.core.systems import DoubleIntegrator
import numpy as np


def warm_up() -> None:
    """Compile, or load from the cache, all that requests on a grid need: run it on a small one."""
    space = GridSpace.from_blocked(np.zeros((3, 3), dtype=bool))
    start, goal = (0.5, 0.5), (2.5, 2.5)
    for algorithm in ALGORITHMS:
        plan(space, start, goal, algorithm=algorithm, seed=0, optimize_iterations=1)
    plan(space, start, goal, seed=0, alternatives=2, clearance=1.0)
    for algorithm in KINODYNAMIC_PLANNERS:
        state, system = (*start, 0.0, 0.0), DoubleIntegrator()
        plan(space, state, goal, system=system, algorithm=algorithm, goal_radius=1.0, seed=0)
    for walk in WALKS:
        sample(space, start, 1, walk=walk, seed=0)
    space.nearest_reachable(start, goal, 1.0)
    space.chord(start, (1.0, 0.0))
    space.clearance(start)
    space.path_clearance([start, goal])
