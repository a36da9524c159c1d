"""
Protocols of planners and searches: planners start searches, which advance by counts, not clocks.

A planner is a frozen dataclass whose fields are its settings. Its ``start`` gives a search, whose
``advance(n)`` handles at most ``n`` further transitions. Batches may be of any size: the same
problem and generator give the same samples and the same path to the last bit. No search is
started where the start reaches the goal directly. All arrays are in the space's kernel frame.
"""

from typing import Any, NamedTuple, Protocol

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.spaces.primitives import segment_is_free
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import NDArray

#: Factor by which an array grows when it is full.
GROWTH = 8


class Problem(NamedTuple):
    """
    A planning problem in the kernel frame of a space, as it is passed to kernels.

    Attributes
    ----------
    space : NamedTuple
        The compiled space.
    lower, upper : (dim,)
        Corners of a box around the space.
    start, goal : (dim,)
        Start and centre of the goal region.
    goal_radius : float
        Radius of the goal region; 0 when the path has to end exactly at the goal.
    margin : float
        Distance from a chord's end at which one stops.
    typical_clearance : float
        Rough mean distance from a free point to the boundary.
    scale : float
        Caller's units [m] in one unit of the kernel frame.

    """

    space: Any
    lower: Floats
    upper: Floats
    start: Floats
    goal: Floats
    goal_radius: float
    margin: float
    typical_clearance: float
    scale: float


def make_problem(space: Space, start: Floats, goal: Floats, goal_radius: float) -> Problem:
    """Return the problem of going from start to goal (dim,) in a space, caller's frame."""
    lower, upper = space.kernel_bounds
    return Problem(
        space=space.data,
        lower=lower,
        upper=upper,
        start=space.to_kernel(start),
        goal=space.to_kernel(goal),
        goal_radius=goal_radius / space.scale,
        margin=space.margin,
        typical_clearance=space.typical_clearance,
        scale=space.scale,
    )


@kernel
def reaches_goal(problem, x):
    """Return whether ``x`` (dim,) lies in the goal region, or an exact goal is visible from it."""
    if problem.goal_radius == 0.0:
        return segment_is_free(problem.space, x, problem.goal)
    squared = 0.0
    for i in range(len(x)):
        squared += (x[i] - problem.goal[i]) ** 2
    return squared <= problem.goal_radius**2


class Search(Protocol):
    """A running search."""

    @property
    def iterations(self) -> int:
        """Transitions handled: proposals drawn from the space, accepted or not."""

    @property
    def solved(self) -> bool:
        """Whether the search is over: its path is found."""

    @property
    def samples(self) -> Floats:
        """Start and accepted vertices (k, dim), oldest first."""

    @property
    def parents(self) -> NDArray[np.int64]:
        """Index (k,) of the sample that each was reached from; -1 for the roots."""

    @property
    def counts(self) -> dict[str, int]:
        """Further counts by name."""

    def advance(self, n_iterations: int) -> None:
        """Handle at most ``n_iterations`` further transitions, fewer once solved."""


class Work(NamedTuple):
    """Work of several searches: transitions, and further counts by name."""

    iterations: int
    counts: dict[str, int]

    @classmethod
    def of(cls, search: Search) -> 'Work':
        """Return the work of one search."""
        return cls(search.iterations, search.counts)

    def plus(self, other: 'Work') -> 'Work':
        """Return the work of both."""
        names = {**self.counts, **other.counts}
        counts = {name: self.counts.get(name, 0) + other.counts.get(name, 0) for name in names}
        return Work(self.iterations + other.iterations, counts)


class PathSearch(Search, Protocol):
    """A running search for a path."""

    @property
    def path(self) -> Floats:
        """Path (m, dim) of a solved search: from the start into the region, or to the goal."""

    @property
    def taut(self) -> bool:
        """Whether the path of a solved search is taut: shortening it gains nothing."""


class Planner(Protocol):
    """A planner: its name and settings; ``start`` begins a search."""

    @property
    def name(self) -> str:
        """Name of the planner in results."""

    def start(self, problem: Problem, rng: Stream) -> PathSearch:
        """Start a search for a path that solves ``problem``, with a random stream."""


def for_space(planner: Planner, space: Space) -> Planner:
    """Return a planner with the data that it needs of a space, where it needs any."""
    bind = getattr(planner, 'for_space', None)
    return planner if bind is None else bind(space)


def to_goal(problem: Problem, points: Floats) -> Floats:
    """Return ``points`` (m, dim), whose last one reaches the goal, with an exact goal added."""
    return points if problem.goal_radius > 0.0 else np.vstack([points, problem.goal])


def with_capacity(array: NDArray[Any], rows: int) -> NDArray[Any]:
    """
    Return ``array``, or a copy several times as long when it has fewer than ``rows`` rows.

    The clock is not checked during a copy, so copies are rare. The operating system provides
    memory for rows only once they are written.
    """
    if len(array) >= rows:
        return array
    larger = np.empty((max(rows, GROWTH * len(array)), *array.shape[1:]), dtype=array.dtype)
    larger[: len(array)] = array
    return larger
