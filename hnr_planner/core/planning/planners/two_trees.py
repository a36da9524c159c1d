"""
What searches with a tree at each end share: both trees in one table, and the path through both.

Row 0 is the root of the start's tree; the goal's, where there is one, follows. A search is solved
when a vertex of one tree sees one of the other, or when the only tree has come into the region.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import ClassVar

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.planning.planner import Problem, to_goal
from hnr_planner.core.trees import branch, NONE
import numpy as np
from numpy.typing import NDArray


@dataclass
class TwoTreeSearch(ABC):
    """
    Two trees under way.

    A goal region whose centre cannot be reached has no second tree: the first has to find into it.

    Attributes
    ----------
    problem : Problem
        What is searched for.
    rng : Stream
        Where every draw comes from.
    iterations : int
        Transitions handled.

    """

    problem: Problem
    rng: Stream
    iterations: int = field(init=False, default=0)
    taut: ClassVar[bool] = False
    #: The vertices that see each other, the start tree's first; (k, NONE) for one in the region.
    _ends: tuple[int, int] = field(init=False, default=(NONE, NONE))

    @property
    @abstractmethod
    def _table(self) -> tuple[Floats, NDArray[np.int64]]:
        """Return vertices (k, dim) and parents (k,) of both trees, oldest first."""

    @property
    def solved(self) -> bool:
        """Whether the trees have met, or the first has come into the goal region."""
        return self._ends[0] != NONE

    @property
    def samples(self) -> Floats:
        """The vertices (k, dim) of both trees."""
        return self._table[0]

    @property
    def parents(self) -> NDArray[np.int64]:
        """Index (k,) of the vertex that each was reached from; -1 for the roots."""
        return self._table[1]

    @property
    def path(self) -> Floats:
        """Return the branch of each tree that leads to where they met."""
        through = _through(*self._table, *self._ends)
        return through if self._ends[1] != NONE else to_goal(self.problem, through)


@kernel
def _through(vertices, parents, first, second):
    """Path (m, dim) from the root of ``first`` to it, and from ``second`` back to its root."""
    ahead, back = branch(vertices, parents, first), branch(vertices, parents, second)
    return np.concatenate((ahead, back[::-1]))
