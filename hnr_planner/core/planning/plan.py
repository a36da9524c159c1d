"""
``plan``: one request, one answer.

The planners search and count; ``plan`` alone checks the request, owns the clock, listens for a
cancellation, shortens the path and says in words how it ended.
"""

from dataclasses import dataclass, replace
import math
import time
from typing import Any

from hnr_planner.core.checks import check_count, check_number, check_point, check_seed, Floats
from hnr_planner.core.planning.algorithms import make_planner
from hnr_planner.core.planning.limits import Event, Limits
from hnr_planner.core.planning.result import (
    FirstSolution,
    path_length,
    PlannerStatus,
    PlanResult,
)
from hnr_planner.core.planning.search import Planner, Problem, Search
from hnr_planner.core.planning.simplify import shorten
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import ArrayLike


def plan(
    space: Space,
    start: ArrayLike,
    goal: ArrayLike,
    *,
    algorithm: str | Planner = 'auto',
    goal_radius: float = 0.0,
    time_limit: float = 1.0,
    max_iterations: int | None = None,
    seed: int | None = None,
    simplify: bool = True,
    optimize_for: float = 0.0,
    optimize_iterations: int = 0,
    cancel: Event | None = None,
    **settings: Any,
) -> PlanResult:
    """
    Find a free path.

    Parameters
    ----------
    space : Space
        Where the path has to be free.
    start, goal : (dim,)
        Points in the caller's frame [m].
    algorithm : str or planner
        A name of ``ALGORITHMS`` or a planner value such as ``RRT(max_step=0.5)``.
    goal_radius : float
        Above 0 the path ends at the first sample within this distance [m] of the goal (the paper's
        goal region). At 0 it ends exactly at the goal, as soon as a sample sees it.
    time_limit : float
        Seconds for the whole call, above 0; inf for none. Compilation does not count.
    max_iterations : int, optional
        Transitions allowed for one search.
    seed : int, optional
        Fresh when left out; the result names the one used.
    simplify : bool
        Whether the path is shortened by visibility.
    optimize_for : float
        Seconds, within the time limit, to search again and again for a shorter path.
    optimize_iterations : int
        How many more searches to run for a shorter path; together with ``optimize_for`` whichever
        ends first.
    cancel : threading.Event, optional
        Ends the call once it is set.
    **settings
        Settings of the planner that ``algorithm`` names.

    Returns
    -------
    PlanResult
        Not finding a path is a status, never an exception.

    Raises
    ------
    RequestError
        When an argument is malformed; the message names the value and the rule.

    """
    request = _Request(
        space=space,
        start=check_point('start', start, space.dim),
        goal=check_point('goal', goal, space.dim),
        goal_radius=check_number('goal_radius', goal_radius, 0.0),
        planner=make_planner(algorithm, settings),
        simplify=bool(simplify),
        seed=check_seed(seed),
    )
    seconds = check_number('time_limit', time_limit, 0.0)
    improve_seconds = check_number('optimize_for', optimize_for, 0.0)
    improve_searches = check_count('optimize_iterations', optimize_iterations, 0)
    count = (
        math.inf if max_iterations is None else check_count('max_iterations', max_iterations, 1)
    )
    _compile(space, request.planner)

    began = time.perf_counter()
    limits = Limits(began + seconds, count, cancel)
    refused = _refusal(request)
    if refused is not None:
        return replace(refused, elapsed=time.perf_counter() - began)
    seeds = np.random.SeedSequence(request.seed)
    result = _attempt(request, seeds.spawn(1)[0], limits, began)
    if result.path.size and (improve_seconds or improve_searches):
        until = time.perf_counter() + (improve_seconds or math.inf)
        limits = replace(limits, deadline=min(limits.deadline, until))
        result = _improve(request, result, seeds, limits, began, improve_searches or math.inf)
    return replace(result, elapsed=time.perf_counter() - began)


@dataclass(frozen=True)
class _Request:
    """A request whose numbers are clean."""

    space: Space
    start: Floats
    goal: Floats
    goal_radius: float
    planner: Planner
    simplify: bool
    seed: int

    def problem(self) -> Problem:
        """State the problem in the kernel frame."""
        lower, upper = self.space.kernel_bounds
        return Problem(
            space=self.space.data,
            lower=lower,
            upper=upper,
            start=self.space.to_kernel(self.start),
            goal=self.space.to_kernel(self.goal),
            goal_radius=self.goal_radius / self.space.scale,
            margin=self.space.margin,
            clearance=self.space.typical_clearance,
        )

    def failure(self, status: PlannerStatus, message: str) -> PlanResult:
        """Answer without a path and without a search."""
        return PlanResult(
            status=status,
            message=message,
            planner=self.planner.name,
            path=np.empty((0, self.space.dim)),
            length=math.inf,
            samples=np.empty((0, self.space.dim)),
            parents=np.empty(0, dtype=np.int64),
            iterations=0,
            counts={},
            elapsed=0.0,
            seed=self.seed,
            cut_by_time=False,
            first_solution=None,
        )


