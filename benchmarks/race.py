"""
Run every competitor on every problem, in turns, and judge every path.

Turns are short and rotate, so that other load on the machine affects all alike. A turn is a
few requests in a row: the first one after another competitor's turn finds cold caches, the others
do not. Competitors that can use a given time run again with each of several times.
"""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import dataclass, field
from typing import NamedTuple

from benchmarks.competitors import Competitor, Solver
from benchmarks.judge import Judge, Record
from benchmarks.problems import Floats, Problem
from benchmarks.progress import show
from hnr_planner.core import plan, simplify
from hnr_planner.experiments.grid_search import a_star, pull_string
import numpy as np

#: Largest number of requests in one turn, and about its time [s].
TURN, TURN_TIME = 50, 0.05
#: Largest number of runs of a request with a given time.
SEEDS_IN_TIME = 4


class Effort(NamedTuple):
    """
    Amount of measurement.

    Attributes
    ----------
    seconds : float
        Time for each competitor and problem [s].
    runs_least : int
        Least number of runs, whatever time they take, of competitors that want as many.
    runs_first, runs_short : int
        Largest number of runs of competitors that search for a first and for a short path.
    seconds_best : float
        Time of the long search for the best known length of each request [s].
    times : tuple of float
        Times for competitors that can use a given time [s].
    requests_in_time : int
        Largest number of requests on each problem with each of ``times``.

    """

    seconds: float
    runs_least: int
    runs_first: int
    runs_short: int
    seconds_best: float
    times: tuple[float, ...]
    requests_in_time: int


#: Effort of a full benchmark, and of a quick one.
FULL = Effort(1.0, 1000, 1000, 200, 0.25, (0.001, 0.004, 0.016, 0.064, 0.256), 10)
QUICK = Effort(0.15, 2, 100, 30, 0.05, (0.004, 0.064), 2)


@dataclass
class Entry:
    """A competitor on a problem: its runs, those by the time [s] they were given, its judge."""

    competitor: Competitor
    judge: Judge
    records: list[Record] = field(default_factory=list)
    in_time: dict[float, list[Record]] = field(default_factory=dict)
    spent: float = 0.0

    def wants_more(self, effort: Effort) -> bool:
        """Return whether another turn is due."""
        competitor, n_runs = self.competitor, len(self.records)
        most = effort.runs_first if competitor.aim == 'first' else effort.runs_short
        least = min(competitor.runs_least, effort.runs_least)
        return n_runs < least or (n_runs < most and self.spent < effort.seconds)

    def turn(self, problem: Problem, solver: Solver) -> None:
        """Run as many requests as fit into one turn."""
        n_runs = len(self.records)
        fitting = int(n_runs * TURN_TIME / self.spent) if n_runs else 1
        numbers = np.arange(n_runs, n_runs + min(max(fitting, 1), TURN)) % len(problem.requests)
        records = self._run(problem, solver, numbers, n_runs)
        self.spent += sum(record.seconds for record in records)
        self.records += records

    def run_in_time(self, problem: Problem, effort: Effort) -> None:
        """Run requests with each of the given times."""
        assert self.competitor.within
        n_requests = len(problem.requests)
        numbers = np.arange(min(effort.requests_in_time, SEEDS_IN_TIME * n_requests)) % n_requests
        for seconds in effort.times:
            with self.competitor.within(seconds)(problem) as solver:
                self.in_time[seconds] = self._run(problem, solver, numbers, 0)

    def _run(self, problem: Problem, solver: Solver, numbers: Floats, seed: int) -> list[Record]:
        runs = solver(problem.requests[numbers], seed)
        return [
            self.judge.judge(int(number), run) for number, run in zip(numbers, runs, strict=True)
        ]


@dataclass(frozen=True)
class Standing:
    """All entries on one problem, and the best known length [m] of each request."""

    problem: Problem
    entries: list[Entry]
    best: Floats


def race(problem: Problem, taking_part: list[Competitor], effort: Effort) -> Standing:
    """Run all competitors on one problem."""
    entries = [Entry(competitor, Judge(problem)) for competitor in taking_part]
    show(f'{problem.name}: looking for short paths')
    best = _best_known(problem, effort.seconds_best)
    _take_turns(problem, [entry for entry in entries if entry.competitor.solver], effort)
    for entry in entries:
        if entry.competitor.within:
            show(f'{problem.name}: {entry.competitor.label} with more and more time')
            entry.run_in_time(problem, effort)
        if not entry.competitor.solver:
            entry.records = entry.in_time[effort.times[-1]]
    for entry in entries:
        for record in [*entry.records, *(r for each in entry.in_time.values() for r in each)]:
            best[record.request] = min(best[record.request], record.length)
    return Standing(problem, entries, best)


def _take_turns(problem: Problem, entries: list[Entry], effort: Effort) -> None:
    with ExitStack() as stack:
        solvers = []
        for entry in entries:
            assert entry.competitor.solver
            solvers.append(stack.enter_context(entry.competitor.solver(problem)))
            solvers[-1](problem.requests[:1], 0)  # for the caches, not for the record
        while any(entry.wants_more(effort) for entry in entries):
            for entry, solver in zip(entries, solvers, strict=True):
                if entry.wants_more(effort):
                    entry.turn(problem, solver)
            waiting = [entry.competitor.label for entry in entries if entry.wants_more(effort)]
            left = f', still running: {", ".join(waiting[:3])}' if waiting else ''
            show(f'{problem.name}: {len(entries) - len(waiting)} of {len(entries)}{left}')


def _best_known(problem: Problem, seconds: float) -> Floats:
    """Return the best known length (k,) [m] of each request, from long searches and from A*."""
    space, lengths = problem.space, []
    for start, goal in problem.requests:
        long = plan(space, start, goal, optimize_for=seconds, time_limit=10.0, seed=0)
        cells = a_star(space.data, *space.to_kernel(np.stack([start, goal])))
        over_cells = space.from_kernel(pull_string(space.data, cells))
        taut = simplify(space, over_cells, seed=0)
        lengths.append(min(long.length, np.hypot(*np.diff(taut, axis=0).T).sum()))
    return np.array(lengths)
