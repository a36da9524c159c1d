"""``plan_many``: the shortest paths of many requests on one grid, on all cores."""

from dataclasses import dataclass
import math
import os

from hnr_planner.core.cancellation import Event
from hnr_planner.core.checks import check_count, check_number, check_points, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.clock import working_time
from hnr_planner.core.planning.batch.requests import (
    INVALID_GOAL,
    INVALID_START,
    ITERATION_LIMIT,
    measure_paths,
    N_POINTS,
    Progress,
    SOLVED,
    UNREACHABLE,
    WAITING,
)
from hnr_planner.core.planning.batch.work import work
from hnr_planner.core.planning.request import check_effort
from hnr_planner.core.planning.result import PlannerStatus
from hnr_planner.core.spaces.grid.grid_space import GridSpace
import numpy as np
from numpy.typing import ArrayLike, NDArray

#: Status of each number that ``go_on`` writes.
STATUS = {
    SOLVED: PlannerStatus.SOLVED,
    INVALID_START: PlannerStatus.INVALID_START,
    INVALID_GOAL: PlannerStatus.INVALID_GOAL,
    UNREACHABLE: PlannerStatus.UNREACHABLE,
    ITERATION_LIMIT: PlannerStatus.ITERATION_LIMIT,
}


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class PlanBatch:
    """
    Results of ``plan_many``, in the caller's frame.

    Attributes
    ----------
    status : (k,) PlannerStatus
        How each request ended.
    length : (k,)
        Lengths of the paths [m]; inf where no path was found.
    lower_bound : (k,)
        Lower bound on the length of all free paths of each request [m], as in ``PlanResult``.
    iterations : (k,) int64
        Number of cones expanded for each request.
    elapsed : float
        Duration of the whole call [s], without the time spent waiting for compilation.
    cut_by_time : bool
        Whether the clock or a cancellation ended some of the work.

    """

    status: NDArray[np.object_]
    length: Floats
    lower_bound: Floats
    iterations: NDArray[np.int64]
    elapsed: float
    cut_by_time: bool
    _points: Floats
    _ends: NDArray[np.int64]

    def __len__(self) -> int:
        """Return the number of requests."""
        return len(self.length)

    def __repr__(self) -> str:
        """Return the numbers of requests and of solved ones."""
        n_solved = int(np.count_nonzero(self.status == PlannerStatus.SOLVED))
        return f'PlanBatch({len(self)} requests, {n_solved} solved)'

    def path(self, i: int) -> Floats:
        """Return the vertices (m, 2) [m] of one path; (0, 2) where none was found."""
        i = range(len(self))[i]
        first, last = self._ends[i - 1] if i > 0 else 0, self._ends[i]
        return self._points[first:last].copy()


def plan_many(
    space: GridSpace,
    starts: ArrayLike,
    goals: ArrayLike,
    *,
    goal_radius: float = 0.0,
    time_limit: float = math.inf,
    max_iterations: int | None = None,
    cancel: Event | None = None,
    n_jobs: int | None = None,
) -> PlanBatch:
    """
    Find the shortest paths of many requests on one grid, each as ``plan`` does by ``polyanya``.

    Parameters
    ----------
    space : GridSpace
        Where the paths have to be free.
    starts, goals : (k, 2)
        Start and goal of each request, caller's frame [m].
    goal_radius : float
        Above 0 each path ends within this distance [m] of its goal.
    time_limit : float
        Seconds for the whole call; requests that are not done by then have the status TIMEOUT.
    max_iterations : int, optional
        Number of cones that may be expanded for one request; no limit when left out.
    cancel : threading.Event, optional
        Event that ends the call once the event is set.
    n_jobs : int, optional
        Number of threads; as many as there are cores when left out.

    Returns
    -------
    PlanBatch
        The results, the same for every number of threads where the clock has not cut the work.

    Raises
    ------
    RequestError
        When an argument is malformed; the message names the value and the rule.

    """
    check_grid('plan_many', space)
    effort = check_effort(
        time_limit=time_limit,
        max_iterations=max_iterations,
        optimize_for=0.0,
        optimize_iterations=0,
        cancel=cancel,
    )
    goal_radius = check_number('goal_radius', goal_radius, 0.0)
    starts, goals = check_many('starts', starts), check_many('goals', goals)
    if len(starts) != len(goals):
        raise RequestError(f'starts and goals must be as many, got {len(starts)} and {len(goals)}')
    n_threads = cores() if n_jobs is None else check_count('n_jobs', n_jobs, 1)
    began = working_time()
    ends = np.stack([space.to_kernel(starts), space.to_kernel(goals)], axis=1)
    results, stops = work(space, ends, goal_radius, effort, n_threads)
    return _batch(space, starts, goals, goal_radius, results, stops, began)


