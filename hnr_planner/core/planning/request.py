"""A planning request at the door: clean numbers, and what needs no search to be answered."""

from dataclasses import dataclass
from typing import Any

from hnr_planner.core.checks import check_number, check_point, check_seed, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream, stream
from hnr_planner.core.planning.planner import make_problem, Planner, Problem, reaches_goal
from hnr_planner.core.planning.registry import make_planner
from hnr_planner.core.planning.result import PlannerStatus
from hnr_planner.core.spaces.primitives import component
from hnr_planner.core.spaces.space import Space
from numpy.typing import ArrayLike


@dataclass(frozen=True)
class Request:
    """
    A request whose numbers are clean.

    Attributes
    ----------
    space : Space
        Where the path has to be free.
    start, goal : (dim,)
        Caller's frame.
    goal_radius : float
        Caller's units.
    planner : Planner
        Who searches.
    simplify : bool
        Whether the path is shortened.
    clearance : float
        Distance to obstacles that the path keeps where there is room, caller's units.
    seed : int
        What every draw follows from.
    problem : Problem
        The same in the kernel frame.

    """

    space: Space
    start: Floats
    goal: Floats
    goal_radius: float
    planner: Planner
    simplify: bool
    clearance: float
    seed: int
    problem: Problem

    def stream(self, *purpose: int) -> Stream:
        """Return the random stream for one purpose: each has its own, all follow from the seed."""
        return stream(self.seed, *purpose)


def check_request(
    space: Space,
    start: ArrayLike,
    goal: ArrayLike,
    goal_radius: float,
    algorithm: str | Planner,
    settings: dict[str, Any],
    simplify: bool,
    seed: int | None,
) -> Request:
    """Return the request that a caller's arguments make, or raise RequestError."""
    start, goal = check_point('start', start, space.dim), check_point('goal', goal, space.dim)
    goal_radius = check_number('goal_radius', goal_radius, 0.0)
    planner = make_planner(algorithm, settings)
    return Request(
        space,
        start,
        goal,
        goal_radius,
        planner,
        bool(simplify),
        _check_clearance(space, planner, simplify),
        check_seed(seed),
        make_problem(space, start, goal, goal_radius),
    )


def _check_clearance(space: Space, planner: Planner, simplify: bool) -> float:
    """Return the clearance that a planner asks for, or raise RequestError."""
    clearance = getattr(planner, 'clearance', 0.0)  # a setting that only some planners have
    if clearance > 0.0 and space.walls is None:
        raise RequestError(
            f'clearance must be 0 in a {type(space).__name__}, which does not know how far '
            f'its walls are, got {clearance!r}'
        )
    if clearance > 0.0 and not simplify:
        raise RequestError(f'clearance must be 0 when simplify is false, got {clearance!r}')
    return float(clearance)


def outcome_without_search(request: Request) -> tuple[PlannerStatus, str] | None:
    """
    Say how a request ends that needs no search, and why; None for one that does.

    An end that is not free, no way between the two, or a start that reaches the goal as it is.
    """
    space, start, goal = request.space, request.start, request.goal
    start_part, goal_part, reached = _look(request.problem)
    if start_part == 0:
        message = f'start {_words(start)} is {space.why_not_free(start)}'
        return PlannerStatus.INVALID_START, message
    if reached:
        return PlannerStatus.SOLVED, f'start {_words(start)} reaches the goal directly'
    if start_part == goal_part:
        return None
    if goal_part == 0 and request.goal_radius == 0.0:
        message = f'goal {_words(goal)} is {space.why_not_free(goal)}'
        return PlannerStatus.INVALID_GOAL, message
    around = ''
    if request.goal_radius > 0.0:
        if space.region_reachable(start, goal, request.goal_radius):
            return None
        around = f' or within {request.goal_radius:g} m of it'
    message = f'no path exists from start {_words(start)} to goal {_words(goal)}{around}'
    return (PlannerStatus.UNREACHABLE if goal_part else PlannerStatus.INVALID_GOAL), message


@kernel
def _look(problem):
    """Parts of the space that hold start and goal, 0 for none; whether one reaches the other."""
    start_part = component(problem.space, problem.start)
    goal_part = component(problem.space, problem.goal)
    return start_part, goal_part, start_part != 0 and reaches_goal(problem, problem.start)


def _words(point: Floats) -> str:
    return '(' + ', '.join(f'{x:g}' for x in point) + ')'
