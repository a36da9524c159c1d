"""Run OMPL in n dimensions; ``dimensions.cpp`` describes the protocol."""

from __future__ import annotations

from benchmarks.ompl.driver import Answer, Floats, native, Session
import numpy as np


class DimensionsSession(Session):
    """A running program for problems in n dimensions."""

    def __init__(self) -> None:
        super().__init__(native('dimensions'))

    def enter(self, course: str) -> None:
        """Set the free space of the next requests, by the line that describes it."""
        self._say(course)

    def plan(self, planner: str, limit: float, request: Floats) -> Answer:
        """Solve a request (2, dim) within ``limit`` [s]: seconds, and path (m, dim)."""
        self._say(' '.join([planner, *(f'{x:.17g}' for x in (limit, *request.ravel()))]))
        seconds, _, *words = self._line().split()
        return Answer(float(seconds), np.array(words, dtype=float).reshape(-1, request.shape[1]))
