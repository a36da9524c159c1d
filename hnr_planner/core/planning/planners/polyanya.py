"""
Polyanya: the shortest path on a grid, exactly.

Cones that start and corners see are expanded in the order of the shortest way through them that
the straight line to the goal allows, as A* does, so the first way into the goal's slab that comes
up is the shortest of all, and the least estimate of an open cone is a lower bound at any time.
Source: Cui, Harabor and Grastien, "Compromise-free pathfinding on a navigation mesh", IJCAI 2017,
here on the slabs of a grid.

Free space is open, so the shortest path is a limit: its bends are corners of obstacles. The path
that is returned passes each corner at the space's margin.
"""

from dataclasses import dataclass, field, replace
import math
from typing import ClassVar

from hnr_planner.core.checks import Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.copies import copy_into
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.lengths import distance
from hnr_planner.core.planning.planner import Problem, with_room
from hnr_planner.core.planning.planners.cones import (
    CORNER,
    DISTANCE,
    expand,
    FINAL,
    Frontier,
    N_NODES,
    N_OPEN,
    N_VERTICES,
    NONE,
    open_frontier,
    PARENT,
    room_at,
)
from hnr_planner.core.spaces.grid.slabs import OFF_LINE, slab_at, Slabs
from hnr_planner.core.spaces.primitives import first_exit
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.trees import rows_to
import numpy as np
from numpy.typing import NDArray

#: Nodes that there is room for at first.
ROOM = 4096
#: Corners that the segments of a path may graze, for each vertex.
GRAZED_MAX = 64


@dataclass(frozen=True)
class Polyanya:
    """
    The shortest path, exactly. It draws nothing, so its seed has no effect.

    Attributes
    ----------
    slabs : Slabs, optional
        Free space of the grid; ``for_space`` puts in those of a space.

    """

    slabs: Slabs | None = field(default=None, repr=False)
    name: ClassVar[str] = 'polyanya'

    def for_space(self, space: Space) -> 'Polyanya':
        """Return the planner for a space, or raise RequestError where that has no slabs."""
        if space.slabs is None:
            raise RequestError(f'polyanya plans in a GridSpace, got a {type(space).__name__}')
        return replace(self, slabs=space.slabs)

    def start(self, problem: Problem, rng: Stream) -> 'PolyanyaSearch':
        """Start at the problem's start; RequestError for a planner without slabs."""
        if self.slabs is None:
            raise RequestError('Polyanya has no slabs yet: plan puts in those of its space')
        return PolyanyaSearch(problem, self.slabs)


