"""
Attempts at a request: search, shorten, increase the clearance; repeat for a better path.

Each attempt has its own random streams, so that its result does not depend on the number or the
duration of earlier attempts.
"""

import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.clock import working_time
from hnr_planner.core.lengths import path_length
from hnr_planner.core.planning.limits import Budget
from hnr_planner.core.planning.planner import PathSearch, Work
from hnr_planner.core.planning.planners.auto import Auto
from hnr_planner.core.planning.planners.polyanya import Polyanya
from hnr_planner.core.planning.postprocessing.clearance import increase_clearance, path_cost
from hnr_planner.core.planning.postprocessing.simplify import shorten
from hnr_planner.core.planning.request import Request
from hnr_planner.core.planning.restarts import search_until_free
from hnr_planner.core.planning.result import FirstSolution, PlannerStatus, PROVED
from hnr_planner.core.planning.shortest import (
    in_caller_s_frame,
    KeptClear,
    lower_bound,
    NOT_SEARCHED,
    shortest_kept_clear,
    shortest_path,
)
from hnr_planner.core.spaces.grid.grid_space import GridSpace
import numpy as np

#: Least decrease of the cost of the best path, as a fraction of that cost, for which a further
#: search counts as a gain.
LEAST_GAIN = 1e-3
#: Purposes of random streams: to search for a path, and to shorten the path found.
SEARCH, SHORTEN = 0, 1


class Attempt(NamedTuple):
    """
    One search, and the path that resulted from it.

    Attributes
    ----------
    status : PlannerStatus
        How the search ended.
    search : PathSearch
        The search in the state in which it ended.
    path : (m, dim)
        The path in the caller's frame, improved; (0, dim) when none was found.
    cost : float
        Cost of ``path`` [m]: its length, weighted near walls where a clearance is requested; inf
        when no path was found or the budget ended before its cost was known.
    first : FirstSolution or None
        The path as found, before it was improved; None when no path was found.
    planner : str
        Name of the planner that made the path.
    lower_bound : float
        Lower bound on the length of free paths from start to goal [m].
    work : Work
        Work of the search, and of those for shortest paths where there were any.
    kept_clear : KeptClear
        Outcome of the search over the cells that keep the clearance.

    """

    status: PlannerStatus
    search: PathSearch
    path: Floats
    cost: float
    first: FirstSolution | None
    planner: str
    lower_bound: float
    work: Work
    kept_clear: KeptClear = NOT_SEARCHED

    @property
    def keeps_clearance(self) -> bool:
        """Whether the path is the one found over the cells that keep the clearance."""
        return self.path is self.kept_clear.path


def attempt(
    request: Request,
    number: int,
    budget: Budget,
    began: float,
    optimizing: Budget | None = None,
) -> Attempt:
    """
    Search once and improve the path that was found; return the attempt of least cost.

    ``number`` selects the random streams, and ``began`` is the time at which the call began, on
    the clock of ``working_time`` [s]. With a budget for ``optimizing`` the planner ``Auto`` also
    searches for the shortest path with Polyanya, where the space is a ``GridSpace`` and the path
    found is longer than the straight distance. With a clearance, it and ``Polyanya`` also search
    for the shortest path that keeps the clearance everywhere. The path of any other planner is
    only shortened and moved away from walls.
    """
    status, search, path = _search(request, number, budget)
    planner = getattr(search, 'made_by', request.planner.name)
    bound, work = lower_bound(request, search), Work.of(search)
    if status is not PlannerStatus.SOLVED:
        return Attempt(status, search, path, math.inf, None, planner, bound, work)
    first = FirstSolution(working_time() - began, path_length(path), path)
    exact_budget = _budget_of_exact_search(request, budget, optimizing)
    if exact_budget is not None:
        found = Attempt(status, search, path, first.length, first, planner, bound, work)
        return _best_of_exact(request, number, found, budget, exact_budget)
    improved = _improved(request, number, search, path, budget)
    return Attempt(status, search, *improved, first, planner, bound, work)


def _best_of_exact(
    request: Request, number: int, found: Attempt, budget: Budget, exact_budget: Budget
) -> Attempt:
    """
    Return the attempt of least cost after exact searches on a grid.

    They are for the shortest path, unless that of ``found`` is straight, and for the one that
    keeps the clearance requested, if any. Where they find nothing, and with a clearance in any
    case, the path of ``found`` is improved as without them.
    """
    candidates, bound, work, kept = [], found.lower_bound, found.work, NOT_SEARCHED
    if found.cost > PROVED * bound:
        exact, shortest = shortest_path(request, exact_budget)
        bound, work = lower_bound(request, exact), work.plus(Work.of(exact))
        if shortest is not None:
            path, cost = _with_cost(request, shortest, exact_budget)
            candidates.append(found._replace(path=path, cost=cost, planner=Polyanya.name))
    if request.clearance > 0.0:
        kept = shortest_kept_clear(request, exact_budget)
        work = work.plus(kept.work)
        if kept.path is not None:
            cost = _cost(request, kept.path, exact_budget)
            candidates.append(found._replace(path=kept.path, cost=cost, planner=Polyanya.name))
    if request.clearance > 0.0 or not candidates:
        path, cost = _improved(request, number, found.search, found.path, budget)
        candidates.append(found._replace(path=path, cost=cost))
    best = min(candidates, key=lambda candidate: candidate.cost)
    return best._replace(lower_bound=bound, work=work, kept_clear=kept)