def check_grid(name: str, space: GridSpace) -> None:
    """Raise RequestError where ``space``, an argument of the function ``name``, is no grid."""
    if not isinstance(space, GridSpace):
        raise RequestError(f'{name} plans in a GridSpace, got a {type(space).__name__}')


def check_many(name: str, points: ArrayLike) -> Floats:
    """Return ``points`` (k, 2) as a fresh array of finite floats, or raise RequestError."""
    array = check_points(name, points, 2)
    if array.ndim != 2:
        raise RequestError(f'{name} must have shape (k, 2), got {array.shape}')
    rows = np.flatnonzero(~np.isfinite(array).all(axis=1))
    if len(rows) > 0:
        raise RequestError(
            f'{name} must be finite, got {array[rows[0]].tolist()} in row {rows[0]}'
        )
    return array


def cores() -> int:
    """Return the number of cores that this process may use."""
    return len(os.sched_getaffinity(0))


def _batch(
    space: GridSpace,
    starts: Floats,
    goals: Floats,
    goal_radius: float,
    results: list[Progress],
    stops: list[PlannerStatus],
    began: float,
) -> PlanBatch:
    """Return the results of all chunks, in the caller's frame."""
    cells = np.concatenate([each.points[: each.sizes[N_POINTS]] for each in results])
    counts = [np.diff(np.maximum.accumulate(each.ends), prepend=0) for each in results]
    last = np.cumsum(np.concatenate(counts))
    points = _with_exact_ends(space.from_kernel(cells), last, starts, goals, goal_radius)
    lengths, is_free = np.empty(len(last)), np.empty(len(last), dtype=np.bool_)
    measure_paths(space.data, space.to_kernel(points), points, last, lengths, is_free)
    numbers = np.concatenate([each.status for each in results])
    # What the caller's coordinates round into an obstacle is no path, as in plan.
    numbers[~is_free] = ITERATION_LIMIT
    bounds = np.concatenate([each.bounds for each in results]) * space.scale
    straight = np.hypot(*(goals - starts).T) - goal_radius
    names = STATUS | {WAITING: stops[0] if stops else PlannerStatus.TIMEOUT}
    return PlanBatch(
        status=np.array([names[number] for number in numbers.tolist()], dtype=object),
        length=np.where(is_free, lengths, math.inf),
        lower_bound=np.maximum(bounds, np.maximum(straight, 0.0)),
        iterations=np.concatenate([each.iterations for each in results]),
        elapsed=working_time() - began,
        cut_by_time=len(stops) > 0,
        _points=points,
        _ends=last,
    )


def _with_exact_ends(
    points: Floats,
    last: NDArray[np.int64],
    starts: Floats,
    goals: Floats,
    goal_radius: float,
) -> Floats:
    """
    Return the vertices (rows, 2) of all paths with the caller's own numbers at their ends.

    ``last`` (k,) is the number of vertices of the first path, of the first two, and so on.
    """
    first = np.concatenate([[0], last[:-1]])
    has_path = np.flatnonzero(last > first)
    first, last = first[has_path], last[has_path] - 1
    stays = (points[first] == points[last]).all(axis=1)
    points[first] = starts[has_path]
    if goal_radius == 0.0:
        points[last] = goals[has_path]
    else:
        points[last[stays]] = starts[has_path[stays]]
    return points
