"""What ``plan`` answers."""

from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.systems.trajectory import Trajectory
import numpy as np
from numpy.typing import NDArray


class PlannerStatus(Enum):
    """How a request ended; the value says it in words."""

    SOLVED = 'a path was found'
    INVALID_START = 'the start is not free'
    INVALID_GOAL = 'the goal is not free'
    UNREACHABLE = 'no path exists: start and goal lie in different parts of free space'
    TIMEOUT = 'the time limit passed before a path was found'
    ITERATION_LIMIT = 'the limit on transitions was reached before a path was found'
    CANCELLED = 'the search was cancelled'
    INEVITABLE_COLLISION = 'the start is too fast to avoid a collision'


class FirstSolution(NamedTuple):
    """The first path, before anything made it shorter: time to it [s] and its length [m]."""

    elapsed: float
    length: float


@dataclass(frozen=True)
class PlanResult:
    """
    Answer to a planning request, in the caller's frame and units.

    Attributes
    ----------
    status : PlannerStatus
    message : str
        Why, in words, with the values.
    planner : str
        Name of the planner that searched.
    path : (m, dim)
        Vertices from start to goal; (0, dim) when there is none.
    length : float
        Length of the path [m]; inf when there is none.
    samples : (k, dim)
        The start, then one row for each vertex of the search; a second tree has its root at the
        goal.
    parents : (k,) int
        Row of ``samples`` that each was reached from; -1 for the roots.
    iterations : int
        Transitions handled: proposals inside the space, whatever became of them.
    counts : dict
        What else the search counted, by name.
    elapsed : float
        Time of the whole call [s], compilation aside.
    seed : int
        The seed that gives this result again.
    cut_by_time : bool
        Whether a clock or a cancellation ended something: only then may the same seed give
        another result.
    first_solution : FirstSolution or None
    others : tuple of (k, dim)
        Further paths, when alternatives were asked for.
    trajectory : Trajectory or None
        For a system what it does over time; ``path`` has the positions at its times, between which
        the way is curved, and ``length`` is the length of that way.

    """

    status: PlannerStatus
    message: str
    planner: str
    path: Floats
    length: float
    samples: Floats
    parents: NDArray[np.int64]
    iterations: int
    counts: dict[str, int]
    elapsed: float
    seed: int
    cut_by_time: bool
    first_solution: FirstSolution | None
    others: tuple[Floats, ...] = ()
    trajectory: Trajectory | None = None

    @property
    def paths(self) -> tuple[Floats, ...]:
        """All paths, the shortest first: ``path`` and the others."""
        return (self.path, *self.others) if len(self.path) else ()
