"""
Polyanya: the shortest path on a grid, exactly.

A search node is a cone of points visible from the start or from a corner. Cones are expanded as in
A*, in the order of a lower bound on the length of paths through them, as if there were no further
obstacles. So the first path to the goal that is taken from the open ones is the shortest of all,
and the least estimate of an open cone is a lower bound on the length of that path at any time.
Source: Cui, Harabor and Grastien, "Compromise-free pathfinding on a navigation mesh", IJCAI 2017,
here on the slabs of a grid.

With a goal region it ends at the point
of the region that is the nearest to the start along free paths; points of the region that are
nearer than the margin to an obstacle may be left out.
"""

from dataclasses import dataclass, field
import math
from typing import ClassVar

from hnr_planner.core.checks import Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.planning.planner import Problem
from hnr_planner.core.planning.planners.cone_expansion import expand
from hnr_planner.core.planning.planners.cones import (
    CORNER,
    DISTANCE,
    empty_frontier,
    FINAL,
    Frontier,
    N_NODES,
    N_OPEN,
    N_VERTICES,
    NONE,
    open_frontier,
    PARENT,
    rows_at_once,
    with_more_rows,
)
from hnr_planner.core.planning.planners.target import make_target, Target
from hnr_planner.core.planning.planners.taut_path import taut_path
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
    _frontier: Frontier = field(init=False)
    _target: Target | None = field(init=False, default=None)

    def __post_init__(self) -> None:
        self._frontier = empty_frontier(0, 0, 1, 1)
        self._frontier.vertices[0] = *self.problem.start, 0.0, NONE, NONE
        self._frontier.sizes[N_VERTICES] = 1

    @property
    def solved(self) -> bool:
        """Whether the shortest path is found."""
        return bool(self._frontier.sizes[FINAL] != NONE)

    @property
    def lower_bound(self) -> float:
        """
        Lower bound on the length of free paths from start to goal or region, kernel frame.

        It is the least length itself once the search is solved, and inf where no path exists.
        """
        if self._target is None:
            problem = self.problem
            return max(math.dist(problem.start, problem.goal) - problem.goal_radius, 0.0)
        if self._frontier.sizes[N_OPEN] == 0:
            return math.inf
        return float(self._frontier.estimates[0])

    @property
    def samples(self) -> Floats:
        """
        Start and points reached (k, 2), kernel frame, at the margin from their corners.

        A corner is there again where a shorter path to it was found later.
        """
        vertices = self._frontier.vertices[: self._frontier.sizes[N_VERTICES]]
        points, corners = vertices[:, :DISTANCE].copy(), vertices[:, CORNER].astype(np.int64)
        at_corners = np.flatnonzero(corners != NONE)
        if len(at_corners) > 0:  # there are slabs by then, which take time to make
            steps = self.space.slabs.steps.reshape(-1, 2)[corners[at_corners]]
            points[at_corners] += self.problem.margin * steps
        points[0] = self.problem.start
        return points

    @property
    def parents(self) -> NDArray[np.int64]:
        """
        Index (k,) in ``samples`` of the point before each sample, -1 for the start.

        The point before a sample is the last bend of the shortest path found from the start to
        that sample.
        """
        rows = self._frontier.vertices[: self._frontier.sizes[N_VERTICES], PARENT]
        return rows.astype(np.int64)

    @property
    def counts(self) -> dict[str, int]:
        """Further counts by name: ``cones``, the number of search nodes made."""
        return {'cones': int(self._frontier.sizes[N_NODES])}

    @property
    def path(self) -> Floats:
        """Path (m, 2) of a solved search, kernel frame, at the margin from the corners passed."""
        return taut_path(self.problem, self.space.slabs, self._frontier)

    def advance(self, n_iterations: int) -> None:
        """Expand at most ``n_iterations`` cones, fewer once solved or when no cone is left."""
        if self._target is None:
            self._target = self._open()
        end = self.iterations + n_iterations
        while self.iterations < end and not self.solved:
            left = end - self.iterations
            self.iterations += expand(self.space.slabs, self._frontier, self._target, left)
            exhausted = self._frontier.sizes[N_OPEN] == 0
            if self.solved or exhausted or self.iterations == end:
                break
            self._frontier = with_more_rows(self._frontier, len(self._frontier.nodes) + 1)

    def _open(self) -> Target:
        """Make the first cones; return the target of the search."""
        slabs, problem = self.space.slabs, self.problem
        target = make_target(slabs, problem.goal, problem.goal_radius, problem.margin)
        sizes = len(slabs.portals), len(slabs.boxes), rows_at_once(slabs)
        frontier = empty_frontier(*sizes, INITIAL_CAPACITY)
        open_frontier(slabs, frontier, problem.start, target)
        self._frontier = frontier  # only now: a limit may interrupt the lines above
        return target
