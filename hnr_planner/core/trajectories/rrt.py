"""
RRT under a controller (paper, Section 5; LaValle and Kuffner 2001).

The desired position is uniform in the space. The desired velocity is uniform in the ball whose
radius is the largest speed. The controller drives to this target from the nearest vertex;
distances include position and weighted velocity.
"""

from dataclasses import dataclass, field
from typing import ClassVar

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.planning.planner import with_capacity
from hnr_planner.core.planning.planners.nearest import (
    BoxTree,
    empty_box_tree,
    grown,
    insert,
    nearest,
)
from hnr_planner.core.planning.planners.rrt import draw_in_box, PROPOSALS_PER_ITERATION
from hnr_planner.core.sampling.draws import draw_in_ball
from hnr_planner.core.spaces.primitives import contains
from hnr_planner.core.systems.primitives import velocity
from hnr_planner.core.trajectories.driven import drive, DrivenPlanner, DrivenSearch
from hnr_planner.core.trajectories.problem import KinodynamicProblem
import numpy as np


@dataclass(frozen=True)
class KinodynamicRRT(DrivenPlanner):
    """The paper's RRT for systems; settings as in ``DrivenPlanner``."""

    name: ClassVar[str] = 'kinodynamic_rrt'

    def start(self, problem: KinodynamicProblem, rng: Stream) -> 'KinodynamicRRTSearch':
        """Return a search whose tree begins at the start of ``problem``, with a random stream."""
        return KinodynamicRRTSearch(problem, self.driving, rng)


@dataclass
class KinodynamicRRTSearch(DrivenSearch):
    """A running search by one tree; its vertices are the last states of transitions."""

    rejected: int = field(init=False, default=0)
    #: Position and weighted velocity (rows, 2 dim) of each vertex.
    _points: Floats = field(init=False)
    _tree: BoxTree = field(init=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        geometric, dim = self.problem.geometric, len(self.problem.geometric.goal)
        reach = np.full(dim, self.driving.velocity_weight * self.problem.system.max_speed)
        lower, upper = np.append(geometric.lower, -reach), np.append(geometric.upper, reach)
        self._points = np.empty((1, 2 * dim))
        self._tree = empty_box_tree(lower, upper, 1)
        _plant(self.problem, self.driving, self._steps, self._points, self._tree)

    @property
    def counts(self) -> dict[str, int]:
        """Numbers of integration steps tried and of uniform proposals outside the space."""
        return {**super().counts, 'rejected_proposals': self.rejected}

    def advance(self, n_iterations: int) -> None:
        """Make at most ``n_iterations`` further transitions; none once the search is solved."""
        if self.solved:
            return
        self._grow_arrays(n_iterations)
        self._points = with_capacity(self._points, len(self._steps.parents))
        if len(self._tree.following) < len(self._steps.parents):
            self._tree = grown(self._tree, len(self._steps.parents))
        self._n_rows, taken, n_steps, rejected, self.solved = _grow(
            self.problem,
            self.driving,
            self.rng,
            self._steps,
            self._points,
            self._tree,
            self._n_rows,
            n_iterations,
        )
        self.iterations += taken
        self.n_steps += n_steps
        self.rejected += rejected


@kernel
def _plant(problem, driving, steps, points, tree):
    """Insert the start into the tree as its first vertex."""
    _write_point(problem.system, driving.velocity_weight, steps.states[0], points[0])
    insert(tree, points, 0)


@kernel
def _grow(problem, driving, rng, steps, points, tree, n_rows, n_iterations):
    """
    Grow the tree by at most ``n_iterations`` transitions, in place.

    Returns (number of rows, transitions made, steps tried, rejected proposals, whether solved).
    """
    problem, rng, steps = borrowed(problem), borrowed(rng), borrowed(steps)
    points, tree = borrowed(points), borrowed(tree)
    geometric, iterations, n_steps, rejected = problem.geometric, 0, 0, 0
    dim = len(geometric.goal)
    target = np.empty(2 * dim)
    position, wanted = target[:dim], np.empty(dim)
    for _ in range(PROPOSALS_PER_ITERATION * n_iterations):
        if iterations == n_iterations:
            break
        draw_in_box(geometric.lower, geometric.upper, rng, position)
        if not contains(geometric.space, position):
            rejected += 1
            continue
        iterations += 1
        draw_in_ball(problem.system.max_speed, rng, wanted)
        for i in range(dim):
            target[dim + i] = driving.velocity_weight * wanted[i]
        parent, before = nearest(tree, points, target), n_rows
        n_rows, tried, reached = drive(problem, driving, steps, n_rows, parent, position, wanted)
        n_steps += tried
        if n_rows > before:
            last = n_rows - 1
            _write_point(problem.system, driving.velocity_weight, steps.states[last], points[last])
            insert(tree, points, last)
        if reached:
            return n_rows, iterations, n_steps, rejected, True
    return n_rows, iterations, n_steps, rejected, False


@kernel
def _write_point(system, weight, state, point):
    """Write to ``point`` (2 dim,) the position and the weighted velocity of a state."""
    dim = len(point) // 2
    velocity(system, state, point[dim:])
    for i in range(dim):
        point[i] = state[i]
        point[dim + i] *= weight
