"""
Attempts at a request: search, shorten, keep away from walls; again, for a better path.

Each attempt has random streams of its own, so that none depends on how many came before it or on
how long they took.
"""

from collections.abc import Callable
import itertools
import math
import time
from typing import NamedTuple, TypeVar

from hnr_planner.core.checks import Floats
from hnr_planner.core.lengths import path_length
from hnr_planner.core.planning.limits import Budget
from hnr_planner.core.planning.planner import PathSearch, Search
from hnr_planner.core.planning.postprocessing.clearance import increase_clearance, path_cost
from hnr_planner.core.planning.postprocessing.simplify import shorten
from hnr_planner.core.planning.request import Request
from hnr_planner.core.planning.result import FirstSolution, PlannerStatus
import numpy as np

SearchType = TypeVar('SearchType', bound=Search)
Answer = TypeVar('Answer')

#: What random streams are for: to search, to shorten what was found.
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

    """

    status: PlannerStatus
    search: PathSearch
    path: Floats
    cost: float
    first: FirstSolution | None


def attempt(
    request: Request,
    number: int,
    limits: Budget,
    began: float,
    improving: Budget | None = None,
) -> Attempt:
    """
    Search once and better what was found.

    With limits for ``improving`` there is a second way, the rough path that the space itself
    knows: the shorter of the two is bettered first, the other one while these limits allow.
    """
    status, search, path = _search(request, number, limits)
    if status is not PlannerStatus.SOLVED:
        return Attempt(status, search, path, math.inf, None)
    first = FirstSolution(time.perf_counter() - began, path_length(path))
    if len(path) == 2 or improving is None:
        return Attempt(status, search, *_bettered(request, number, search, path, limits), first)
    shorter, *longer = sorted([path, *_rough_paths(request)], key=path_length)
    best = _bettered(request, number, search, shorter, limits)
    for way in longer:
        if improving.stop() is None:
            best = min(best, _bettered(request, number, search, way, improving), key=_cost)
    return Attempt(status, search, *best, first)


def _bettered(
    request: Request, number: int, search: PathSearch, path: Floats, limits: Budget
) -> tuple[Floats, float]:
    """Return a path (m, dim) shortened and moved away from walls as was asked, and its cost."""
    if request.simplify and not search.taut and len(path) > 2:
        path = shorten(request.space, path, request.stream(number, SHORTEN), limits)
    path = with_clearance(request, path, limits)
    return path, path_cost(request.space, path, request.clearance)


def _cost(bettered: tuple[Floats, float]) -> float:
    return bettered[1]


def improve(
    request: Request, best: Attempt, searches: float, limits: Budget, began: float
) -> tuple[Attempt, int]:
    """Look for better paths by searches from fresh seeds: the best, and the transitions of all."""
    iterations, number = best.search.iterations, 1
    while number <= searches and len(best.path) > 2 and limits.stop() is None:
        again = attempt(request, number, limits, began)
        iterations += again.search.iterations
        number += 1
        if again.cost < best.cost:
            best = again
    return best, iterations


def with_clearance(request: Request, path: Floats, limits: Budget) -> Floats:
    """Return a path (m, dim) moved away from walls, where that was asked for."""
    if request.clearance == 0.0:
        return path
    return increase_clearance(request.space, path, request.clearance, limits)


def _search(
    request: Request, number: int, limits: Budget
) -> tuple[PlannerStatus, PathSearch, Floats]:
    """Search for a path (m, dim) that is free in the caller's coordinates."""

    def start(salt: int) -> PathSearch:
        return request.planner.start(request.problem, request.stream(number, SEARCH, salt))

    def free_path(search: PathSearch) -> Floats | None:
        path = _in_caller_s_frame(request, search.path)
        return path if request.space.is_path_free(path) else None

    status, search, path = search_until_free(start, free_path, limits)
    return status, search, np.empty((0, request.space.dim)) if path is None else path


def search_until_free(
    start: Callable[[int], SearchType],
    answer_of: Callable[[SearchType], Answer | None],
    limits: Budget,
) -> tuple[PlannerStatus, SearchType, Answer | None]:
    """
    Search until an answer is free in the caller's coordinates, or a limit is met.

    One so close to a corner that those coordinates round it into the obstacle is none: then the
    search begins again, from another stream.

    Parameters
    ----------
    start : callable
        Starts the search of a number, 0 for the first.
    answer_of : callable
        Returns the answer of a solved search, None when it is not free.
    limits : Limits
        Of all searches together.

    """
    for salt in itertools.count():
        search = start(salt)
        status = limits.run(search)
        if status is PlannerStatus.SOLVED:
            answer = answer_of(search)
            if answer is not None:
                return status, search, answer
            status = limits.stop() or status
        if status is not PlannerStatus.SOLVED:
            break
    return status, search, None


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
