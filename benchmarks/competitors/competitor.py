"""Define what a competitor is."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import NamedTuple

from benchmarks.problems import Floats, Problem

TIME_LIMIT = 1.0


class Missing(Exception):
    """A competitor cannot run on this machine; the message says what is missing."""


class Run(NamedTuple):
    """Time [s], and the path (m, 2) [m], (0, 2) for none."""

    seconds: float
    path: Floats


#: Answers requests (k, 2, 2) [m], the first with this seed, the next with the one after it.
Solver = Callable[[Floats, int], list[Run]]
#: Gets ready for a problem.
SolverOf = Callable[[Problem], AbstractContextManager[Solver]]


@dataclass(frozen=True)
class Competitor:
    """
    One participant of the comparison.

    Attributes
    ----------
    name : str
        As its field calls it.
    group : str
        Whose it is.
    aim : str
        What it is after: the 'first' path, or a 'short' one.
    solver : SolverOf or None
        Runs once; None for one that always wants a time.
    within : callable or None
        The same with so many seconds to use; None for one that ends when it is done.
    runs_least : int
        Runs that a full race gives it on every problem.

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
