"""
RRT-Connect (Kuffner and LaValle 2000): RRTs from both ends, each drawn to the other's new vertex.

In turn a tree is extended towards a uniform point of the space, and the nearest vertex of the
other tree towards the end of that extension, as far as it sees; they meet when it sees it all.
"""

from dataclasses import dataclass, field
from typing import ClassVar, NamedTuple

from hnr_planner.core.borrowed import borrowed
from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels import kernel
from hnr_planner.core.planning.nearest import BoxTree, empty_box_tree, grown, insert, nearest
from hnr_planner.core.planning.rrt import draw_in_box, extend, PROPOSALS_PER_ITERATION
from hnr_planner.core.planning.search import NONE, Problem, reaches_goal, with_room
from hnr_planner.core.planning.two_trees import TwoTreeSearch
from hnr_planner.core.spaces.primitives import component, contains, sees
from hnr_planner.core.streams import Stream
import numpy as np
from numpy.typing import NDArray


class Trees(NamedTuple):
    """
    Two trees in one table: tree 0 grows from the start, tree 1 from the goal.

    Attributes
    ----------
    vertices : (rows, dim)
        Vertices of both trees, oldest first.
    parents : (rows,) int64
        Row of each vertex's parent, NONE for the roots.
    size : (1,) int64
        Rows in use.
    boxes : two BoxTree
        The vertices of each tree, to find the nearest.

    """

    vertices: Floats
    parents: NDArray[np.int64]
    size: NDArray[np.int64]
    boxes: tuple[BoxTree, BoxTree]


@dataclass(frozen=True)
class RRTConnect:
    """RRT-Connect without a limit on the length of an extension. It has no settings."""

    name: ClassVar[str] = 'rrt_connect'

    def start(self, problem: Problem, rng: Stream) -> 'RRTConnectSearch':
        """Start a tree at each end."""
        return RRTConnectSearch(problem, rng)


@dataclass
class RRTConnectSearch(TwoTreeSearch):
    """Two trees under way; a transition is one proposal inside the space and what it leads to."""

    _rejected: int = field(init=False, default=0)
    _trees: Trees = field(init=False)
    _n_trees: int = field(init=False)

    def __post_init__(self) -> None:
        problem = self.problem
        first, second = (empty_box_tree(problem.lower, problem.upper, 2) for _ in range(2))
        self._trees = Trees(
            vertices=np.stack([problem.start, problem.goal]),
            parents=np.full(2, NONE),
            size=np.zeros(1, dtype=np.int64),
            boxes=(first, second),
        )
        self._n_trees = _plant(problem, self._trees)

    @property
    def _table(self) -> tuple[Floats, NDArray[np.int64]]:
        rows = int(self._trees.size[0])
        return self._trees.vertices[:rows], self._trees.parents[:rows]

    @property
    def counts(self) -> dict[str, int]:
        """Uniform proposals that fell outside the space."""
        return {'rejected_proposals': self._rejected}

    def advance(self, n_iterations: int) -> None:
        """Handle at most ``n_iterations`` further proposals inside the space."""
        if self.solved:
            return
        # A proposal adds a vertex to each tree at most.
        self._make_room(len(self.samples) + 2 * n_iterations)
        self._ends, handled, rejected = _grow(
            self.problem, self._trees, self._n_trees, self.rng, self.iterations, n_iterations
        )
        self.iterations += handled
        self._rejected += rejected

    def _make_room(self, rows: int) -> None:
        trees = self._trees
        if len(trees.vertices) >= rows:
            return
        vertices = with_room(trees.vertices, rows)
        first, second = (grown(boxes, len(vertices)) for boxes in trees.boxes)
        self._trees = trees._replace(
            vertices=vertices,
            parents=with_room(trees.parents, len(vertices)),
            boxes=(first, second),
        )


@kernel
def _plant(problem, trees):
    """Plant a root at the start, and one at a goal that it can reach; return how many."""
    _add(trees, 0, NONE)
    if component(problem.space, problem.goal) != component(problem.space, problem.start):
        return 1
    _add(trees, 1, NONE)
    return 2


@kernel
def _grow(problem, trees, n_trees, rng, turn, n_iterations):
    """Grow the trees in turn: (the ends that met, proposals handled, proposals rejected)."""
    problem, trees, rng = borrowed(problem), borrowed(trees), borrowed(rng)
    proposal, handled, rejected = np.empty(len(problem.start)), 0, 0
    for _ in range(PROPOSALS_PER_ITERATION * n_iterations):
        if handled == n_iterations:
            break
        draw_in_box(problem.lower, problem.upper, rng, proposal)
        if not contains(problem.space, proposal):
            rejected += 1
            continue
        tree = (turn + handled) % n_trees
        handled += 1
        row = _extend_nearest(problem, trees, tree, proposal)
        if row == NONE:
            continue
        if tree == 0 and problem.goal_radius > 0.0 and reaches_goal(problem, trees.vertices[row]):
            return (row, NONE), handled, rejected
        if n_trees == 2:
            met = _connect(problem, trees, 1 - tree, row)
            if met != NONE:
                return ((row, met) if tree == 0 else (met, row)), handled, rejected
    return (NONE, NONE), handled, rejected


@kernel
def _connect(problem, trees, tree, target):
    """Draw a tree to a vertex of the other: the vertex that sees it, or NONE."""
    near = nearest(trees.boxes[tree], trees.vertices, trees.vertices[target])
    if sees(problem.space, trees.vertices[near], trees.vertices[target]):
        return near
    _extend_nearest(problem, trees, tree, trees.vertices[target])
    return NONE


@kernel
def _extend_nearest(problem, trees, tree, proposal):
    """Extend the nearest vertex of a tree towards a point: the new row, or NONE."""
    row = trees.size[0]
    parent = nearest(trees.boxes[tree], trees.vertices, proposal)
    if not extend(problem, np.inf, trees.vertices[parent], proposal, trees.vertices[row]):
        return NONE
    _add(trees, tree, parent)
    return row


@kernel
def _add(trees, tree, parent):
    """Make the vertex written in the first free row one of a tree."""
    row = trees.size[0]
    trees.parents[row] = parent
    insert(trees.boxes[tree], trees.vertices, row)
    trees.size[0] += 1
