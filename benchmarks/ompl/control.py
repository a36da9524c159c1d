"""Run OMPL's control planners; ``control_planners.cpp`` describes the protocol."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from benchmarks.ompl.driver import native, Session
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Motion(NamedTuple):
    """Seconds of setup and solve, and times (m,), states (m, 4), controls (m - 1, 2) in cells."""

    seconds: float
    times: Floats
    states: Floats
    controls: Floats


class ControlSession(Session):
    """A running program for robots with inertia."""

    def __init__(self) -> None:
        super().__init__(native('control_planners'))

    def drive(self, planner: str, numbers: Iterable[float]) -> Motion:
        """Solve one request; its numbers are in cells."""
        self._say(' '.join([planner, *(f'{value:.17g}' for value in numbers)]))
        seconds, _, *words = self._line().split()
        rows = np.array(words, dtype=float).reshape(-1, 7)
        states = np.ascontiguousarray(rows[:, 1:5])
        return Motion(float(seconds), rows[:, 0], states, np.ascontiguousarray(rows[:-1, 5:]))
