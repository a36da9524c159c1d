"""Types of the comparison: competitors, their solvers and their runs."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import NamedTuple

from benchmarks.problems import Floats, Problem

#: Time limit of one run [s].
TIME_LIMIT = 1.0


class Missing(Exception):
    """A competitor cannot run on this machine; the message says what is missing."""


class Run(NamedTuple):
    """Answer to one request: time [s], and the path (m, 2) [m], (0, 2) for none."""

    seconds: float
    path: Floats


#: Function that answers requests (k, 2, 2) [m]: request i with the given seed plus i.
Solver = Callable[[Floats, int], list[Run]]
#: Function that prepares a problem, and yields the solver for it.
SolverOf = Callable[[Problem], AbstractContextManager[Solver]]


@dataclass(frozen=True)
class Competitor:
    """
    A planner in the comparison.

    Attributes
    ----------
    name : str
        Name of the algorithm, as in the literature.
    group : str
        Origin of the implementation: 'ours', a build of OMPL, or 'grid'.
    aim : str
        What it searches for: the 'first' path, or a 'short' one.
    solver : SolverOf or None
        Solver that ends by itself; None for a planner that always uses a given time.
    within : callable or None
        Returns a solver that uses a given time [s]; None for a planner that ends by itself.
    runs_least : int
        Least number of runs on every problem in a full benchmark.

    """

    name: str
    group: str
    aim: str
    solver: SolverOf | None
    within: Callable[[float], SolverOf] | None = None
    runs_least: int = 3

    @property
    def label(self) -> str:
        """Name and group, for the report."""
        return f'{self.name} ({self.group})'
