"""Judge the paths: every path of every competitor is checked exactly against the map."""

from __future__ import annotations

from dataclasses import dataclass, field
from test.brute_force import path_collisions
from typing import NamedTuple

from benchmarks.competitors import Run
from benchmarks.problems import Problem
import numpy as np

#: Paths of each competitor and problem that the slow, independent checker sees too, and the
#: vertices that they have at most.
JUDGED_TWICE, VERTICES = 5, 200
#: Paths of each whose clearance is measured.
CLEARANCES = 60
#: How near a path has to begin and end to what was asked for [m].
NEAR = 1e-9


class Record(NamedTuple):
    """One run: request, time [s], length [m] (inf without a valid path), clearance [m] or nan."""

    request: int
    seconds: float
    length: float
    clearance: float
    found: bool


@dataclass
class Judge:
    """Judge of one competitor's runs on one problem, which keeps the faults it finds."""

    problem: Problem
    complaints: list[str] = field(default_factory=list)
    n_judged: int = 0

    def judge(self, number: int, run: Run) -> Record:
        """Measure the path for request ``number``, once it is known to be valid."""
        if len(run.path) == 0:
            return Record(number, run.seconds, np.inf, np.nan, False)
        self.n_judged += 1
        path = run.path.copy()
        wrong = self._ends(number, path) or self._collisions(number, path)
        self.complaints += wrong
        if wrong:
            return Record(number, run.seconds, np.inf, np.nan, True)
        measured = self.n_judged <= CLEARANCES
        clearance = self.problem.space.path_clearance(path) if measured else np.nan
        length = float(np.hypot(*np.diff(path, axis=0).T).sum())
        return Record(number, run.seconds, length, clearance, True)

    def _ends(self, number: int, path: np.ndarray) -> list[str]:
        """Report wrong ends; replace ends that are right up to rounding by the requested ones."""
        ends = self.problem.requests[number]
        if np.abs(path[[0, -1]] - ends).max() > NEAR:
            return [f'the path from {path[0]} to {path[-1]} has other ends than {ends}']
        path[[0, -1]] = ends
        return []

    def _collisions(self, number: int, path: np.ndarray) -> list[str]:
        space = self.problem.space
        segment = space.first_blocked_segment(path)
        if segment is not None:
            return [f'segment {segment} of the path for request {number} is blocked']
        if self.n_judged <= JUDGED_TWICE and len(path) <= VERTICES:
            return path_collisions(path, space.blocked, space.resolution, space.origin)
        return []
