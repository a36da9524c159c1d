"""
Protocols of planners and searches: planners start searches, which advance by counts, not clocks.

A planner is a frozen dataclass whose fields are its settings. Its ``start`` gives a search, whose
``advance(n)`` handles at most ``n`` further transitions. Batches may be of any size: the same
problem and generator give the same samples and the same path to the last bit. No search is
started where the start reaches the goal directly. All arrays are in the space's kernel frame.
"""

from typing import Any, NamedTuple, Protocol

from hnr_planner.core.checks import Floats
from hnr_planner.core.errors import RequestError
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
    A planning problem, as it is passed to kernels; all values are in the space's kernel frame.

    Attributes
    ----------
    space : NamedTuple
        The space as kernels take it (``Space.data``).
    lower, upper : (dim,)
        Opposite corners of a box around the space: least and largest coordinates.
    start, goal : (dim,)
        Start, and goal or centre of the goal region.
    goal_radius : float
        Radius of the goal region; 0 when the path has to end exactly at the goal.
    margin : float
        Distance that a point drawn on a chord keeps from the ends of the chord.
    typical_clearance : float
        Rough mean distance from a free point to the boundary of free space.
    scale : float
        Length of one unit of the kernel frame in the caller's units [m].

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


def check_rigid(space: Space) -> None:
    """Raise RequestError for a space whose kernel frame does not keep lengths."""
    if not space.is_rigid:
        raise RequestError(
            f'no path can be planned in {space!r}, whose coordinates do not keep lengths: a '
            f'rounded space has a base to plan in, a polytope with equations can only be sampled'
        )


def make_problem(space: Space, start: Floats, goal: Floats, goal_radius: float) -> Problem:
    """
    Return the problem of a path from start to goal in a space, converted to the kernel frame.

    ``start`` and ``goal`` (dim,) and ``goal_radius`` are in the caller's frame [m]. Raise
    RequestError for a space whose kernel frame does not keep lengths.
    """
    check_rigid(space)
    lower, upper = space.kernel_bounds
    start, goal = space.to_kernel(np.array((start, goal)))
    return Problem(
        space=space.data,
        lower=lower,
        upper=upper,
        start=start,
        goal=goal,
        goal_radius=goal_radius / space.scale,
        margin=space.margin,
        typical_clearance=space.typical_clearance,
        scale=space.scale,
    )


@kernel
def reaches_goal(problem, x):
    """
    Return whether ``x`` (dim,), kernel frame, reaches the goal of a problem.

    With a goal radius above 0, ``x`` has to lie in the goal region; else the straight segment from
    ``x`` to the goal has to be free.
    """
    if problem.goal_radius == 0.0:
        return segment_is_free(problem.space, x, problem.goal)
    squared = 0.0
    for i in range(len(x)):
        squared += (x[i] - problem.goal[i]) ** 2
    return squared <= problem.goal_radius**2


class Search(Protocol):
    """Protocol of a running search, which advances by counts of transitions."""

    @property
    def iterations(self) -> int:
        """Number of transitions handled: proposals inside the space, accepted or not."""

    @property
    def solved(self) -> bool:
        """Whether the search has found a path."""

    @property
    def samples(self) -> Floats:
        """Start and accepted vertices (k, dim), kernel frame, oldest first."""

    @property
    def parents(self) -> NDArray[np.int64]:
        """Index (k,) in ``samples`` from which each sample was reached; -1 for a tree's root."""

    @property
    def counts(self) -> dict[str, int]:
        """Further counts of the planner by name."""

    def advance(self, n_iterations: int) -> None:
        """Handle at most ``n_iterations`` further transitions, fewer once the search is solved."""


class Work(NamedTuple):
    """Work of several searches: transitions, and further counts by name."""

    iterations: int
    counts: dict[str, int]

    @classmethod
    def of(cls, search: Search) -> 'Work':
        """Return the work of one search so far."""
        return cls(search.iterations, search.counts)

    def plus(self, other: 'Work') -> 'Work':
        """Return the sum of this work and ``other``, count by count."""
        names = {**self.counts, **other.counts}
        counts = {name: self.counts.get(name, 0) + other.counts.get(name, 0) for name in names}
        return Work(self.iterations + other.iterations, counts)


class PathSearch(Search, Protocol):
    """Protocol of a running search for a path."""

    @property
    def path(self) -> Floats:
        """Path (m, dim) of a solved search, kernel frame: from the start to goal or region."""

    @property
    def taut(self) -> bool:
        """Whether the path of a solved search is taut already, so that it is not shortened."""


class Planner(Protocol):
    """Protocol of a planner: a value with a name and settings whose ``start`` begins a search."""

    @property
    def name(self) -> str:
        """Name of the planner in results."""

    def start(self, problem: Problem, rng: Stream) -> PathSearch:
        """Return a new search for a path that solves ``problem``; it draws from ``rng`` only."""


def for_space(planner: Planner, space: Space) -> Planner:
    """
    Return the planner for a space.

    It is ``planner`` itself, unless that has a method ``for_space``, whose result is returned.
    """
    bind = getattr(planner, 'for_space', None)
    return planner if bind is None else bind(space)


def to_goal(problem: Problem, points: Floats) -> Floats:
    """
    Return the path of ``points`` (m, dim), kernel frame, whose last point reaches the goal.

    Where the goal has no radius, the goal itself is added as the last point.
    """
    if problem.goal_radius > 0.0:
        return points
    return np.concatenate([points, problem.goal[np.newaxis]])


def with_capacity(array: NDArray[Any], rows: int) -> NDArray[Any]:
    """
    Return ``array``, or a longer copy when it has fewer than ``rows`` rows.

    The copy has ``rows`` rows, or ``GROWTH`` times those of ``array`` if that is more: the clock
    is not checked during a copy, so copies are made rarely. The operating system provides memory
    for rows only once they are written.
    """
    if len(array) >= rows:
        return array
    larger = np.empty((max(rows, GROWTH * len(array)), *array.shape[1:]), dtype=array.dtype)
    larger[: len(array)] = array
    return larger