def _budget_of_exact_search(
    request: Request, budget: Budget, optimizing: Budget | None
) -> Budget | None:
    """
    Return the budget for exact searches of a request; None where it has none.

    ``Auto`` has them while it optimizes, and ``Polyanya`` where a clearance is requested.
    """
    if not isinstance(request.space, GridSpace):
        return None
    if isinstance(request.planner, Auto):
        return optimizing
    is_exact = isinstance(request.planner, Polyanya)
    return budget if is_exact and request.clearance > 0.0 else None


def _improved(
    request: Request, number: int, search: PathSearch, path: Floats, budget: Budget
) -> tuple[Floats, float]:
    """
    Return a path (k, dim) shortened and moved away from walls as requested, and its cost [m].

    ``path`` (m, dim) is in the caller's frame. It is shortened only where the request asks for it
    and the search did not find a taut path.
    """
    if request.simplify and not search.taut and len(path) > 2:
        space, rng, found = request.space, request.stream(number, SHORTEN), path
        path = budget.within(lambda: shorten(space, found, rng, budget), found)
    return _with_cost(request, path, budget)


def _with_cost(request: Request, path: Floats, budget: Budget) -> tuple[Floats, float]:
    """
    Return a path (k, dim) moved away from walls as requested, and its cost [m].

    The cost is inf where a limit of the budget interrupts its computation.
    """
    if request.clearance == 0.0:
        return path, float(path_length(path))
    path = with_clearance(request, path, budget)
    return path, _cost(request, path, budget)


def _cost(request: Request, path: Floats, budget: Budget) -> float:
    """Return the cost [m] of a path (m, dim), caller's frame; inf where a limit interrupts it."""
    return budget.within(lambda: path_cost(request.space, path, request.clearance), math.inf)


def optimize(
    request: Request,
    best: Attempt,
    rounds: float,
    patience: float,
    budget: Budget,
    began: float,
) -> tuple[Attempt, Work]:
    """
    Search for better paths with further streams; return the best, and the work of all searches.

    Each round is one further attempt. The rounds end when ``best`` is straight, proved to be the
    shortest or found by a search that draws nothing, after ``rounds`` rounds, after ``patience``
    consecutive rounds that lower the cost by less than the fraction ``LEAST_GAIN``, or when a
    limit of the budget is met. ``began`` is the time at which the call began, on the clock of
    ``working_time`` [s].
    """
    work, number, idle = best.work, 1, 0
    while number <= rounds and idle < patience and budget.stop() is None:
        if _is_best(request, best):
            break
        again = attempt(request, number, budget, began)
        work = work.plus(again.work)
        number += 1
        idle = 0 if again.cost < (1.0 - LEAST_GAIN) * best.cost else idle + 1
        if again.cost < best.cost:
            best = again._replace(lower_bound=best.lower_bound, kept_clear=best.kept_clear)
    return best, work


def _is_best(request: Request, best: Attempt) -> bool:
    """Return whether no further search can find a better path than that of ``best``."""
    is_straight = len(best.path) == 2 and request.goal_radius == 0.0
    return is_straight or best.search.taut or best.cost <= PROVED * best.lower_bound


def with_clearance(request: Request, path: Floats, budget: Budget) -> Floats:
    """
    Return a path (k, dim) of the caller's frame moved away from walls, within the budget.

    It is ``path`` (m, dim) itself where the request has no clearance or a limit interrupts the
    work.
    """
    if request.clearance == 0.0:
        return path
    space, clearance = request.space, request.clearance
    return budget.within(lambda: increase_clearance(space, path, clearance, budget), path)


def _search(
    request: Request, number: int, budget: Budget
) -> tuple[PlannerStatus, PathSearch, Floats]:
    """
    Return the status of a search, the search, and its path (m, dim), caller's frame.

    The path is free in the caller's coordinates; it is (0, dim) where none was found.
    """

    def start(salt: int) -> PathSearch:
        return request.planner.start(request.problem, request.stream(number, SEARCH, salt))

    def free_path(search: PathSearch) -> Floats | None:
        found = search.path
        path = in_caller_s_frame(request, found)
        if getattr(search, 'tested', False) and (request.space.to_kernel(path) == found).all():
            return path
        return path if request.space.is_path_free(path) else None

    def found_by(search: PathSearch) -> Floats | None:
        return budget.within(lambda: free_path(search), None)

    status, search, path = search_until_free(start, found_by, budget)
    return status, search, np.empty((0, request.space.dim)) if path is None else path
