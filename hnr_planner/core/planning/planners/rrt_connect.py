"""
RRT-Connect (Kuffner and LaValle 2000): RRTs from both ends, extended towards each other.

The trees are extended alternately towards a uniform point of the box around the space, by one step
from the vertex nearest to it. When that step is free, the other tree takes step after step towards
the new vertex, and the trees are connected when a step reaches it. A step that is not free adds
nothing. As in OMPL, a step is at most a fifth of the box's diagonal.
"""

from dataclasses import dataclass, field
import math
from typing import ClassVar, NamedTuple

from hnr_planner.core.checks import check_positive
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.copies import copy_into
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.lengths import norm
from hnr_planner.core.planning.planner import Problem, reaches_goal
from hnr_planner.core.planning.planners.nearest import (
    BoxTree,
    empty_box_tree,
    grown,
    insert,
    nearest,
)
from hnr_planner.core.planning.planners.rrt import draw_in_box
from hnr_planner.core.planning.planners.two_trees import (
    add_vertex,
    empty_trees,
    first_free_row,
    TreePair,
    TwoTreeSearch,
    with_rows,
)
from hnr_planner.core.spaces.primitives import component, segment_is_free
from hnr_planner.core.trees import NONE
import numpy as np
from numpy.typing import NDArray

#: Longest step when none is given, as a fraction of the box's diagonal.
STEP = 0.2
#: Rows that the arrays hold at first.
INITIAL_CAPACITY = 64
#: Outcomes of a step: it is not free, it is free, or it is free and arrives.
TRAPPED, ADVANCED, REACHED = 0, 1, 2


class BoxTrees(NamedTuple):
    """
    Two trees, with an index of nearest vertices and the state of the next step.

    Attributes
    ----------
    table : TreePair
        Vertices of both trees, kernel frame.
    boxes : BoxTree
        Index that finds the nearest vertex: root 0 holds the vertices of the tree at the start,
        root 1 those of the tree at the goal.
    turn : (1,) int64
        Number of the tree that is extended next: 0 for the tree at the start, 1 for the goal's.
    drawn : (2,) int64
        Rows in ``table`` of the vertex to step from and of the other tree's vertex to step
        towards. Both are NONE (-1) where the next step goes towards a uniform point instead, from
        the vertex nearest to that point.

    """

    table: TreePair
    boxes: BoxTree
    turn: NDArray[np.int64]
    drawn: NDArray[np.int64]


@dataclass(frozen=True)
class RRTConnect:
    """
    The planner RRT-Connect: a tree from each end, each extended towards the other.

    Attributes
    ----------
    max_step : float, optional
        Length of the longest step [m], above 0; a fifth of the diagonal of the box around the
        space when left out, inf for no limit.

    """

    max_step: float | None = None
    name: ClassVar[str] = 'rrt_connect'

    def __post_init__(self) -> None:
        if self.max_step is not None:
            object.__setattr__(self, 'max_step', check_positive('max_step', self.max_step))

    def start(self, problem: Problem, rng: Stream) -> 'RRTConnectSearch':
        """Return a search whose trees begin at the problem's start and at its goal."""
        if self.max_step is None:
            max_step = STEP * norm(problem.upper - problem.lower)
        else:
            max_step = self.max_step / problem.scale
        return RRTConnectSearch(problem, rng, max_step)


@dataclass
class RRTConnectSearch(TwoTreeSearch):
    """Search with two trees; a transition is one step of one tree, free or not."""

    max_step: float
    _trees: BoxTrees = field(init=False)

    def __post_init__(self) -> None:
        problem = self.problem
        self._trees = BoxTrees(
            table=empty_trees(INITIAL_CAPACITY, len(problem.start)),
            boxes=empty_box_tree(problem.lower, problem.upper, INITIAL_CAPACITY, n_roots=2),
            turn=np.zeros(1, dtype=np.int64),
            drawn=np.full(2, NONE),
        )
        _plant(problem, self._trees)

    @property
    def _table(self) -> TreePair:
        return self._trees.table

    @property
    def counts(self) -> dict[str, int]:
        """Further counts by name: an empty dict, since RRT-Connect has none."""
        return {}

    def advance(self, n_iterations: int) -> None:
        """Take ``n_iterations`` further steps, or fewer where the search is solved before."""
        goal = self.iterations + n_iterations
        while not self.solved:
            # Most steps are blocked, so the arrays hold fewer vertices than there are steps.
            self._ends, taken = _grow(
                self.problem,
                self.max_step,
                self._trees,
                self.rng,
                goal - self.iterations,
            )
            self.iterations += taken
            if self.iterations == goal:
                break
            self._grow_arrays()

    def _grow_arrays(self) -> None:
        trees = self._trees
        table = with_rows(trees.table, len(trees.table.parents) + 1)
        boxes = grown(trees.boxes, len(table.parents))
        self._trees = trees._replace(table=table, boxes=boxes)


