"""
Searches with a tree at each end: a table of both trees, and the path through both.

Row 0 is the root of the start's tree; the goal's, where there is one, follows. A search is solved
when a vertex of one tree is connected to one of the other, or when the only tree has a vertex in
the goal region.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import ClassVar, NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.copies import copy_rows
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.planning.planner import Problem, to_goal, with_capacity
from hnr_planner.core.trees import branch, NONE
import numpy as np
from numpy.typing import NDArray


class TreePair(NamedTuple):
    """
    Two trees in one table: tree 0 grows from the start, tree 1 from the goal.

    Attributes
    ----------
    vertices : (rows, dim)
        Vertices of both trees, kernel frame, oldest first.
    parents : (rows,) int64
        Row of each vertex's parent; NONE (-1) for the roots.
    sizes : (2,) int64
        Number of vertices of each tree.

    """

    vertices: Floats
    parents: NDArray[np.int64]
    sizes: NDArray[np.int64]


@kernel
def empty_trees(rows, dim):
    """Return two trees without vertices, with a common capacity of ``rows`` points (dim,)."""
    vertices, parents = np.empty((rows, dim)), np.empty(rows, dtype=np.int64)
    return TreePair(vertices, parents, np.zeros(2, dtype=np.int64))


@kernel
def first_free_row(trees):
    """Return the row in which the next vertex is written."""
    return trees.sizes[0] + trees.sizes[1]


@kernel
def add_vertex(trees, tree, parent):
    """
    Add the vertex in the first free row to a tree, as a child of row ``parent``; return its row.

    The vertex itself has to be written to that row by the caller.
    """
    row = first_free_row(trees)
    trees.parents[row] = parent
    trees.sizes[tree] += 1
    return row


def with_rows(trees: TreePair, rows: int) -> TreePair:
    """Return the trees with a common capacity of at least ``rows`` vertices."""
    if len(trees.parents) >= rows:
        return trees
    vertices = with_capacity(trees.vertices, rows)
    return trees._replace(vertices=vertices, parents=with_capacity(trees.parents, len(vertices)))


@dataclass
class TwoTreeSearch(ABC):
    """
    Base class of searches with a tree at the start and a tree at the goal.

    There is no second tree where the centre of a goal region cannot be reached from the start:
    then the tree of the start has to enter the region.

    Attributes
    ----------
    problem : Problem
        The problem to solve, kernel frame.
    rng : Stream
        Random stream of every draw.
    iterations : int
        Number of transitions handled.

    """

    problem: Problem
    rng: Stream
    iterations: int = field(init=False, default=0)
    taut: ClassVar[bool] = False
    #: Rows of the two vertices that connect the trees, the start's tree first; (k, NONE) for a
    #: vertex k in the goal region; (NONE, NONE) while the search is not solved.
    _ends: tuple[int, int] = field(init=False, default=(NONE, NONE))

    @property
    @abstractmethod
    def _table(self) -> TreePair | None:
        """Return the trees; None before the first step."""

    @property
    def solved(self) -> bool:
        """Whether the trees are connected, or the start's tree has a vertex in the goal region."""
        return self._ends[0] != NONE

    @property
    def samples(self) -> Floats:
        """The vertices (k, dim) of both trees, kernel frame, oldest first."""
        trees = self._table
        if trees is None:
            return self.problem.start[np.newaxis]
        return trees.vertices[: sum(trees.sizes.tolist())]

    @property
    def parents(self) -> NDArray[np.int64]:
        """Index (k,) of the vertex from which each vertex was reached; -1 for the roots."""
        trees = self._table
        return np.array([NONE]) if trees is None else trees.parents[: sum(trees.sizes.tolist())]

    @property
    def path(self) -> Floats:
        """Path (m, dim) of a solved search, kernel frame: over both trees, or to the region."""
        through = _through(self.samples, self.parents, *self._ends)
        return through if self._ends[1] != NONE else to_goal(self.problem, through)


@kernel
def _through(vertices, parents, first, second):
    """
    Return the path (m, dim) from the root of row ``first`` over ``second`` to the latter's root.

    Where ``second`` is NONE the path ends at row ``first``.
    """
    ahead, back = branch(vertices, parents, first), branch(vertices, parents, second)
    met = len(ahead)
    path = np.empty((met + len(back), vertices.shape[1]))
    copy_rows(path[:met], ahead)
    copy_rows(path[met:], back[::-1])
    return path
