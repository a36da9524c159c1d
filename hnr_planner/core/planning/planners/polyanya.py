"""
Polyanya: the shortest path on a grid, exactly.

A search node is a cone of points visible from the start or from a corner. Cones are expanded as in
A*, in the order of a lower bound on the length of paths through them, as if there were no further
obstacles. So the first path to the goal that is taken from the open ones is the shortest of all,
and the least estimate of an open cone is a lower bound on the length of that path at any time.
Source: Cui, Harabor and Grastien, "Compromise-free pathfinding on a navigation mesh", IJCAI 2017,
here on the slabs of a grid.

With a goal region the path ends at the point of the region that is the nearest to the start along
free paths; points of the region that are nearer than the margin to an obstacle may be left out.
"""

from dataclasses import dataclass, field
import math
from typing import ClassVar

from hnr_planner.core.checks import Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.planning.planner import Problem
from hnr_planner.core.planning.planners.cone_expansion import begin, expand
from hnr_planner.core.planning.planners.cones import (
    FINAL,
    Frontier,
    N_NODES,
    N_VERTICES,
    NONE,
    PARENT,
    with_more_rows,
)
from hnr_planner.core.planning.planners.heap import N_OPEN
from hnr_planner.core.planning.planners.target import Target
from hnr_planner.core.planning.planners.taut_path import points_reached, taut_path
from hnr_planner.core.spaces.grid.grid_space import GridSpace
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import NDArray

#: Number of search nodes that fit in the arrays at first.
INITIAL_CAPACITY = 4096


@dataclass(frozen=True)
class Polyanya:
    """The planner of the exact shortest path on a grid; it draws nothing, whatever the seed."""

    name: ClassVar[str] = 'polyanya'

    def for_space(self, space: Space) -> 'PolyanyaInGrid':
        """Return the planner for ``space``, or raise RequestError where that is no GridSpace."""
        if not isinstance(space, GridSpace):
            raise RequestError(f'polyanya plans in a GridSpace, got a {type(space).__name__}')
        return PolyanyaInGrid(space)

    def start(self, problem: Problem, rng: Stream) -> 'PolyanyaSearch':
        """Raise RequestError: a search needs the slabs of a space (``for_space``)."""
        raise RequestError('Polyanya has no space yet: plan puts in that of its request')


@dataclass(frozen=True)
class PolyanyaInGrid(Polyanya):
    """
    The planner of the exact shortest path on one grid.

    Attributes
    ----------
    space : GridSpace
        The space whose slabs are searched.

    """

    space: GridSpace = field(repr=False)

    def start(self, problem: Problem, rng: Stream) -> 'PolyanyaSearch':
        """Return a search that begins at the problem's start; ``rng`` is not used."""
        return PolyanyaSearch(problem, self.space)


@dataclass
class PolyanyaSearch:
    """
    A running search of Polyanya; a transition is one expansion of a cone (``expand``).

    ``samples`` are the start, the corners at which shortest paths from the start bend, and points
    of a goal region that such paths reach. The slabs and the first cones are made by the first
    ``advance``: on a large grid, interpreted, that takes seconds, and only in ``advance`` can a
    limit interrupt the work.
    """

    problem: Problem
    space: GridSpace
    iterations: int = field(init=False, default=0)
    taut: ClassVar[bool] = True
    #: State and target of the search; None until the first ``advance``.
    _frontier: Frontier | None = field(init=False, default=None)
    _target: Target | None = field(init=False, default=None)
    #: The lower bound after the last expansions that were not interrupted.
    _bound: float | None = field(init=False, default=None)
    #: Least number of rows that the next expansions need.
    _rows: int = field(init=False, default=0)

    @property
    def solved(self) -> bool:
        """Whether the shortest path is found."""
        return self._frontier is not None and bool(self._frontier.sizes[FINAL] != NONE)

    @property
    def lower_bound(self) -> float:
        """
        Lower bound on the length of free paths from start to goal or region, kernel frame.

        It is the least length itself once the search is solved, and inf where no path exists.
        """
        if self._bound is None:
            problem = self.problem
            return max(math.dist(problem.start, problem.goal) - problem.goal_radius, 0.0)
        return self._bound

    @property
    def samples(self) -> Floats:
        """
        Start and points reached (k, 2), kernel frame, at the margin from their corners.

        A corner is there again where a shorter path to it was found later.
        """
        problem = self.problem
        if self._frontier is None:
            return problem.start[np.newaxis]
        steps = self.space.slabs.steps
        return points_reached(steps, self._vertices, problem.start, problem.margin)

    @property
    def parents(self) -> NDArray[np.int64]:
        """
        Index (k,) in ``samples`` of the point before each sample, -1 for the start.

        The point before a sample is the last bend of the shortest path found from the start to
        that sample.
        """
        if self._frontier is None:
            return np.array([NONE])
        return self._vertices[:, PARENT].astype(np.int64)

    @property
    def _vertices(self) -> Floats:
        """Vertices (k, 5) of the search (``Frontier``)."""
        if self._frontier is None:
            return np.empty((0, 5))
        return self._frontier.vertices[: self._frontier.sizes[N_VERTICES]]

    @property
    def counts(self) -> dict[str, int]:
        """Further counts by name: ``cones``, the number of search nodes made."""
        return {'cones': 0 if self._frontier is None else int(self._frontier.sizes[N_NODES])}

    @property
    def path(self) -> Floats:
        """Path (m, 2) of a solved search, kernel frame, at the margin from the corners passed."""
        last = NONE if self._frontier is None else int(self._frontier.sizes[FINAL])
        return taut_path(self.problem, self.space.slabs.steps, self._vertices, last)

    def advance(self, n_iterations: int) -> None:
        """Expand at most ``n_iterations`` cones, fewer once solved or when no cone is left."""
        slabs, problem = self.space.slabs, self.problem
        end, is_over = self.iterations + n_iterations, False
        while not is_over:
            left = end - self.iterations
            if self._frontier is None:
                ends = problem.start, problem.goal, problem.goal_radius
                self._frontier, self._target, expanded = begin(
                    slabs, *ends, problem.margin, INITIAL_CAPACITY, left
                )
            else:
                self._frontier = with_more_rows(self._frontier, self._rows)
                expanded = expand(slabs, self._frontier, self._target, left)
            self.iterations += expanded
            is_open = bool(self._frontier.sizes[N_OPEN] > 0)
            self._bound = float(self._frontier.estimates[0]) if is_open else math.inf
            is_over = self.solved or not is_open or self.iterations == end
            self._rows = len(self._frontier.nodes) + (0 if is_over else 1)