@kernel
def _plant(problem, trees):
    """
    Add a root at the start and, where the goal lies in the component of the start, at the goal.

    A component is a connected part of free space.
    """
    copy_into(trees.table.vertices[0], problem.start)
    _add(trees, 0, NONE)
    if component(problem.space, problem.goal) == component(problem.space, problem.start):
        copy_into(trees.table.vertices[1], problem.goal)
        _add(trees, 1, NONE)


@kernel
def _grow(problem, max_step, trees, rng, n_iterations):
    """
    Take at most ``n_iterations`` steps; return (rows that solve the search, steps taken).

    The rows are those of the two vertices that connect the trees, the start's tree first, or
    (row, NONE) for a vertex in the goal region; (NONE, NONE) while the search is not solved. The
    steps also end when the arrays of the trees are full.
    """
    problem, trees, rng = borrowed(problem), borrowed(trees), borrowed(rng)
    towards, vertices, drawn = np.empty(len(problem.start)), trees.table.vertices, trees.drawn
    n_trees = 2 if trees.table.sizes[1] > 0 else 1
    for i in range(n_iterations):
        end = first_free_row(trees.table)
        if end == len(vertices):
            return (NONE, NONE), i
        tree, near, target = trees.turn[0], drawn[0], drawn[1]
        if target == NONE:
            draw_in_box(problem.lower, problem.upper, rng, towards)
            near = nearest(trees.boxes, vertices, towards, tree)
            trees.turn[0] = (tree + 1) % n_trees
        else:
            copy_into(towards, vertices[target])
        outcome = _step(problem, max_step, vertices[near], towards, vertices[end])
        if outcome == REACHED and target != NONE:
            return ((near, target) if tree == 0 else (target, near)), i + 1
        if outcome == TRAPPED:
            drawn[0], drawn[1] = NONE, NONE
            continue
        row = _add(trees, tree, near)
        if tree == 0 and problem.goal_radius > 0.0 and reaches_goal(problem, vertices[row]):
            return (row, NONE), i + 1
        if target != NONE:
            # The new vertex is nearer to the target than all others: the next step begins there.
            drawn[0] = row
        elif n_trees == 2:
            drawn[0], drawn[1] = nearest(trees.boxes, vertices, vertices[row], 1 - tree), row
    return (NONE, NONE), n_iterations


@kernel
def _step(problem, max_step, vertex, target, end):
    """
    Write the ``end`` of a step from a vertex towards a point (dim,); return the step's outcome.

    The outcome is REACHED where the step ends at ``target``, ADVANCED where ``max_step`` ends it
    before, and TRAPPED where it is not free or ``target`` is within the margin of the vertex.
    """
    squared = 0.0
    for i in range(len(end)):
        squared += (target[i] - vertex[i]) ** 2
    length = math.sqrt(squared)
    if length <= problem.margin:
        return TRAPPED
    reached = length <= max_step
    for i in range(len(end)):
        end[i] = target[i] if reached else vertex[i] + max_step / length * (target[i] - vertex[i])
    if not segment_is_free(problem.space, vertex, end):
        return TRAPPED
    return REACHED if reached else ADVANCED


@kernel
def _add(trees, tree, parent):
    """Add the vertex in the first free row to a tree, below row ``parent``; return its row."""
    row = add_vertex(trees.table, tree, parent)
    insert(trees.boxes, trees.table.vertices, row, tree)
    return row
