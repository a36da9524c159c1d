"""Check every path of every competitor exactly against the map, and measure it."""

from __future__ import annotations

from dataclasses import dataclass, field
from test.brute_force import path_collisions
from typing import NamedTuple

from benchmarks.competitors import Run
from benchmarks.problems import Problem
import numpy as np

#: Paths of each competitor and problem that the slow, independent checker verifies as well, and
#: the largest number of vertices that it takes.
JUDGED_TWICE, VERTICES = 5, 200
#: Paths of each competitor and problem whose clearance is measured.
CLEARANCES = 60
#: Largest distance of the ends of a path from start and goal [m].
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
    """Checker of one competitor's paths on one problem; ``complaints`` has the faults found."""

    problem: Problem
    complaints: list[str] = field(default_factory=list)
    n_judged: int = 0

    def judge(self, number: int, run: Run) -> Record:
        """Check the path of a run for request ``number``, and measure it if it is valid."""
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
