"""
The race: every competitor on every problem, in turns, every path judged by the same checker.

Turns are short and go round, so that whatever else the machine does meets all alike. A turn is a
few requests in a row: what comes first after somebody else finds cold caches, the others do not.
"""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import dataclass, field
from test.brute_force import path_collisions
from typing import NamedTuple

from benchmarks.competitors import Competitor, Run, Solver
from benchmarks.grid_search import a_star, pull_string
from benchmarks.problems import Floats, Problem
from hnr_planner.core import plan, simplify
import numpy as np

#: Requests in one turn at most, and time [s] after which it ends, about.
TURN, TURN_TIME = 50, 0.05
#: Paths of each competitor and problem that the slow, independent checker sees too, and the
#: vertices that they have at most.
JUDGED_TWICE, VERTICES = 5, 200
#: Paths of each whose clearance is measured.
CLEARANCES = 60
#: How near a path has to begin and end to what was asked for [m].
NEAR = 1e-9


class Effort(NamedTuple):
    """How much to measure: seconds for each competitor and problem, and runs at least and most."""

    seconds: float
    runs_least: int
    runs_first: int
    runs_short: int
    seconds_best: float


FULL = Effort(2.0, 3, 1000, 200, 0.5)
QUICK = Effort(0.3, 2, 100, 40, 0.1)


class Record(NamedTuple):
    """One run: request, time [s], length [m] (inf without a valid path), clearance [m] or nan."""

    request: int
    seconds: float
    length: float
    clearance: float
    found: bool


@dataclass
class Entry:
    """A competitor on a problem: its runs, and the complaints of the checkers."""

    competitor: Competitor
    records: list[Record] = field(default_factory=list)
    complaints: list[str] = field(default_factory=list)
    spent: float = 0.0

    def wants_more(self, effort: Effort) -> bool:
        """Say whether another turn is due."""
        first = self.competitor.aim == 'first'
        n_runs, most = len(self.records), effort.runs_first if first else effort.runs_short
        return n_runs < effort.runs_least or (n_runs < most and self.spent < effort.seconds)

    def turn(self, problem: Problem, solver: Solver) -> None:
        """Answer some requests."""
        n_runs = len(self.records)
        fitting = int(n_runs * TURN_TIME / self.spent) if n_runs else 1
        numbers = np.arange(n_runs, n_runs + min(max(fitting, 1), TURN)) % len(problem.requests)
        runs = solver(problem.requests[numbers], n_runs)
        self.spent += sum(run.seconds for run in runs)
        self.records += [
            self._judge(problem, int(number), run)
            for number, run in zip(numbers, runs, strict=True)
        ]

    def _judge(self, problem: Problem, number: int, run: Run) -> Record:
        if len(run.path) == 0:
            return Record(number, run.seconds, np.inf, np.nan, False)
        space, path = problem.space, run.path.copy()
        ends = problem.requests[number]
        wrong = []
        if np.abs(path[[0, -1]] - ends).max() > NEAR:
            wrong.append(f'the path from {path[0]} to {path[-1]} has other ends than {ends}')
        path[[0, -1]] = ends
        segment = space.first_blocked_segment(path)
        if segment is not None:
            wrong.append(f'segment {segment} of request {number} is blocked')
        elif len(self.records) < JUDGED_TWICE and len(path) <= VERTICES:
            wrong += path_collisions(path, space.blocked, space.resolution, space.origin)
        self.complaints += wrong
        n_runs = len(self.records)
        clearance = space.path_clearance(path) if n_runs < CLEARANCES and not wrong else np.nan
        length = np.inf if wrong else float(np.hypot(*np.diff(path, axis=0).T).sum())
        return Record(number, run.seconds, length, clearance, True)


@dataclass(frozen=True)
class Standing:
    """All entries on one problem, and the best known length [m] of each request."""

    problem: Problem
    entries: list[Entry]
    best: Floats


def race(problem: Problem, taking_part: list[Competitor], effort: Effort) -> Standing:
    """Let all run on one problem."""
    entries = [Entry(competitor) for competitor in taking_part]
    best = _best_known(problem, effort.seconds_best)
    with ExitStack() as stack:
        solvers = [stack.enter_context(competitor.solver(problem)) for competitor in taking_part]
        for solver in solvers:
            solver(problem.requests[:1], 0)  # for the caches, not for the record
        while any(entry.wants_more(effort) for entry in entries):
            for entry, solver in zip(entries, solvers, strict=True):
                if entry.wants_more(effort):
                    entry.turn(problem, solver)
            _show_progress(problem, entries, effort)
    for record in (record for entry in entries for record in entry.records):
        best[record.request] = min(best[record.request], record.length)
    return Standing(problem, entries, best)


def _best_known(problem: Problem, seconds: float) -> Floats:
    """Short lengths (k,) [m], by long searches and from the shortest path over cells."""
    space, lengths = problem.space, []
    for start, goal in problem.requests:
        long = plan(space, start, goal, optimize_for=seconds, time_limit=10.0, seed=0)
        cells = a_star(space.data, *space.to_kernel(np.stack([start, goal])))
        over_cells = space.from_kernel(pull_string(space.data, cells))
        taut = simplify(space, over_cells, seed=0)
        lengths.append(min(long.length, np.hypot(*np.diff(taut, axis=0).T).sum()))
    return np.array(lengths)


def _show_progress(problem: Problem, entries: list[Entry], effort: Effort) -> None:
    waiting = [entry.competitor.name for entry in entries if entry.wants_more(effort)]
    n_done = len(entries) - len(waiting)
    left = f', still running: {", ".join(waiting[:3])}' if waiting else ''
    print(f'\r\033[K{problem.name}: {n_done} of {len(entries)}{left}', end='', flush=True)
