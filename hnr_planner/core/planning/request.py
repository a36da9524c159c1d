"""Validation of planning requests, and the outcome of the requests that need no search."""

from dataclasses import replace
import math
from typing import Any, NamedTuple

from hnr_planner.core.cancellation import Event
from hnr_planner.core.checks import check_count, check_number, check_point, check_seed, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream, stream
from hnr_planner.core.planning.limits import Budget
from hnr_planner.core.planning.planner import (
    for_space,
    make_problem,
    Planner,
    Problem,
    reaches_goal,
)
from hnr_planner.core.planning.registry import make_planner
from hnr_planner.core.planning.result import PlannerStatus
from hnr_planner.core.spaces.lines import check_straight_lines
from hnr_planner.core.spaces.primitives import component
from hnr_planner.core.spaces.space import Space
from numpy.typing import ArrayLike

#: Rounds of optimization for each second of ``optimize_for``, and consecutive rounds without a
#: gain that end it. On an office map a round takes about a millisecond on a busy machine, so the
#: number of rounds nearly always ends the optimization before the clock does;
#: after five rounds without a gain, .02 % of the length are left to gain.
ROUNDS_PER_SECOND, PATIENCE = 300, 5
#: Largest clearance that may be requested [m].
CLEARANCE_MAX = 1e6


class Effort(NamedTuple):
    """
    Limits on the work for one request, as its caller gave them.

    Attributes
    ----------
    time_limit : float
        Time for the whole call [s]; may be inf.
    max_iterations : float
        Transitions allowed for one search; may be inf.
    optimize_for : float
        Time from the beginning of the call after which no further search for a shorter path goes
        on [s]; 0 when left out.
    optimize_iterations : int
        Largest number of further searches for a shorter path; 0 when left out.
    cancel : Event or None
        Event that ends the call once the event is set.

    """

    time_limit: float
    max_iterations: float
    optimize_for: float
    optimize_iterations: int
    cancel: Event | None

    @property
    def optimizes(self) -> bool:
        """Whether the call goes on searching for a shorter path after the first one."""
        return self.optimize_for > 0.0 or self.optimize_iterations > 0

    @property
    def optimize_rounds(self) -> float:
        """
        Largest number of further searches for a shorter path; inf for no limit.

        It is ``optimize_iterations`` where that is above 0; else it is in proportion to
        ``optimize_for``.
        """
        if self.optimize_iterations == 0 and self.optimize_for < math.inf:
            return math.ceil(ROUNDS_PER_SECOND * self.optimize_for)
        return self.optimize_iterations or math.inf

    @property
    def optimize_patience(self) -> float:
        """
        Number of consecutive searches without a gain that end the optimization.

        It is inf, no limit, where ``optimize_iterations`` is above 0.
        """
        return PATIENCE if self.optimize_iterations == 0 else math.inf

    def budget(self, began: float) -> Budget:
        """Return the budget of a call that began at ``began``, on the clock ``working_time``."""
        return Budget(began + self.time_limit, self.max_iterations, self.cancel)

    def optimizing(self, budget: Budget, began: float) -> Budget:
        """
        Return ``budget`` with its deadline at most ``optimize_for`` seconds after ``began``.

        This is the budget of the further searches for a shorter path. ``began`` is the time on
        the clock of ``working_time`` [s] at which the call began. The deadline stays as it is
        where ``optimize_for`` is 0.
        """
        until = began + (self.optimize_for or math.inf)
        return replace(budget, deadline=min(budget.deadline, until))


def check_effort(
    *,
    time_limit: float,
    max_iterations: int | None,
    optimize_for: float,
    optimize_iterations: int,
    cancel: Event | None,
) -> Effort:
    """Return a caller's limits on the work, or raise RequestError where one is malformed."""
    if cancel is not None and not callable(getattr(cancel, 'is_set', None)):
        raise RequestError(f'cancel must be an event such as threading.Event(), got {cancel!r}')
    return Effort(
        check_number('time_limit', time_limit, 0.0),
        math.inf if max_iterations is None else check_count('max_iterations', max_iterations, 1),
        check_number('optimize_for', optimize_for, 0.0),
        check_count('optimize_iterations', optimize_iterations, 0),
        cancel,
    )


