"""
The default planner: Hit-and-Run from both ends, and a flood fill where the steps take long.

In long strips and one-cell mazes random steps make little progress. A grid finds a path wherever
there is one by flood fill (``flood_path``), so a flood fill is tried once, after ``FLOOD_AFTER``
steps, which is more than nearly all searches take. The samples of these steps are kept.
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
    """
    The default planner: trees of Hit-and-Run steps from both ends, and once a flood fill.

    The flood fill is tried once, if ``FLOOD_AFTER`` steps find no path; where it finds none
    either, the trees grow on. The planner has no settings. ``name`` is the name of the method, so
    it equals that of ``HitAndRunConnect``; a path of the flood fill is named ``flood_fill``.
    """

    name: ClassVar[str] = HitAndRunConnect.name

    def start(self, problem: Problem, rng: Stream) -> 'AutoSearch':
        """Return a search whose trees begin at the problem's start and at its goal."""
        return AutoSearch(problem, rng)


@dataclass
class AutoSearch(HitAndRunConnectSearch):
    """Search with two trees, which tries a flood fill once, after ``FLOOD_AFTER`` steps."""

    _flooded: Floats | None = field(init=False, default=None)

    @property
    def made_by(self) -> str:
        """Name of the method that found the path: ``flood_fill``, or that of the two trees."""
        return Auto.name if self._flooded is None else 'flood_fill'

    @property
    def solved(self) -> bool:
        """Whether the trees solved the problem, or a flood fill has found a path."""
        return self._flooded is not None or super().solved

    @property
    def path(self) -> Floats:
        """Path (m, dim) of a solved search, kernel frame: of the flood fill, or of the trees."""
        return super().path if self._flooded is None else self._flooded

    def advance(self, n_iterations: int) -> None:
        """
        Take at most ``n_iterations`` further steps, fewer once the search is solved.

        Where ``FLOOD_AFTER`` steps in all have found no path, try a flood fill, which counts as
        no step.
        """
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
    """
    Return the path (m, dim) that a flood fill finds, kernel frame; (0, dim) where it finds none.

    Only grids have a flood fill; in any other space none is found.
    """
    return flood_path(
        problem.space, problem.start, problem.goal, problem.goal_radius, problem.margin
    )