@dataclass
class PolyanyaSearch:
    """
    A search under way; a transition is one expansion.

    ``samples`` are the start and the corners at which shortest ways from it bend.
    """

    problem: Problem
    slabs: Slabs
    iterations: int = field(init=False, default=0)
    taut: ClassVar[bool] = True
    _start: Floats = field(init=False)
    _goal: Floats = field(init=False)
    _frontier: Frontier = field(init=False)

    def __post_init__(self) -> None:
        self._start, self._goal = _off_lines(self.problem.start), _off_lines(self.problem.goal)
        room = max(ROOM, room_at(self.slabs, self._start))
        self._frontier = open_frontier(self.slabs, self._start, self._goal, room)

    @property
    def solved(self) -> bool:
        """Whether the shortest path is found."""
        return bool(self._frontier.sizes[FINAL] != NONE)

    @property
    def lower_bound(self) -> float:
        """Length that no path can fall below, kernel frame; that of the shortest when solved."""
        if self._frontier.sizes[N_OPEN] == 0:
            return math.inf
        return float(self._frontier.estimates[0])

    @property
    def samples(self) -> Floats:
        """Start and corners reached (k, 2)."""
        return self._frontier.vertices[: self._frontier.sizes[N_VERTICES], :DISTANCE]

    @property
    def parents(self) -> NDArray[np.int64]:
        """Index (k,) of the corner before each on the shortest way known; -1 for the start."""
        rows = self._frontier.vertices[: self._frontier.sizes[N_VERTICES], PARENT]
        return rows.astype(np.int64)

    @property
    def counts(self) -> dict[str, int]:
        """Cones opened."""
        return {'cones': int(self._frontier.sizes[N_NODES])}

    @property
    def path(self) -> Floats:
        """Path (m, 2) of a solved search, at the margin from the corners that it passes."""
        frontier, problem = self._frontier, self.problem
        rows = rows_to(self.parents, int(frontier.sizes[FINAL]))
        corners = frontier.vertices[rows[1:], CORNER].astype(np.int64)
        steps = self.slabs.steps.reshape(-1, 2)[corners]
        bends = frontier.vertices[rows[1:], :DISTANCE] + problem.margin * steps
        points = np.vstack([problem.start, bends, problem.goal])
        return step_aside(problem.space, points, problem.margin)

    def advance(self, n_iterations: int) -> None:
        """Expand at most ``n_iterations`` cones, fewer once solved or when all are expanded."""
        goal_slab = slab_at(self.slabs, *self._goal)
        end = self.iterations + n_iterations
        while self.iterations < end and not self.solved:
            before = self.iterations
            self.iterations += expand(
                self.slabs, self._frontier, self._goal, goal_slab, end - before
            )
            exhausted = self._frontier.sizes[N_OPEN] == 0
            if self.solved or exhausted or self.iterations == end:
                break
            self._make_room()

    def _make_room(self) -> None:
        frontier = self._frontier
        rows = len(frontier.nodes) + 1
        self._frontier = frontier._replace(
            nodes=with_room(frontier.nodes, rows),
            vertices=with_room(frontier.vertices, rows),
            estimates=with_room(frontier.estimates, rows),
            heap=with_room(frontier.heap, rows),
        )


def _off_lines(point: Floats) -> Floats:
    """Return a free point (2,), moved up by a hair where it lies on a line between two rows."""
    x, y = point.tolist()
    return np.array([x, y + OFF_LINE if y == math.floor(y) else y])


@kernel
def step_aside(space, points, margin):
    """
    Return a path (m, 2) that passes every corner at the margin.

    Where a segment is blocked, it grazes a corner, or would without its vertices having stepped
    aside: the path bends there as well.
    """
    aside = np.empty((GRAZED_MAX * len(points), 2))
    copy_into(aside[0], points[0])
    n, k = 1, 1
    pending = np.empty((GRAZED_MAX * len(points), 2))
    n_pending = 0
    while k < len(points) or n_pending > 0:
        end = pending[n_pending - 1] if n_pending > 0 else points[k]
        a = aside[n - 1]
        u = end - a
        t = first_exit(space, a, u, 0.0, 1.0) if u.any() else 2.0
        if t <= 1.0 and n + n_pending + 2 < len(aside):
            corner = np.round(a + t * u)
            step = _step_from(space.free_distance, int(corner[0]), int(corner[1]))
            bend = corner + margin * step
            if step.any() and distance(bend, a) > 0.0 and distance(bend, end) > 0.0:
                copy_into(pending[n_pending], bend)
                n_pending += 1
                continue
        copy_into(aside[n], end)
        n += 1
        if n_pending > 0:
            n_pending -= 1
        else:
            k += 1
    return aside[:n].copy()


@kernel
def _step_from(free_distance, x, y):
    """Return the direction away from the one blocked cell at a corner; (0, 0) if not one."""
    step, n_blocked = np.zeros(2), 0
    for row, up in ((y - 1, 1.0), (y, -1.0)):
        for column, right in ((x - 1, 1.0), (x, -1.0)):
            if free_distance[row, column] == 0:
                step[0], step[1] = right, up
                n_blocked += 1
    if n_blocked != 1:
        step[0], step[1] = 0.0, 0.0
    return step
