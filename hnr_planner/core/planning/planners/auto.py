"""
The default planner: Hit-and-Run from both ends, and a flood fill where that takes long.

In long strips and one-cell mazes random steps make little progress. A grid finds a path wherever
there is one by flood fill (``flood_path``), so that is used after more steps than nearly all
searches take. The samples of these steps are kept.
"""

from dataclasses import dataclass, field
from typing import ClassVar

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.planning.planner import Problem
from hnr_planner.core.planning.planners.hit_and_run_connect import (
    HitAndRunConnect,
    HitAndRunConnectSearch,
)
from hnr_planner.core.spaces.primitives import flood_path

#: Transitions before the flood fill: searches on building maps, spirals and mazes with corridors
#: of several cells are solved after a tenth of them.
FLOOD_AFTER = 20_000


@dataclass(frozen=True)
class Auto:
    """Trees of Hit-and-Run steps from both ends, then a flood fill. It has no settings."""

    name: ClassVar[str] = HitAndRunConnect.name

    def start(self, problem: Problem, rng: Stream) -> 'AutoSearch':
        """Start a tree at each end."""
        return AutoSearch(problem, rng)


@dataclass
class AutoSearch(HitAndRunConnectSearch):
    """Search with two trees that falls back on the path of a flood fill."""

    _flooded: Floats | None = field(init=False, default=None)

    @property
    def made_by(self) -> str:
        """Name of the method that found the path."""
        return Auto.name if self._flooded is None else 'flood_fill'

    @property
    def solved(self) -> bool:
        """Whether the trees have met, or a flood fill has found the goal."""
        return self._flooded is not None or super().solved

    @property
    def path(self) -> Floats:
        """Path (m, dim) of the trees, or that of the flood fill."""
        return super().path if self._flooded is None else self._flooded

    def advance(self, n_iterations: int) -> None:
        """Take at most ``n_iterations`` further steps; flood the space after ``FLOOD_AFTER``."""
        until_flood = FLOOD_AFTER - self.iterations
        if not 0 < until_flood <= n_iterations:
            super().advance(n_iterations)
            return
        super().advance(until_flood)
        if not self.solved:
            path = flood(self.problem)
            self._flooded = path if len(path) > 0 else None
            super().advance(n_iterations - until_flood)


@kernel
def flood(problem):
    """Return the path (m, dim) of a flood fill; (0, dim) where the space has none."""
    return flood_path(
        problem.space, problem.start, problem.goal, problem.goal_radius, problem.margin
    )
