"""
Trees of Hit-and-Run steps from start and goal, joined as soon as they see each other.

The paper's chain explores fast but wanders, and its path is the whole walk; it leaves hybrids with
short paths to the future. Here each end of the request grows a tree. A vertex at its frontier
takes a step like Hit-and-Run's that looks ahead: of a few uniform directions the one with the
longest free ray, and a uniform point on the outer part of that ray. Each new vertex looks for the
other tree among the vertices around it and at one anywhere.
"""

from dataclasses import dataclass, field
from typing import ClassVar, NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream, uniform
from hnr_planner.core.planning.planner import Problem, reaches_goal, with_room
from hnr_planner.core.planning.planners.frontier import (
    add_to_bin,
    choose_vertex,
    empty_frontier,
    Frontier,
)
from hnr_planner.core.planning.planners.two_trees import TwoTreeSearch
from hnr_planner.core.sampling.draws import draw_between, draw_direction
from hnr_planner.core.spaces.primitives import component, first_exit, segment_is_free
from hnr_planner.core.trees import NONE
import numpy as np
from numpy.typing import NDArray

#: Uniform directions that a step chooses from, and the part of the longest ray that it leaves
#: behind it at least: the best of 1 to 6 and of 0 to .9 on building maps and spirals.
RAYS = 4
INNER = 0.7


class Trees(NamedTuple):
    """
    Two trees in one table: tree 0 grows from the start, tree 1 from the goal.

    Attributes
    ----------
    vertices : (rows, dim)
        Vertices of both trees, oldest first.
    parents : (rows,) int64
        Row of each vertex's parent, NONE for the roots.
    members : (rows, 2) int64
        Rows of the vertices of each tree.
    sizes : (2,) int64
        Vertices of each tree.
    frontier : Frontier
        Where each tree should grow.
    directions : (2, dim)
        Room for a step to work in.

    """

    vertices: Floats
    parents: NDArray[np.int64]
    members: NDArray[np.int64]
    sizes: NDArray[np.int64]
    frontier: Frontier
    directions: Floats


@dataclass(frozen=True)
class HitAndRunConnect:
    """Trees of Hit-and-Run steps from both ends. It has no settings."""

    name: ClassVar[str] = 'hit_and_run_connect'

    def start(self, problem: Problem, rng: Stream) -> 'HitAndRunConnectSearch':
        """Start a tree at each end."""
        return HitAndRunConnectSearch(problem, rng)


@dataclass
class HitAndRunConnectSearch(TwoTreeSearch):
    """Two trees under way; a transition is one step of one of them, in turn."""

    _redraws: int = field(init=False, default=0)
    #: Planted with the first steps: one call of compiled code is worth two of Python's.
    _trees: Trees | None = field(init=False, default=None)
    _n_roots: int = field(init=False, default=0)

    @property
    def _table(self) -> tuple[Floats, NDArray[np.int64]]:
        if self._trees is None:
            return self.problem.start[np.newaxis], np.array([NONE])
        rows = self._n_roots + self.iterations
        return self._trees.vertices[:rows], self._trees.parents[:rows]

    @property
    def counts(self) -> dict[str, int]:
        """Draws that rounded onto the boundary and were drawn again."""
        return {'redraws': self._redraws}

    def advance(self, n_iterations: int) -> None:
        """Take at most ``n_iterations`` further steps."""
        if self.solved:
            return
        if self._trees is None:
            self._trees, self._n_roots, grown = _begin(self.problem, self.rng, n_iterations)
        else:
            rows = self._n_roots + self.iterations + n_iterations
            self._trees = _roomy(self._trees, rows)
            grown = _grow(self.problem, self._trees, self.rng, self.iterations, n_iterations)
        self._ends, taken, redraws = grown
        self.iterations += taken
        self._redraws += redraws


