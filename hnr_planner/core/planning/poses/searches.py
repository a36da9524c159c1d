"""
Searches for one request for a path of poses.

What a path costs depends on how the robot gets out of its start and into its goal, which differs
from search to search. So searches are *raced*: the path of each is shortened roughly, and the
cheapest one to the end. The answer is the winner of one race, unless the first search was long;
while the caller asks for a cheaper path, further races are run.

Each search has its own random streams, so that its result does not depend on those before it.
"""

from dataclasses import dataclass, replace
from functools import cached_property, reduce
import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.clock import working_time
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.planning.limits import Budget, run
from hnr_planner.core.planning.planner import Work
from hnr_planner.core.planning.poses.connections import cost_of, empty_connections
from hnr_planner.core.planning.poses.found_path import path_for_caller, PosePath
from hnr_planner.core.planning.poses.guide import detour_guide, shortest_guide
from hnr_planner.core.planning.poses.request import PoseRequest
from hnr_planner.core.planning.poses.search import PoseSearch
from hnr_planner.core.planning.poses.shorten import shorten_path, SPARE_ROWS
from hnr_planner.core.planning.poses.trees import PoseProblem
from hnr_planner.core.planning.restarts import search_until_free
from hnr_planner.core.planning.result import FirstSolution, PlannerStatus
from hnr_planner.core.spaces.poses.disc import Disc
import numpy as np

#: Purposes of random streams.
SEARCH, ROUGH, SHORTEN = 0, 1, 2
#: Sections that are tried at once, for each motion of a path and at least.
TRIES_PER_MOTION, TRIES_MIN = 4, 40
#: Rounds of tries for one path, and consecutive rounds that lower the cost by less than the
#: fraction ``LEAST_GAIN`` after which it counts as short.
ROUNDS_MAX, PATIENCE, LEAST_GAIN = 60, 3, 2e-3
#: Rounds of tries after which the paths of a race are compared: they take about 30 % of the time,
#: and most paths become less than 5 % cheaper after them.
ROUGH_ROUNDS = 1
#: Number of searches in a race, and number of transitions after which the first race gets no
#: further search: then another path is not worth the wait.
N_RACED, TRANSITIONS_MAX = 3, 1000
#: Largest number of searches, where the caller's coordinates round a path into an obstacle.
RESTARTS_MAX = 20
#: Number of the first search of the further races.
FURTHER = RESTARTS_MAX + N_RACED


class PoseAttempt(NamedTuple):
    """
    One search, and the path that resulted from it.

    Attributes
    ----------
    number : int
        Number of the search, which selects its random streams.
    status : PlannerStatus
        How the search ended.
    search : PoseSearch
        The search in the state in which it ended.
    path : PosePath or None
        The path, shortened roughly or to the end where the request asks for it; None where there
        is none that is free in the caller's coordinates.
    first : FirstSolution or None
        The path as found, that of the first search in the winner of a race; None where there is
        no path.

    """

    number: int
    status: PlannerStatus
    search: PoseSearch
    path: PosePath | None
    first: FirstSolution | None

    @property
    def cost(self) -> float:
        """Cost of the path [cells]; inf where there is none."""
        return math.inf if self.path is None else self.path.cost


