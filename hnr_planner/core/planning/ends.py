"""Ends of a request that may be moved: the goal within a tolerance, the start out of inflation."""

from dataclasses import replace
import math
from typing import NamedTuple

from hnr_planner.core.checks import check_number, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.planning.escape import escape_point
from hnr_planner.core.planning.request import outcome_without_search, Request
from hnr_planner.core.planning.result import PlannerStatus, PlanResult
from hnr_planner.core.spaces.grid.grid_space import GridSpace
from hnr_planner.core.spaces.space import Space
import numpy as np


class Allowance(NamedTuple):
    """
    Validated limits on how far the ends of a request may be moved.

    Attributes
    ----------
    goal_tolerance : float
        Distance [m] within which a goal that is blocked or cannot be reached is replaced by the
        nearest point that can be reached from the start; 0 where it may not be moved.
    start_escape : float
        Length [m] of the longest straight segment from a start that is not free to free space; 0
        where the start may not be moved.

    """

    goal_tolerance: float
    start_escape: float


def check_allowance(space: Space, goal_tolerance: float, start_escape: float) -> Allowance:
    """
    Return the validated allowance for a space, or raise RequestError.

    A ``goal_tolerance`` [m] above 0 needs a space with ``nearest_reachable``, and a
    ``start_escape`` [m] above 0 needs a ``GridSpace``.
    """
    allowance = Allowance(
        check_number('goal_tolerance', goal_tolerance, 0.0),
        check_number('start_escape', start_escape, 0.0),
    )
    has_nearest = callable(getattr(space, 'nearest_reachable', None))
    if allowance.goal_tolerance > 0.0 and not has_nearest:
        raise RequestError(
            f'goal_tolerance must be 0 in a {type(space).__name__}, which has no '
            f'nearest_reachable, got {allowance.goal_tolerance!r}'
        )
    if allowance.start_escape > 0.0 and not isinstance(space, GridSpace):
        raise RequestError(
            f'start_escape must be 0 in a {type(space).__name__}, which has no inflated cells, '
            f'got {allowance.start_escape!r}'
        )
    return allowance


class MovedRequest(NamedTuple):
    """
    A request whose ends were moved where that was allowed and needed.

    Attributes
    ----------
    request : Request
        The request with the ends as moved.
    outcome : (PlannerStatus, str) or None
        Outcome of the moved request where it needs no search (``outcome_without_search``); None
        where it needs one.
    start : (dim,)
        The start before it was moved, caller's frame [m].
    goal_offset : float
        Distance by which the goal was moved [m].
    escape : float
        Distance by which the start was moved [m].
    reasons : str
        Why the ends were moved or could not be moved: a suffix of the result's message; empty
        where no move was tried.

    """

    request: Request
    outcome: tuple[PlannerStatus, str] | None
    start: Floats
    goal_offset: float = 0.0
    escape: float = 0.0
    reasons: str = ''

    def restore_ends(self, result: PlanResult) -> PlanResult:
        """
        Return the result for the start before it was moved.

        Where the request is solved and the start was moved, all paths begin with the segment from
        the old start to the new one, and the lengths include it. The samples are left as they are.
        """
        if not self.reasons:  # no move was tried
            return result
        result = replace(result, message=result.message + self.reasons)
        if result.status is not PlannerStatus.SOLVED:
            return result
        result = replace(result, goal_offset=self.goal_offset)
        return result if self.escape == 0.0 else led_from(result, self.start, self.escape)


def led_from(result: PlanResult, start: Floats, escape: float) -> PlanResult:
    """
    Return a solved result as one from another ``start`` (dim,), ``escape`` [m] from its own.

    All paths begin with the segment from ``start``, and the lengths include it; the field
    ``escape`` is its length. The samples are left as they are.
    """

    def with_start(path: Floats) -> Floats:
        return np.vstack([start, path])

    first = result.first_solution
    if first is not None:
        first = first._replace(length=first.length + escape, path=with_start(first.path))
    return replace(
        result,
        path=with_start(result.path),
        length=result.length + escape,
        others=tuple(with_start(path) for path in result.others),
        first_solution=first,
        escape=escape,
        lower_bound=result.lower_bound + escape,
        clear_lower_bound=result.clear_lower_bound + escape,
        next_lower_bound=result.next_lower_bound + escape,
    )


def move_ends(request: Request, allowance: Allowance) -> MovedRequest:
    """
    Return a request with its ends moved where they are not free or not connected.

    The start is moved only if it is not free, and the goal only if it is not free or cannot be
    reached from the start, each by at most what ``allowance`` states. An end that has no other
    point within this distance stays where it is.
    """
    moved = MovedRequest(request, outcome_without_search(request), request.start)
    if moved.outcome is not None and allowance.start_escape > 0.0:
        moved = _with_free_start(moved, allowance.start_escape)
    if moved.outcome is not None and allowance.goal_tolerance > 0.0:
        moved = _with_reachable_goal(moved, allowance.goal_tolerance)
    return moved


def _with_free_start(moved: MovedRequest, radius: float) -> MovedRequest:
    """Move a start that is not free to a free point within ``radius`` [m], where there is one."""
    request, (status, why) = moved.request, moved.outcome or (None, '')
    if status is not PlannerStatus.INVALID_START or not isinstance(request.space, GridSpace):
        return moved
    outside = escape_point(request.space, request.start, request.goal, radius)
    if outside is None:
        failure = f'; no straight segment of {radius:g} m at most leads to free space'
        return moved._replace(reasons=moved.reasons + failure)
    escape = math.dist(request.start, outside)
    request = request.moved(start=outside)
    return moved._replace(
        request=request,
        outcome=outcome_without_search(request),
        escape=escape,
        reasons=f'{moved.reasons}; the start was moved by {escape:.4g} m because {why}',
    )


def _with_reachable_goal(moved: MovedRequest, tolerance: float) -> MovedRequest:
    """
    Move a goal that is blocked or out of reach to the nearest point that can be reached.

    The goal stays where it is if that point is farther away than ``tolerance`` [m]. A moved goal
    has no radius.
    """
    request, (status, why) = moved.request, moved.outcome or (None, '')
    if status not in (PlannerStatus.INVALID_GOAL, PlannerStatus.UNREACHABLE):
        return moved
    space: GridSpace = request.space  # type: ignore[assignment]  # or one with the same method
    nearest = space.nearest_reachable(request.start, request.goal, tolerance)
    if nearest is None:
        failure = f'; nothing within {tolerance:g} m of it can be reached'
        return moved._replace(reasons=failure + moved.reasons)
    offset = math.dist(nearest, request.goal)
    # The end has been moved already: a region around it would move it once more.
    request = request.moved(goal=nearest, goal_radius=0.0)
    return moved._replace(
        request=request,
        outcome=outcome_without_search(request),
        goal_offset=offset,
        reasons=f'; the goal was moved by {offset:.4g} m because {why}{moved.reasons}',
    )
