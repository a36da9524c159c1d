"""Compiling everything before anyone waits for it."""

from hnr_planner.core.checks import check_choice
from hnr_planner.core.planning.plan import plan
from hnr_planner.core.planning.registry import ALGORITHMS
from hnr_planner.core.sampling.sample import sample
from hnr_planner.core.sampling.walks import WALKS
from hnr_planner.core.spaces.grid.grid_space import GridSpace
from hnr_planner.core.systems import DoubleIntegrator
from hnr_planner.core.trajectories.plan_trajectory import plan_trajectory
from hnr_planner.core.trajectories.registry import KINODYNAMIC_PLANNERS
import numpy as np

START, GOAL = (0.5, 0.5), (2.5, 2.5)


def warm_up(*uses: str) -> None:
    """
    Compile, or load from the cache, all that requests on a grid need: answer some on a small one.

    Parameters
    ----------
    *uses : str
        What will be asked for: 'paths', 'motions' of systems, 'samples'; all of it if left out.

    Raises
    ------
    RequestError
        When a use is none of these.

    """
    space = GridSpace.from_blocked(np.zeros((3, 3), dtype=bool))
    for use in uses or tuple(_USES):
        _USES[check_choice('use', use, tuple(_USES))](space)


def _find_paths(space: GridSpace) -> None:
    for algorithm in ALGORITHMS:
        plan(space, START, GOAL, algorithm=algorithm, seed=0, optimize_iterations=1)
    plan(space, START, GOAL, seed=0, alternatives=2, clearance=1.0)
    space.nearest_reachable(START, GOAL, 1.0)
    space.clearance(START)
    space.path_clearance([START, GOAL])


def _find_motions(space: GridSpace) -> None:
    for algorithm in KINODYNAMIC_PLANNERS:
        state, system = (*START, 0.0, 0.0), DoubleIntegrator()
        plan_trajectory(space, system, state, GOAL, algorithm=algorithm, goal_radius=1.0, seed=0)


def _draw_samples(space: GridSpace) -> None:
    for walk in WALKS:
        sample(space, START, 1, walk=walk, seed=0)
    space.chord(START, (1.0, 0.0))


_USES = {'paths': _find_paths, 'motions': _find_motions, 'samples': _draw_samples}
