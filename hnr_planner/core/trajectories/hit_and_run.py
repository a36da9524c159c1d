"""
Hit-and-Run under a controller (paper, Section 5).

The desired position is a uniform point of a random chord through the present position. The desired
velocity is uniform in the ball whose radius is the largest speed. The next transition begins in
the state that the controller reached in the last one.
"""

from dataclasses import dataclass
from typing import ClassVar

from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.sampling.draws import draw_in_ball, hit_and_run_step
from hnr_planner.core.trajectories.driven import drive, DrivenPlanner, DrivenSearch
from hnr_planner.core.trajectories.problem import KinodynamicProblem
import numpy as np


@dataclass(frozen=True)
class KinodynamicHitAndRun(DrivenPlanner):
    """The paper's Hit-and-Run for systems; settings as in ``DrivenPlanner``."""

    name: ClassVar[str] = 'kinodynamic_hit_and_run'

    def start(self, problem: KinodynamicProblem, rng: Stream) -> 'KinodynamicHitAndRunSearch':
        """Return a search whose chain begins at the start of ``problem``, with a random stream."""
        return KinodynamicHitAndRunSearch(problem, self.driving, rng)


@dataclass
class KinodynamicHitAndRunSearch(DrivenSearch):
    """A running search by one chain: every transition begins in the newest state."""

    def advance(self, n_iterations: int) -> None:
        """Make at most ``n_iterations`` further transitions; none once the search is solved."""
        if self.solved:
            return
        self._grow_arrays(n_iterations)
        self._n_rows, taken, n_steps, self.solved = _walk(
            self.problem, self.driving, self.rng, self._steps, self._n_rows, n_iterations
        )
        self.iterations += taken
        self.n_steps += n_steps


@kernel
def _walk(problem, driving, rng, steps, n_rows, n_iterations):
    """
    Extend the chain by at most ``n_iterations`` transitions, in place in the table ``steps``.

    Returns (number of rows, transitions made, steps tried, whether the goal is reached).
    """
    problem, rng, steps = borrowed(problem), borrowed(rng), borrowed(steps)
    geometric, n_steps = problem.geometric, 0
    dim = len(geometric.goal)
    position, velocity = np.empty(dim), np.empty(dim)
    for k in range(n_iterations):
        hit_and_run_step(geometric.space, steps.states[n_rows - 1, :dim], rng, position)
        draw_in_ball(problem.system.max_speed, rng, velocity)
        n_rows, tried, reached = drive(
            problem, driving, steps, n_rows, n_rows - 1, position, velocity
        )
        n_steps += tried
        if reached:
            return n_rows, k + 1, n_steps, True
    return n_rows, n_iterations, n_steps, False