class Request(NamedTuple):
    """
    A validated request for a path.

    Attributes
    ----------
    space : Space
        Where the path has to be free.
    start, goal : (dim,)
        Points in the caller's frame [m].
    goal_radius : float
        Radius of the goal region around ``goal`` [m]; 0 for a path that ends exactly at ``goal``.
    planner : Planner
        The planner that searches.
    simplify : bool
        Whether the path is shortened.
    clearance : float
        Distance to obstacles [m] that the path keeps where there is room for it; 0 for none.
    seed : int
        Seed from which every random stream of the request follows.
    problem : Problem
        The same problem in the kernel frame.

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

    @property
    def straight_length(self) -> float:
        """Straight distance [m] from the start to the goal region: no path is shorter."""
        distance = math.dist(self.start.tolist(), self.goal.tolist())
        return max(distance - self.goal_radius, 0.0)

    def stream(self, *purpose: int) -> Stream:
        """Return the random stream that follows from the seed and the numbers of a purpose."""
        return stream(self.seed, *purpose)

    def moved(
        self,
        start: Floats | None = None,
        goal: Floats | None = None,
        goal_radius: float | None = None,
    ) -> 'Request':
        """
        Return the request with another start (dim,), goal (dim,) or goal radius, caller's frame.

        An argument that is None keeps the value of this request.
        """
        start, goal = (b if a is None else a for a, b in ((start, self.start), (goal, self.goal)))
        goal_radius = self.goal_radius if goal_radius is None else goal_radius
        problem = make_problem(self.space, start, goal, goal_radius)
        return self._replace(start=start, goal=goal, goal_radius=goal_radius, problem=problem)


def check_request(
    space: Space,
    start: ArrayLike,
    goal: ArrayLike,
    *,
    goal_radius: float,
    simplify: bool,
    seed: int | None,
    clearance: float = 0.0,
    algorithm: str | Planner = 'auto',
    settings: dict[str, Any] | None = None,
) -> Request:
    """
    Return the validated request for a path, or raise RequestError where an argument is malformed.

    Whether start and goal are free is not checked here: see ``outcome_without_search``.
    """
    check_straight_lines(space, 'plan_trajectory')
    start, goal = check_point('start', start, space.dim), check_point('goal', goal, space.dim)
    goal_radius = check_number('goal_radius', goal_radius, 0.0)
    planner = for_space(make_planner(algorithm, settings or {}), space)
    return Request(
        space,
        start,
        goal,
        goal_radius,
        planner,
        bool(simplify),
        _check_clearance(space, clearance, simplify),
        check_seed(seed),
        make_problem(space, start, goal, goal_radius),
    )


def _check_clearance(space: Space, clearance: float, simplify: bool) -> float:
    """
    Return the clearance [m], or raise RequestError.

    A clearance above 0 needs a space that measures the distance to its walls, and ``simplify``.
    """
    clearance = check_number('clearance', clearance, 0.0, CLEARANCE_MAX)
    if clearance > 0.0 and space.walls is None:
        raise RequestError(
            f'clearance must be 0 in a {type(space).__name__}, which does not measure '
            f'the distance to its walls, got {clearance!r}'
        )
    if clearance > 0.0 and not simplify:
        raise RequestError(f'clearance must be 0 when simplify is false, got {clearance!r}')
    return clearance


def outcome_without_search(request: Request) -> tuple[PlannerStatus, str] | None:
    """
    Return the status of a request that needs no search, and the reason; None where it needs one.

    No search is needed when the start is not free, when the start reaches the goal directly, or
    when the component of the start, a connected part of free space, holds neither the goal nor,
    with a radius above 0, a point of the goal region.
    """
    space, start, goal = request.space, request.start, request.goal
    start_component, goal_component, reached = _components_of_ends(request.problem)
    if start_component == 0:
        message = f'start {in_words(start)} is {space.why_not_free(start)}'
        return PlannerStatus.INVALID_START, message
    if reached:
        return PlannerStatus.SOLVED, f'start {in_words(start)} reaches the goal directly'
    if start_component == goal_component:
        return None
    if goal_component == 0 and request.goal_radius == 0.0:
        message = f'goal {in_words(goal)} is {space.why_not_free(goal)}'
        return PlannerStatus.INVALID_GOAL, message
    around = ''
    if request.goal_radius > 0.0:
        if space.region_reachable(start, goal, request.goal_radius):
            return None
        around = f' or within {request.goal_radius:g} m of it'
    message = f'no path exists from start {in_words(start)} to goal {in_words(goal)}{around}'
    status = PlannerStatus.UNREACHABLE if goal_component else PlannerStatus.INVALID_GOAL
    return status, message


@kernel
def _components_of_ends(problem):
    """
    Return the components of start and goal, and whether the start reaches the goal directly.

    A component is the number of a connected part of free space; 0 for a point that is not free.
    """
    start_component = component(problem.space, problem.start)
    goal_component = component(problem.space, problem.goal)
    reached = start_component != 0 and reaches_goal(problem, problem.start)
    return start_component, goal_component, reached


def in_words(point: Floats) -> str:
    """Return the coordinates of a point (dim,) in round brackets, for a message."""
    return '(' + ', '.join(f'{x:g}' for x in point.tolist()) + ')'