def _roomy(trees: Trees, rows: int) -> Trees:
    """Return the trees with room for so many rows at least."""
    if len(trees.parents) >= rows:
        return trees
    return trees._replace(
        vertices=with_room(trees.vertices, rows),
        parents=with_room(trees.parents, rows),
        members=with_room(trees.members, rows),
    )


@kernel
def _begin(problem, rng, n_iterations):
    """Plant the trees and take their first steps: (trees, roots, what ``_grow`` returns)."""
    trees, n_roots = _plant(problem, 2 + n_iterations)
    return trees, n_roots, _grow(problem, trees, rng, 0, n_iterations)


@kernel
def _plant(problem, rows):
    """Plant a root at the start, and one at a goal that it can reach: (trees, roots)."""
    trees = Trees(
        np.empty((rows, len(problem.start))),
        np.empty(rows, dtype=np.int64),
        np.empty((rows, 2), dtype=np.int64),
        np.zeros(2, dtype=np.int64),
        empty_frontier(problem.lower, problem.upper, problem.typical_clearance),
        np.empty((2, len(problem.start))),
    )
    trees.vertices[0] = problem.start
    _add(trees, 0, NONE)
    if component(problem.space, problem.goal) != component(problem.space, problem.start):
        return trees, 1
    trees.vertices[1] = problem.goal
    _add(trees, 1, NONE)
    return trees, 2


@kernel
def _grow(problem, trees, rng, turn, n_iterations):
    """Grow the trees in turn: ((row at the start's tree, row at the goal's), steps, redraws)."""
    problem, trees, rng = borrowed(problem), borrowed(trees), borrowed(rng)
    n_trees = 2 if trees.sizes[1] > 0 else 1
    redraws = 0
    for i in range(n_iterations):
        tree = (turn + i) % n_trees
        row = trees.sizes[0] + trees.sizes[1]
        parent = choose_vertex(trees.frontier, tree, rng)
        x, y = trees.vertices[parent], trees.vertices[row]
        redraws += _step(problem.space, x, rng, trees.directions, y)
        at = _add(trees, tree, parent)
        met = _meet(problem.space, trees, row, at, 1 - tree, rng)
        if met != NONE:
            return ((row, met) if tree == 0 else (met, row)), i + 1, redraws
        if tree == 0 and problem.goal_radius > 0.0 and reaches_goal(problem, y):
            return (row, NONE), i + 1, redraws
    return (NONE, NONE), n_iterations, redraws


@kernel
def _step(space, x, rng, directions, y):
    """Step along the longest of a few uniform rays, to a uniform point of its outer part."""
    u, best, longest = directions[0], directions[1], 0.0
    for _ in range(RAYS):
        draw_direction(rng, u)
        reach = first_exit(space, x, u, 0.0, np.inf)
        if reach > longest:
            longest = reach
            best[:] = u
    return draw_between(space, x, best, INNER * longest, longest, rng, y)


@kernel
def _add(trees, tree, parent):
    """Make the vertex written in the first free row one of a tree; return its bin."""
    row = trees.sizes[0] + trees.sizes[1]
    trees.parents[row] = parent
    trees.members[trees.sizes[tree], tree] = row
    trees.sizes[tree] += 1
    return add_to_bin(trees.frontier, tree, trees.vertices[row], row)


@kernel
def _meet(space, trees, row, at, other, rng):
    """Vertex of the other tree that is seen: the newest in a bin around, or one anywhere."""
    if trees.sizes[other] == 0:
        return NONE
    newest, columns = trees.frontier.newest, trees.frontier.columns
    for below in (-columns, 0, columns):
        for beside in (-1, 0, 1):
            k = newest[other, at + below + beside]
            if k != NONE and segment_is_free(space, trees.vertices[row], trees.vertices[k]):
                return k
    k = trees.members[int(trees.sizes[other] * uniform(rng)), other]
    return k if segment_is_free(space, trees.vertices[row], trees.vertices[k]) else NONE