def _refusal(request: _Request) -> PlanResult | None:
    """Answer at once where no search can help: an end that is not free, or no way between them."""
    space, start, goal = request.space, request.start, request.goal
    if not space.contains(start):
        message = f'start {_words(start)} is {space.why_not_free(start)}'
        return request.failure(PlannerStatus.INVALID_START, message)
    goal_is_free = space.contains(goal)
    if not goal_is_free and request.goal_radius == 0.0:
        message = f'goal {_words(goal)} is {space.why_not_free(goal)}'
        return request.failure(PlannerStatus.INVALID_GOAL, message)
    if space.reachable(start, goal, request.goal_radius) is not False:
        return None
    around = f' or within {request.goal_radius:g} m of it' if request.goal_radius else ''
    message = f'no path exists from start {_words(start)} to goal {_words(goal)}{around}'
    status = PlannerStatus.UNREACHABLE if goal_is_free else PlannerStatus.INVALID_GOAL
    return request.failure(status, message)


def _attempt(
    request: _Request, seed: np.random.SeedSequence, limits: Limits, began: float
) -> PlanResult:
    """Search once and shorten what was found."""
    search_rng, simplify_rng = (np.random.default_rng(child) for child in seed.spawn(2))
    search = request.planner.start(request.problem(), search_rng, request.space.scale)
    status = limits.run(search)
    result = _unsolved(request, search, status, limits, began)
    if status is not PlannerStatus.SOLVED:
        return result
    path = _path_found(request, search)
    first = FirstSolution(time.perf_counter() - began, path_length(path))
    if request.simplify:
        path = shorten(request.space, path, simplify_rng, limits)
    length = path_length(path)
    return replace(
        result,
        message=f'path of {length:.6g} m with {len(path)} vertices '
        f'after {search.iterations} transitions',
        path=path,
        length=length,
        cut_by_time=limits.stop() is PlannerStatus.TIMEOUT,
        first_solution=first,
    )


def _unsolved(
    request: _Request, search: Search, status: PlannerStatus, limits: Limits, began: float
) -> PlanResult:
    """Say what a search did, the path aside."""
    seconds = time.perf_counter() - began
    return replace(
        request.failure(
            status, f'{status.value} ({search.iterations} transitions, {seconds:.3g} s)'
        ),
        samples=request.space.from_kernel(search.samples),
        parents=search.parents.copy(),
        iterations=search.iterations,
        counts=search.counts,
        cut_by_time=status is PlannerStatus.TIMEOUT,
    )


def _path_found(request: _Request, search: Search) -> Floats:
    """Path (m, dim) of a solved search, caller's frame; its ends are the caller's own numbers."""
    path = request.space.from_kernel(search.path)
    path[0] = request.start
    if request.goal_radius == 0.0:
        path[-1] = request.goal
    return path


def _improve(
    request: _Request,
    best: PlanResult,
    seeds: np.random.SeedSequence,
    limits: Limits,
    began: float,
    searches: float,
) -> PlanResult:
    """Search again from fresh seeds, and keep the shortest path."""
    iterations, first = best.iterations, best.first_solution
    while searches > 0 and limits.stop() is None:
        again = _attempt(request, seeds.spawn(1)[0], limits, began)
        iterations += again.iterations
        searches -= 1
        if again.length < best.length:
            best = again
    cut = limits.stop() is PlannerStatus.TIMEOUT
    return replace(
        best,
        iterations=iterations,
        first_solution=first,
        cut_by_time=best.cut_by_time or cut,
    )


_compiled: set[tuple[type, type]] = set()


def _compile(space: Space, planner: Planner) -> None:
    """Compile, once for each kind of space and planner, before any clock runs."""
    kinds = (type(space.data), type(planner))
    if kinds in _compiled:
        return
    lower, upper = space.kernel_bounds
    problem = Problem(
        space.data, lower, upper, lower, upper, 0.0, space.margin, space.typical_clearance
    )
    rng = np.random.default_rng(0)
    search = planner.start(problem, rng, space.scale)
    search.advance(0)
    space.contains(np.zeros(space.dim))
    corners = space.from_kernel(np.stack([lower, upper]))
    shorten(space, np.concatenate([corners, corners]), rng, Limits(math.inf))
    _compiled.add(kinds)


def _words(point: Floats) -> str:
    return '(' + ', '.join(f'{x:g}' for x in point) + ')'
