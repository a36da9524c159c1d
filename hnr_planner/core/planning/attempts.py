"""
Attempts at a request: search, shorten, increase the clearance; again, for a better path.

Each attempt has random streams of its own, so that none depends on how many came before it or on
how long they took.
"""

from collections.abc import Callable
import math
from typing import NamedTuple, TypeVar

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.clock import working_time
from hnr_planner.core.lengths import path_length
from hnr_planner.core.planning.limits import Budget, run
from hnr_planner.core.planning.planner import PathSearch, Search, Work
from hnr_planner.core.planning.postprocessing.clearance import increase_clearance, path_cost
from hnr_planner.core.planning.postprocessing.simplify import shorten
from hnr_planner.core.planning.request import Request
from hnr_planner.core.planning.result import FirstSolution, PlannerStatus
import numpy as np

SearchType = TypeVar('SearchType', bound=Search)
Found = TypeVar('Found')

#: Fraction of the cost that a round has to gain to count as one that did.
LEAST_GAIN = 1e-3
#: Searches that are begun again because their path was not free in the caller's coordinates.
RESTARTS_MAX = 100
#: Purposes of random streams: to search, to shorten what was found.
SEARCH, SHORTEN = 0, 1


class Attempt(NamedTuple):
    """
    One search, and the path that came of it.

    Attributes
    ----------
    status : PlannerStatus
    search : PathSearch
    path : (m, dim)
        Caller's frame; (0, dim) when there is none.
    cost : float
        What is least for the best path: its length, and more near walls if a clearance was asked.
    first : FirstSolution or None
        The path as found.

    """

    status: PlannerStatus
    search: PathSearch
    path: Floats
    cost: float
    first: FirstSolution | None


def attempt(
    request: Request,
    number: int,
    budget: Budget,
    began: float,
    optimizing: Budget | None = None,
) -> Attempt:
    """
    Search once and improve the path that was found.

    With a budget for ``optimizing`` there is a second path, the rough one that the space itself
    knows: the shorter of the two is improved first, the other one while that budget lasts.
    """
    status, search, path = _search(request, number, budget)
    if status is not PlannerStatus.SOLVED:
        return Attempt(status, search, path, math.inf, None)
    first = FirstSolution(working_time() - began, path_length(path), path)
    if len(path) == 2 or optimizing is None:
        return Attempt(status, search, *_improved(request, number, search, path, budget), first)
    none: list[Floats] = []
    rough = budget.within(lambda: _rough_paths(request), none)
    shorter, *longer = sorted([path, *rough], key=path_length)
    best = _improved(request, number, search, shorter, budget)
    for other in longer:
        if optimizing.stop() is None:
            best = min(best, _improved(request, number, search, other, optimizing), key=_cost)
    return Attempt(status, search, *best, first)


def _improved(
    request: Request, number: int, search: PathSearch, path: Floats, budget: Budget
) -> tuple[Floats, float]:
    """Return a path (m, dim) shortened and moved away from walls as was asked, and its cost."""
    if request.simplify and not search.taut and len(path) > 2:
        space, rng, found = request.space, request.stream(number, SHORTEN), path
        path = budget.within(lambda: shorten(space, found, rng, budget), found)
    path = with_clearance(request, path, budget)
    cost = budget.within(lambda: path_cost(request.space, path, request.clearance), math.inf)
    return path, cost


def _cost(improved: tuple[Floats, float]) -> float:
    return improved[1]


def optimize(
    request: Request,
    best: Attempt,
    rounds: float,
    patience: float,
    budget: Budget,
    began: float,
) -> tuple[Attempt, Work]:
    """
    Search for better paths from fresh seeds: return the best, and the work of all searches.

    After ``patience`` rounds in a row that gain hardly anything no more are tried.
    """
    work, number, idle = Work.of(best.search), 1, 0
    while number <= rounds and idle < patience and len(best.path) > 2 and budget.stop() is None:
        again = attempt(request, number, budget, began)
        work = work.plus(Work.of(again.search))
        number += 1
        idle = 0 if again.cost < (1.0 - LEAST_GAIN) * best.cost else idle + 1
        if again.cost < best.cost:
            best = again
    return best, work


def with_clearance(request: Request, path: Floats, budget: Budget) -> Floats:
    """Return a path (m, dim) moved away from walls, where that was asked for."""
    if request.clearance == 0.0:
        return path
    space, clearance = request.space, request.clearance
    return budget.within(lambda: increase_clearance(space, path, clearance, budget), path)


def _search(
    request: Request, number: int, budget: Budget
) -> tuple[PlannerStatus, PathSearch, Floats]:
    """Search for a path (m, dim) that is free in the caller's coordinates."""

    def start(salt: int) -> PathSearch:
        return request.planner.start(request.problem, request.stream(number, SEARCH, salt))

    def free_path(search: PathSearch) -> Floats | None:
        path = _in_caller_s_frame(request, search.path)
        return path if request.space.is_path_free(path) else None

    def found_by(search: PathSearch) -> Floats | None:
        return budget.within(lambda: free_path(search), None)

    status, search, path = search_until_free(start, found_by, budget)
    return status, search, np.empty((0, request.space.dim)) if path is None else path


def search_until_free(
    start: Callable[[int], SearchType],
    found_by: Callable[[SearchType], Found | None],
    budget: Budget,
) -> tuple[PlannerStatus, SearchType, Found | None]:
    """
    Search until a path is free in the caller's coordinates, or a limit is met.

    A path so close to a corner that those coordinates round it into the obstacle does not count:
    then the search begins again, from another stream.

    Parameters
    ----------
    start : callable
        Starts the search of a number, 0 for the first.
    found_by : callable
        Returns what a solved search found, None when that is not free.
    budget : Budget
        Of all searches together.

    """
    for salt in range(RESTARTS_MAX):
        search = start(salt)
        status = run(search, budget)
        if status is PlannerStatus.SOLVED:
            found = found_by(search)
            if found is not None:
                return status, search, found
            status = budget.stop() or status
        if status is not PlannerStatus.SOLVED:
            return status, search, None
    return PlannerStatus.ITERATION_LIMIT, search, None


def _in_caller_s_frame(request: Request, points: Floats) -> Floats:
    """Path (m, dim) found in the kernel frame; its ends are the caller's own numbers."""
    path = request.space.from_kernel(points)
    path[0] = request.start
    if points[-1].tolist() == request.problem.goal.tolist():
        path[-1] = request.goal
    return path


def _rough_paths(request: Request) -> list[Floats]:
    """Return the free path (m, dim) that the space knows, caller's frame, if any."""
    rough = request.space.rough_path(request.problem.start, request.problem.goal)
    if rough is None:
        return []
    path = _in_caller_s_frame(request, rough)
    return [path] if request.space.is_path_free(path) else []
