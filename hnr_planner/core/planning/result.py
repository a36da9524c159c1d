"""Results of ``plan``, and the fields that they share with those of ``plan_trajectory``."""

from dataclasses import dataclass
from enum import Enum
import math
from typing import Any, NamedTuple, Self

from hnr_planner.core.checks import check_positive, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.spaces.poses.motion import orbit_poses
import numpy as np
from numpy.typing import NDArray


class PlannerStatus(Enum):
    """How a request ended; the value of a member describes that ending in words."""

    SOLVED = 'a path was found'
    INVALID_START = 'the start is not free'
    INVALID_GOAL = 'the goal is not free'
    UNREACHABLE = 'no path exists: start and goal lie in different parts of free space'
    TIMEOUT = 'the time limit passed before a path was found'
    ITERATION_LIMIT = 'the limit on transitions was reached before a path was found'
    CANCELLED = 'the search was cancelled'
    INEVITABLE_COLLISION = 'the start is too fast to avoid a collision'


#: A path at most this many times as long as the lower bound counts as the shortest; it is so up to
#: the margins at which it passes corners.
PROVED = 1.0 + 1e-6


def proof(length: float, lower_bound: float, straight_length: float) -> str:
    """
    Return what a lower bound [m] proves of the ``length`` [m] of a path, as part of a message.

    It is empty where the bound is no better than ``straight_length``, the straight distance [m].
    """
    if lower_bound <= straight_length:
        return ''
    ratio = length / lower_bound
    if ratio <= PROVED:
        return ', the shortest'
    return f', at most {100.0 * (ratio - 1.0):.2g} % longer than the shortest'


def proof_of_clearance(clearance: float, keeps: bool, length: float, lower_bound: float) -> str:
    """
    Return what is proved of the paths that keep a clearance, as part of a message.

    Parameters
    ----------
    clearance : float
        The clearance requested [m].
    keeps : bool
        Whether the path was found as the shortest over the cells that keep it.
    length : float
        Length of the path [m].
    lower_bound : float
        Lower bound on the length of the paths over these cells [m]; inf where there is none, 0
        where none were searched for.

    """
    cells = f'over cells that keep {clearance:g} m'
    if lower_bound == 0.0:
        return ''
    if lower_bound == math.inf:
        return f', no path {cells} exists'
    if length > PROVED * lower_bound:
        longer = 100.0 * (length / lower_bound - 1.0)
        return f', at most {longer:.2g} % longer than the shortest {cells}'
    return f', the shortest {cells}' if keeps else f', no longer than the shortest {cells}'