@dataclass(frozen=True)
class PoseSearches:
    """
    The searches for one request.

    Attributes
    ----------
    request : PoseRequest
        The request.
    disc : Disc
        The largest disc in the footprint, whose shortest path guides the searches.
    roots : (k, 3)
        The start, then the goals that may be reached, kernel frame.
    budget : Budget
        Limits on the work for the request.
    began : float
        Time at which the call began, on the clock of ``working_time`` [s].

    """

    request: PoseRequest
    disc: Disc
    roots: Floats
    budget: Budget
    began: float

    def first(self) -> tuple[PoseAttempt, Work]:
        """
        Return the winner of the first race, and the work of its searches.

        A path that the caller's coordinates round into an obstacle does not count: then the search
        is repeated, at most ``RESTARTS_MAX`` times in all. The path is None where none was found.
        """
        searches: list[PoseSearch] = []

        def start(salt: int) -> PoseSearch:
            searches.append(self._search(salt))
            return searches[-1]

        status, search, path = search_until_free(start, self._free_path, self.budget, RESTARTS_MAX)
        work, number = reduce(Work.plus, map(Work.of, searches)), len(searches) - 1
        found = self._attempt(number, status, search, path, self.budget)
        is_raced = self.request.simplify and 0.0 < found.cost < math.inf
        if not is_raced or search.iterations > TRANSITIONS_MAX:
            return self._finished(found, self.budget), work
        budget = replace(
            self.budget, max_iterations=min(self.budget.max_iterations, TRANSITIONS_MAX)
        )
        best, work = self._race([found], work, range(number + 1, number + N_RACED), budget)
        self.budget.cut = self.budget.cut or budget.cut
        return best._replace(first=found.first), work

    def optimize(
        self, found: PoseAttempt, work: Work, rounds: float, budget: Budget
    ) -> tuple[PoseAttempt, Work]:
        """
        Run further races; return the cheapest attempt, and the work of all searches.

        The races end after ``rounds`` searches, or once a limit of the budget is met.
        """
        best, n = found, 0
        while n < rounds and budget.stop() is None:
            end = int(min(n + N_RACED, rounds))
            again, work = self._race([], work, range(FURTHER + n, FURTHER + end), budget)
            best, n = min(best, again, key=lambda each: each.cost), end
        return best._replace(first=found.first), work

    def _race(
        self, attempts: list[PoseAttempt], work: Work, numbers: range, budget: Budget
    ) -> tuple[PoseAttempt, Work]:
        """
        Race attempts with the searches of some numbers, within a budget.

        Return the cheapest of all, its path shortened to the end, and the work with that of the
        searches added to it.
        """
        for number in numbers:
            search = self._search(number)
            status = run(search, budget)
            path = self._free_path(search) if status is PlannerStatus.SOLVED else None
            attempts.append(self._attempt(number, status, search, path, budget))
            work = work.plus(Work.of(search))
        return self._finished(min(attempts, key=lambda each: each.cost), budget), work

    def _search(self, number: int) -> PoseSearch:
        """Return the search of a number, which has not begun."""
        request, rng = self.request, self.request.stream(SEARCH, number)
        return PoseSearch(self._problem, request.proposals, self.roots, rng, self._other_guide)

    def _free_path(self, search: PoseSearch) -> PosePath | None:
        """Return the path of a solved search; None where it is not free for the caller."""
        return _checked(self.request, *search.path)

    def _attempt(
        self,
        number: int,
        status: PlannerStatus,
        search: PoseSearch,
        path: PosePath | None,
        budget: Budget,
    ) -> PoseAttempt:
        """Return what became of a search; its path is shortened roughly."""
        if path is None:
            return PoseAttempt(number, status, search, None, None)
        first = FirstSolution(working_time() - self.began, path.length, path.poses)
        rng = self.request.stream(ROUGH, number)
        path = _shortened(self.request, path, rng, ROUGH_ROUNDS, budget)
        return PoseAttempt(number, status, search, path, first)

    def _finished(self, attempt: PoseAttempt, budget: Budget) -> PoseAttempt:
        """Return an attempt, its path shortened to the end."""
        if attempt.path is None:
            return attempt
        rng = self.request.stream(SHORTEN, attempt.number)
        path = _shortened(self.request, attempt.path, rng, ROUNDS_MAX, budget)
        return attempt._replace(path=path)

    @cached_property
    def _guide(self) -> Floats:
        """The shortest path (k, 3) of the disc; (0, 3) for a planner that follows no guide."""
        if self.request.proposals.guided == 0.0:
            return np.empty((0, 3))
        return shortest_guide(self.disc, self.roots[0], self.roots[1], self.budget)

    @cached_property
    def _problem(self) -> PoseProblem:
        """The problem in the kernel frame."""
        return self.request.problem(self._guide, self.disc)

    def _other_guide(self, turn: int, stuck: Floats) -> Floats:
        """Return the guide (k, 3) after ``turn`` others, mostly one around the point ``stuck``."""
        if turn % 3 == 0:
            return self._guide
        request, stride = self.request, self.request.space.data.stride
        start, goal = self.roots[0], self.roots[1]
        return detour_guide(
            self.disc, start, goal, stuck, stride, self.budget, request.seed + turn
        )


def _checked(request: PoseRequest, poses: Floats, twists: Floats) -> PosePath | None:
    """Return a path of the kernel frame in the caller's, or None where it is not free there."""
    space = request.space
    *path, is_free = path_for_caller(
        space.data, space.frame, request.prices, poses, twists, request.start, request.goal
    )
    return PosePath(*path) if is_free else None


def _shortened(
    request: PoseRequest, path: PosePath, rng: Stream, rounds: int, budget: Budget
) -> PosePath:
    """
    Return a path with sections replaced by cheaper ones, where the request asks for it.

    At most a number of rounds of tries is made, within the budget.
    """
    if not request.simplify or path.cost == 0.0:
        return path
    space, n = request.space, len(path.twists)
    rows = 2 * n + 4 * SPARE_ROWS
    poses, twists = np.zeros((rows + 1, 3)), np.zeros((rows, 3))
    poses[: n + 1] = space.to_kernel(path.poses)
    twists[:n] = space.twists_to_kernel(path.twists)
    spare = np.zeros((rows + 1, 3)), np.zeros((rows, 3))
    found, prices = empty_connections(), request.prices
    cost, idle = path.cost, 0
    for _ in range(rounds):
        if idle >= PATIENCE or budget.stop() is not None:
            break
        tries = max(TRIES_MIN, TRIES_PER_MOTION * n)
        n = int(shorten_path(space.data, prices, poses, twists, n, *spare, found, rng, tries))
        lower = float(cost_of(prices, twists, n, 1.0))
        idle = 0 if lower < (1.0 - LEAST_GAIN) * cost else idle + 1
        cost = lower
    shorter = _checked(request, poses[: n + 1].copy(), twists[:n].copy())
    return path if shorter is None or shorter.cost >= path.cost else shorter
