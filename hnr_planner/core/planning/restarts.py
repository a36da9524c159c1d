"""Searches that are repeated until their path is free in the caller's coordinates."""

from collections.abc import Callable
from typing import TypeVar

from hnr_planner.core.planning.limits import Budget, run
from hnr_planner.core.planning.planner import Search
from hnr_planner.core.planning.result import PlannerStatus

SearchType = TypeVar('SearchType', bound=Search)
Found = TypeVar('Found')

#: Largest number of searches in a row, unless a caller sets another.
RESTARTS_MAX = 100


def search_until_free(
    start: Callable[[int], SearchType],
    found_by: Callable[[SearchType], Found | None],
    budget: Budget,
    searches_max: int = RESTARTS_MAX,
) -> tuple[PlannerStatus, SearchType, Found | None]:
    """
    Search until a path is free in the caller's coordinates; return (status, search, found).

    A path so close to a corner that the caller's coordinates round it into the obstacle does not
    count: then the search is repeated with another random stream, with at most ``searches_max``
    searches in all; one that draws nothing (``PathSearch.taut``) would find the same path again.
    ``found`` is None where a limit was met or no path was found.

    Parameters
    ----------
    start : callable
        Returns a new search with the random stream number ``k``, 0 for the first.
    found_by : callable
        Returns the path, or other result, of a solved search; None when that is not free in the
        caller's coordinates.
    budget : Budget
        Limits on the work: the deadline holds for all searches together, ``max_iterations`` for
        each of them.
    searches_max : int
        Largest number of searches.

    """
    for salt in range(searches_max):
        search = start(salt)
        status = run(search, budget)
        if status is PlannerStatus.SOLVED:
            found = found_by(search)
            if found is not None:
                return status, search, found
            status = budget.stop() or status
        if status is not PlannerStatus.SOLVED:
            return status, search, None
        if getattr(search, 'taut', False):
            break
    return PlannerStatus.ITERATION_LIMIT, search, None