class FirstSolution(NamedTuple):
    """
    The first path that was found, before it was shortened.

    Attributes
    ----------
    elapsed : float
        Time from the beginning of the call until the path was found [s].
    length : float
        Length of the path [m].
    path : (m, dim)
        Vertices from start to goal, caller's frame; for a trajectory its positions.

    """

    elapsed: float
    length: float
    path: Floats


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class SearchResult:
    """
    Fields of the results of ``plan`` and ``plan_trajectory``, in the caller's frame and units.

    Attributes
    ----------
    status : PlannerStatus
        How the request ended.
    message : str
        Why the request ended with this status, with the values that decided it.
    planner : str
        Name of the planner that searched.
    path : (m, dim)
        Vertices from start to goal [m]; (0, dim) when no path was found.
    length : float
        Length of the path [m]; inf when no path was found.
    samples : (k, dim)
        Points that the search reached [m]: the start, then one row for each further vertex; a
        second tree has its root at the goal.
    parents : (k,) int
        Row of ``samples`` from which each sample was reached; -1 for the root of a tree.
    iterations : int
        Number of transitions handled by all searches together: proposals inside the space,
        accepted or not, and cones expanded in the search for the shortest path.
    counts : dict
        Further counts of the planner by name, of all searches together.
    elapsed : float
        Duration of the whole call [s], without the time spent waiting for compilation.
    seed : int
        The seed that reproduces this result.
    cut_by_time : bool
        Whether the clock or a cancellation ended some of the work: only then may the same seed
        give another result.
    first_solution : FirstSolution or None
        The first path as found; None when no path was found.

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

    @classmethod
    def without_search(
        cls,
        status: PlannerStatus,
        message: str,
        *,
        planner: str,
        dim: int,
        seed: int,
        elapsed: float,
        cut_by_time: bool = False,
        **more: Any,
    ) -> Self:
        """
        Return the result of a request in which nothing was searched and no path was found.

        ``dim`` is that of the points, and ``more`` are fields of the class itself.
        """
        return cls(
            status=status,
            message=message,
            planner=planner,
            path=np.empty((0, dim)),
            length=math.inf,
            samples=np.empty((0, dim)),
            parents=np.empty(0, dtype=np.int64),
            iterations=0,
            counts={},
            elapsed=elapsed,
            seed=seed,
            cut_by_time=cut_by_time,
            first_solution=None,
            **more,
        )

    def __repr__(self) -> str:
        """Return the status, the length and the numbers of vertices, samples and transitions."""
        return (
            f'{type(self).__name__}({self.status.name}, length={self.length:.6g}, '
            f'vertices={len(self.path)}, samples={len(self.samples)}, '
            f'iterations={self.iterations}, planner={self.planner!r}, seed={self.seed})'
        )


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class PlanResult(SearchResult):
    """
    Result of ``plan``: the attributes of ``SearchResult``, and those below.

    Attributes
    ----------
    others : tuple of (k, dim)
        Further paths [m], when alternatives were requested; else empty.
    goal_offset : float
        Distance from the requested goal to the end of the path [m] where the goal was moved
        within ``goal_tolerance``; else 0.
    lower_bound : float
        Lower bound on the length of all free paths from start to goal or to the goal region [m].
        It equals the length of the path, up to margins at corners, where that is proved to be the
        shortest; it is inf where no path exists. Where an end was moved, it is a bound on paths
        with the ends as moved, the segment from the start to free space included.
    clear_lower_bound : float
        The same for paths over cells of a grid that keep the requested clearance everywhere [m]:
        inf where no such cells connect the ends; 0 where these were not searched.
    next_lower_bound : float
        The same for paths with the ends of ``path`` that can be deformed into none of ``paths``
        and pass no point twice when pulled taut [m]: inf where there are none; 0 where that was
        not searched: in other spaces than grids, with a clearance, without alternatives.
    escape : float
        Length of the first segment of the path [m] where it leads from a start that is not free
        to free space (``start_escape``); else 0.
    twists : (m - 1, 3) or None
        In a ``PoseSpace``, the twist [m, m, rad] that leads from each pose of the path to the next
        in one unit of time: ``path[i + 1]`` is ``path[i]`` moved by ``twists[i]``. None elsewhere.

    """

    others: tuple[Floats, ...] = ()
    goal_offset: float = 0.0
    escape: float = 0.0
    lower_bound: float = 0.0
    clear_lower_bound: float = 0.0
    next_lower_bound: float = 0.0
    twists: Floats | None = None

    def poses(self, spacing: float) -> Floats:
        """
        Interpolate a path of poses: all its vertices, and poses between them.

        Parameters
        ----------
        spacing : float
            Largest distance [m] between the robot's positions, and largest angle [rad] between
            its headings.

        Returns
        -------
        (n, 3)
            Poses in the map frame, at most ``spacing`` apart.

        Raises
        ------
        RequestError
            When the spacing is not above 0, or the result is not of a ``PoseSpace``.

        """
        spacing = check_positive('spacing', spacing)
        if self.twists is None:
            raise RequestError('poses needs the result of a PoseSpace')
        passed = [self.path[:1]]
        for pose, twist, end in zip(self.path, self.twists, self.path[1:], strict=False):
            extent = max(float(np.hypot(*twist[:2])), abs(float(twist[2])))
            times = np.linspace(0.0, 1.0, 1 + max(1, math.ceil(extent / spacing)))[1:-1]
            passed += [orbit_poses(pose, twist, times), end[np.newaxis]]
        return np.concatenate(passed)

    @property
    def paths(self) -> tuple[Floats, ...]:
        """All paths, the shortest first: ``path`` and ``others``; empty when no path was found."""
        return (self.path, *self.others) if len(self.path) else ()
