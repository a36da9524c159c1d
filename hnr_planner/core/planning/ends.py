"""Ends of a request that may be moved: the goal within a tolerance, the start out of inflation."""

from dataclasses import dataclass, replace
import math

from hnr_planner.core.checks import check_number, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.planning.escape import escape_point
from hnr_planner.core.planning.request import outcome_without_search, Request
from hnr_planner.core.planning.result import PlannerStatus, PlanResult
from hnr_planner.core.spaces.grid.grid_space import GridSpace
from hnr_planner.core.spaces.space import Space
import numpy as np


@dataclass(frozen=True)
class Allowance:
    """
    How far the ends of a request may be moved, validated.

    Attributes
    ----------
    goal_tolerance : float
        Distance [m] within which a goal that is blocked or cannot be reached is replaced by the
        nearest point that can be reached.
    start_escape : float
        Length [m] of the longest straight segment from a start in inflated cells to free space.

    """

    goal_tolerance: float
    start_escape: float


def check_allowance(space: Space, goal_tolerance: float, start_escape: float) -> Allowance:
    """Return the allowance that a caller's arguments make, or raise RequestError."""
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


@dataclass(frozen=True)
class MovedRequest:
    """
    A request whose ends were moved where that was allowed and needed.

    Attributes
    ----------
    request : Request
        The request with the ends as moved.
    outcome : (PlannerStatus, str) or None
        Its outcome when it needs no search (``outcome_without_search``).
    start : (dim,)
        The start before it was moved.
    goal_offset : float
        Distance by which the goal was moved [m].
    escape : float
        Distance by which the start was moved [m].
    reasons : str
        Why they were moved: a suffix of the result's message.

    """

    request: Request
    outcome: tuple[PlannerStatus, str] | None
    start: Floats
    goal_offset: float = 0.0
    escape: float = 0.0
    reasons: str = ''

    def restore_ends(self, result: PlanResult) -> PlanResult:
        """Return the result for the original start: its paths begin with the escape."""
        result = replace(result, message=result.message + self.reasons)
        if result.status is not PlannerStatus.SOLVED:
            return result
        result = replace(result, goal_offset=self.goal_offset)
        if self.escape == 0.0:
            return result
        first = result.first_solution
        if first is not None:
            first = first._replace(
                length=first.length + self.escape, path=self._with_start(first.path)
            )
        return replace(
            result,
            path=self._with_start(result.path),
            length=result.length + self.escape,
            others=tuple(self._with_start(path) for path in result.others),
            first_solution=first,
            escape=self.escape,
            lower_bound=result.lower_bound + self.escape,
        )

    def _with_start(self, path: Floats) -> Floats:
        return np.vstack([self.start, path])


def move_ends(request: Request, allowance: Allowance) -> MovedRequest:
    """
    Move the ends of a request where they are not free, within what is allowed.

    A goal that is free and can be reached is never moved.
    """
    moved = MovedRequest(request, outcome_without_search(request), request.start)
    if moved.outcome is not None and allowance.start_escape > 0.0:
        moved = _with_free_start(moved, allowance.start_escape)
    if moved.outcome is not None and allowance.goal_tolerance > 0.0:
        moved = _with_reachable_goal(moved, allowance.goal_tolerance)
    return moved


def _with_free_start(moved: MovedRequest, radius: float) -> MovedRequest:
    """Move a start that is not free to a free point within ``radius`` [m]."""
    request, (status, why) = moved.request, moved.outcome or (None, '')
    if status is not PlannerStatus.INVALID_START or not isinstance(request.space, GridSpace):
        return moved
    outside = escape_point(request.space, request.start, request.goal, radius)
    if outside is None:
        failure = f'; no straight segment of {radius:g} m at most leads to free space'
        return replace(moved, reasons=moved.reasons + failure)
    escape = math.dist(request.start, outside)
    request = request.moved(start=outside)
    return replace(
        moved,
        request=request,
        outcome=outcome_without_search(request),
        escape=escape,
        reasons=f'{moved.reasons}; the start was moved by {escape:.4g} m because {why}',
    )


def _with_reachable_goal(moved: MovedRequest, tolerance: float) -> MovedRequest:
    """Move a goal that cannot be reached to the nearest point that can, within ``tolerance``."""
    request, (status, why) = moved.request, moved.outcome or (None, '')
    if status not in (PlannerStatus.INVALID_GOAL, PlannerStatus.UNREACHABLE):
        return moved
    space: GridSpace = request.space  # type: ignore[assignment]  # or one with the same method
    nearest = space.nearest_reachable(request.start, request.goal, tolerance)
    if nearest is None:
        failure = f'; nothing within {tolerance:g} m of it can be reached'
        return replace(moved, reasons=failure + moved.reasons)
    offset = math.dist(nearest, request.goal)
    # The end has been moved already: a region around it would move it once more.
    request = request.moved(goal=nearest, goal_radius=0.0)
    return replace(
        moved,
        request=request,
        outcome=outcome_without_search(request),
        goal_offset=offset,
        reasons=f'; the goal was moved by {offset:.4g} m because {why}{moved.reasons}',
    )
