"""
Work on the requests of ``plan_many``: threads that share them in chunks.

Each request has a search of its own, so the results do not depend on the number of threads.
"""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.clock import working_time
from hnr_planner.core.kernels.modes import in_this_mode
from hnr_planner.core.planning.batch.requests import (
    DONE,
    FEW_NODES,
    FEW_POINTS,
    go_on,
    no_progress,
    Progress,
)
from hnr_planner.core.planning.limits import Budget
from hnr_planner.core.planning.planner import make_problem, Problem, with_capacity
from hnr_planner.core.planning.planners.cones import (
    empty_frontier,
    Frontier,
    with_more_rows,
)
from hnr_planner.core.planning.planners.polyanya import INITIAL_CAPACITY
from hnr_planner.core.planning.request import Effort
from hnr_planner.core.planning.result import PlannerStatus
from hnr_planner.core.spaces.grid.grid_space import GridSpace
import numpy as np

#: Requests that a thread takes at once.
CHUNK = 64
#: Cones expanded between two looks at the clock, in a millisecond or two.
CONES_AT_ONCE = 4096
#: Rows for vertices of paths, for each request of a chunk, at first.
POINTS = 16


def work(
    space: GridSpace, ends: Floats, goal_radius: float, effort: Effort, n_threads: int
) -> tuple[list[Progress], list[PlannerStatus]]:
    """
    Work on requests with ``ends`` (k, 2, 2), kernel frame, in threads.

    Returns the results of all chunks, in their order, and why threads stopped before the end.
    """
    rows = [slice(first, first + CHUNK) for first in range(0, max(len(ends), 1), CHUNK)]
    results = [no_progress(len(ends[each]), POINTS * CHUNK) for each in rows]
    problem = make_problem(space, np.zeros(2), np.zeros(2), goal_radius)
    waiting = iter(enumerate(rows))
    stops: list[PlannerStatus] = []

    def run() -> None:
        # The clock of a thread is its own: it leaves out what the thread waits for the compiler.
        worker = _Worker(space, problem, effort.budget(working_time()))
        for number, each in waiting:
            results[number] = worker.advance(ends[each], results[number])
        if worker.budget.cut:
            stops.append(worker.budget.stop() or PlannerStatus.TIMEOUT)

    n_threads = min(n_threads, len(rows))
    if n_threads == 1:
        run()
        return results, stops
    with ThreadPoolExecutor(n_threads) as pool:
        for done in [pool.submit(in_this_mode(run)) for _ in range(n_threads)]:
            done.result()
    return results, stops


@dataclass
class _Worker:
    """One thread's work on chunks of requests, in arrays that it uses for all of them."""

    space: GridSpace
    problem: Problem
    budget: Budget
    _frontier: Frontier | None = None

    def advance(self, ends: Floats, progress: Progress) -> Progress:
        """Work on the requests with ``ends`` (k, 2, 2) within the budget; return the results."""
        why = None
        while why != DONE and self.budget.stop() is None:
            why = self.budget.within(partial(self._go_on, ends, progress), None)
            if why == FEW_POINTS:
                rows = len(progress.points) + 1
                progress = progress._replace(points=with_capacity(progress.points, rows))
            elif why == FEW_NODES and self._frontier is not None:
                rows = len(self._frontier.nodes) + 1
                self._frontier = with_more_rows(self._frontier, rows)
        return progress

    def _go_on(self, ends: Floats, progress: Progress) -> int:
        slabs, most = self.space.slabs, self.budget.max_iterations
        if self._frontier is None:
            self._frontier = empty_frontier(slabs, INITIAL_CAPACITY)
        return go_on(self.problem, slabs, ends, most, self._frontier, progress, CONES_AT_ONCE)
