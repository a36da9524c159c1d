"""
RRT (paper, Section 1; LaValle 1998): a tree that grows towards uniform points of the space.

A proposal is uniform in the space; the nearest vertex of the tree is extended towards it, to the
proposal itself or to the farthest point visible from the vertex, and at most ``max_step`` far.
"""

from dataclasses import dataclass, field
import math
from typing import ClassVar

from hnr_planner.core.checks import check_positive, Floats
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream, uniform
from hnr_planner.core.lengths import norm
from hnr_planner.core.planning.planner import Problem, reaches_goal, to_goal, with_capacity
from hnr_planner.core.planning.planners.nearest import (
    BoxTree,
    empty_box_tree,
    grown,
    insert,
    nearest,
)
from hnr_planner.core.spaces.primitives import contains, contains_around, first_exit
from hnr_planner.core.trees import branch
import numpy as np
from numpy.typing import NDArray

#: Largest number of proposals for each transition: most of the box may lie outside the space, and
#: a search whose proposals are all rejected has to return so that it can be stopped.
PROPOSALS_PER_ITERATION = 64


@dataclass(frozen=True)
class RRT:
    """
    The paper's planner RRT: one tree from the start.

    Attributes
    ----------
    max_step : float
        Length of the longest extension [m], above 0. Without a limit (inf) the planner is the
        paper's first version; with small steps it is the paper's version for dynamic constraints.

    """

    max_step: float = math.inf
    name: ClassVar[str] = 'rrt'

    def __post_init__(self) -> None:
        object.__setattr__(self, 'max_step', check_positive('max_step', self.max_step))

    def start(self, problem: Problem, rng: Stream) -> 'RRTSearch':
        """Return a search whose tree begins at the problem's start."""
        return RRTSearch(problem, rng, self.max_step / problem.scale)


@dataclass
class RRTSearch:
    """Search by one tree; a transition is one proposal inside the space and its extension."""

    problem: Problem
    rng: Stream
    max_step: float
    solved: bool = field(init=False, default=False)
    taut: ClassVar[bool] = False
    iterations: int = field(init=False, default=0)
    rejected: int = field(init=False, default=0)
    _n_vertices: int = field(init=False, default=1)
    _vertices: Floats = field(init=False)
    _parents: NDArray[np.int64] = field(init=False)
    _tree: BoxTree = field(init=False)

    def __post_init__(self) -> None:
        self._vertices = self.problem.start[np.newaxis].copy()
        self._parents = np.array([-1])
        self._tree = empty_box_tree(self.problem.lower, self.problem.upper, 1)
        insert(self._tree, self._vertices, 0)

    @property
    def samples(self) -> Floats:
        """The vertices (k, dim) of the tree, kernel frame, oldest first."""
        return self._vertices[: self._n_vertices]

    @property
    def parents(self) -> NDArray[np.int64]:
        """Index (k,) of the vertex from which each vertex was extended; -1 for the start."""
        return self._parents[: self._n_vertices]

    @property
    def path(self) -> Floats:
        """Path (m, dim) of a solved search: to the newest vertex, then an exact goal."""
        last = self._n_vertices - 1
        return to_goal(self.problem, branch(self._vertices, self._parents, last))

    @property
    def counts(self) -> dict[str, int]:
        """Further counts by name: ``rejected_proposals``, those that fell outside the space."""
        return {'rejected_proposals': self.rejected}

    def advance(self, n_iterations: int) -> None:
        """Handle at most ``n_iterations`` proposals inside the space, fewer once solved."""
        if self.solved:
            return
        self._grow_arrays(self._n_vertices + n_iterations)
        self._n_vertices, iterations, rejected, self.solved = _grow(
            self.problem,
            self.max_step,
            self.rng,
            self._vertices,
            self._parents,
            self._n_vertices,
            self._tree,
            n_iterations,
        )
        self.iterations += iterations
        self.rejected += rejected

    def _grow_arrays(self, rows: int) -> None:
        self._vertices = with_capacity(self._vertices, rows)
        self._parents = with_capacity(self._parents, rows)
        if len(self._tree.following) < rows:
            self._tree = grown(self._tree, len(self._vertices))


@kernel
def _grow(problem, max_step, rng, vertices, parents, n_vertices, tree, n_iterations):
    """
    Grow the tree; return numbers of vertices, transitions and rejected proposals, and if solved.

    It ends after ``n_iterations`` transitions, after ``PROPOSALS_PER_ITERATION`` times as many
    proposals, or when a new vertex reaches the goal.
    """
    problem, rng, tree = borrowed(problem), borrowed(rng), borrowed(tree)
    vertices, parents = borrowed(vertices), borrowed(parents)
    proposal, iterations, rejected = np.empty(len(problem.start)), 0, 0
    for _ in range(PROPOSALS_PER_ITERATION * n_iterations):
        if iterations == n_iterations:
            break
        draw_in_box(problem.lower, problem.upper, rng, proposal)
        if not contains(problem.space, proposal):
            rejected += 1
            continue
        iterations += 1
        parent = nearest(tree, vertices, proposal)
        if extend(problem, max_step, vertices[parent], proposal, vertices[n_vertices]):
            parents[n_vertices] = parent
            insert(tree, vertices, n_vertices)
            n_vertices += 1
            if reaches_goal(problem, vertices[n_vertices - 1]):
                return n_vertices, iterations, rejected, True
    return n_vertices, iterations, rejected, False


@kernel
def draw_in_box(lower, upper, rng, x):
    """Write a uniform point of the box from ``lower`` to ``upper`` (dim,) to ``x`` (dim,)."""
    for i in range(len(x)):
        x[i] = lower[i] + (upper[i] - lower[i]) * uniform(rng)


@kernel
def extend(problem, max_step, vertex, proposal, end):
    """
    Write the ``end`` (dim,) of an extension of ``vertex`` (dim,) towards ``proposal`` (dim,).

    Returns False where the extension is not longer than the margin; then it is not to be used.
    """
    u = proposal - vertex
    length = norm(u)
    if length <= problem.margin:
        return False
    reach = first_exit(problem.space, vertex, u, 0.0, 1.0)
    # The proposal where it is visible from the vertex, or else the farthest visible point.
    s = 1.0 if reach > 1.0 else reach - problem.margin / length
    s = min(s, max_step / length)
    # A wall met at a grazing angle is nearer than the margin along the ray: go back a little more.
    back = problem.margin / length
    while s * length > problem.margin:
        for i in range(len(u)):
            end[i] = proposal[i] if s == 1.0 else vertex[i] + s * u[i]
        if contains_around(problem.space, end, problem.margin / 8.0):
            return True
        s -= back
        back *= 10.0
    return False
