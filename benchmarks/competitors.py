"""Who takes part: ours, OMPL's, grid search. Each answers requests and says how long it took."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from statistics import median
import time
from typing import Any, NamedTuple

from benchmarks import ompl
from benchmarks.grid_search import a_star, pull_string, wavefront
from benchmarks.problems import Floats, Problem
from hnr_planner.core import plan
import numpy as np

TIME_LIMIT = 1.0
RRT_STAR_TIME = 0.5
#: A wavefront's time on a small map is no time to optimize in [s].
LEAST_TIME = 1e-3
#: Runs that tell how long a wavefront takes.
CALIBRATION = 40


class Run(NamedTuple):
    """Seconds that it took, and the path (m, 2) [m], (0, 2) for none."""

    seconds: float
    path: Floats


#: Answers requests (k, 2, 2) [m], the first with this seed, the next with the one after it.
Solver = Callable[[Floats, int], list[Run]]


@dataclass(frozen=True)
class Competitor:
    """
    One that takes part.

    ``group`` is ours, OMPL or grid; ``aim`` is what it is after: the first path or a short one.
    """

    name: str
    group: str
    aim: str
    solver: Callable[[Problem], Any]  # a context manager that gives a Solver


def competitors(with_ompl: bool) -> list[Competitor]:
    """List all that can take part here."""
    shortened = {'algorithm': 'auto', 'simplify': True}
    ours = [
        Competitor('auto', 'ours', 'first', _ours(algorithm='auto', simplify=False)),
        Competitor('hit_and_run', 'ours', 'first', _ours(algorithm='hit_and_run', simplify=False)),
        Competitor('rrt', 'ours', 'first', _ours(algorithm='rrt', simplify=False)),
        Competitor('rrt_connect', 'ours', 'first', _ours(algorithm='rrt_connect', simplify=False)),
        Competitor('auto + simplify', 'ours', 'short', _ours(**shortened)),
        Competitor('auto, optimized', 'ours', 'short', _optimized),
    ]
    search = [
        Competitor('A*', 'grid', 'short', _grid(a_star)),
        Competitor('A* + string pulling', 'grid', 'short', _grid(_taut_a_star)),
        Competitor('wavefront', 'grid', 'short', _grid(wavefront)),
    ]
    if not with_ompl:
        return ours + search
    names = ('RRTConnect', 'BKPIECE1', 'KPIECE1', 'RRT', 'EST', 'SBL')
    others = [Competitor(name, 'OMPL', 'first', _ompl(name, TIME_LIMIT)) for name in names]
    shorter = _ompl('RRTConnect+simplify', TIME_LIMIT)
    others.append(Competitor('RRTConnect + simplify', 'OMPL', 'short', shorter))
    others.append(Competitor('RRT*', 'OMPL', 'short', _ompl('RRTstar', RRT_STAR_TIME)))
    return ours + others + search


def _ours(**settings: Any) -> Callable[[Problem], Any]:
    """Ours, the whole call of plan()."""

    @contextmanager
    def solver(problem: Problem) -> Iterator[Solver]:
        def solve(requests: Floats, seed: int) -> list[Run]:
            runs = []
            for number, (start, goal) in enumerate(requests):
                began = time.perf_counter()
                result = plan(
                    problem.space,
                    start,
                    goal,
                    time_limit=TIME_LIMIT,
                    seed=seed + number,
                    **settings,
                )
                runs.append(Run(time.perf_counter() - began, result.path))
            return runs

        yield solve

    return solver


@contextmanager
def _optimized(problem: Problem) -> Iterator[Solver]:
    """Ours, with what is left of a wavefront's time after the first path to shorten it."""
    with _ours(algorithm='auto')(problem) as simplified, _grid(wavefront)(problem) as waves:
        requests = np.resize(problem.requests, (CALIBRATION, 2, 2))
        spent, allowed = (
            median(run.seconds for run in solve(requests, 0)) for solve in (simplified, waves)
        )
    left = max(allowed, LEAST_TIME) - spent
    settings = {'optimize_for': left} if left > 0.0 else {}
    with _ours(algorithm='auto', **settings)(problem) as solve:
        yield solve


def _ompl(planner: str, seconds: float) -> Callable[[Problem], Any]:
    """Planner of OMPL: setup and solve, timed where they run."""

    @contextmanager
    def solver(problem: Problem) -> Iterator[Solver]:
        space = problem.space
        session = ompl.Session(space.data.free_distance == 0, seed=1)

        def solve(requests: Floats, seed: int) -> list[Run]:
            answers = session.solve(planner, seconds, list(space.to_kernel(requests)))
            return [Run(answer.seconds, space.from_kernel(answer.path)) for answer in answers]

        try:
            yield solve
        finally:
            session.close()

    return solver


def _grid(search: Callable[..., Floats]) -> Callable[[Problem], Any]:
    """Grid search, timed without the way between metres and cells."""

    @contextmanager
    def solver(problem: Problem) -> Iterator[Solver]:
        space = problem.space

        def solve(requests: Floats, seed: int) -> list[Run]:
            runs = []
            for start, goal in space.to_kernel(requests):
                began = time.perf_counter()
                path = search(space.data, start, goal)
                runs.append(Run(time.perf_counter() - began, space.from_kernel(path)))
            return runs

        solve(problem.requests[:1], 0)  # compiles
        yield solve

    return solver


def _taut_a_star(grid: Any, start: Floats, goal: Floats) -> Floats:
    return pull_string(grid, a_star(grid, start, goal))
