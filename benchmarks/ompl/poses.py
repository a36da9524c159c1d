"""Run OMPL's planners for a car with a footprint; ``pose_planners.cpp`` has the protocol."""

from __future__ import annotations

from typing import NamedTuple

from benchmarks.ompl.driver import Floats, native, Session, write_grid
from hnr_planner.core import PoseSpace
import numpy as np

#: Distance between the states of a motion that are tested [m].
STEP = 0.05


class Answer(NamedTuple):
    """Processor's seconds of setup and solve, and the length of the path [m], inf for none."""

    seconds: float
    length: float


class PoseSession(Session):
    """A running program for a car with a footprint."""

    def __init__(self) -> None:
        super().__init__(native('pose_planners'))

    def use_space(self, space: PoseSpace) -> None:
        """Set the map, the footprint and the turning radius of the next requests."""
        write_grid(self._file, space.data.free_distance == 0)
        outline = space.footprint / space.scale
        radius = space.drive.min_turning_radius / space.scale
        numbers = [radius, STEP / space.scale, len(outline), *outline.ravel()]
        self._say(' '.join([f'grid {self._file}', *(f'{value:.17g}' for value in numbers)]))

    def drive(self, planner: str, seconds: float, space: PoseSpace, ends: Floats) -> Answer:
        """Solve one request: start and goal (2, 3), map frame."""
        numbers = [seconds, *space.to_kernel(np.asarray(ends)).ravel()]
        self._say(' '.join([planner, *(f'{value:.17g}' for value in numbers)]))
        spent, length = map(float, self._line().split())
        return Answer(spent, length * space.scale)
