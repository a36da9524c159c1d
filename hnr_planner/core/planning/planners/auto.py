"""
The default planner: Hit-and-Run from both ends, and a flood fill where the steps take long.

In noise, in long strips and in mazes of one cell random steps make little progress. On a grid a
flood fill finds a path wherever there is one. So after ``FILL_AFTER`` steps, more than most
searches take, a flood fill goes on beside the trees, in proportion to their steps, and the first
of the two to find a path ends the search. The samples of the steps are kept.
"""

from dataclasses import dataclass, field
from typing import ClassVar

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.planning.planner import Problem
from hnr_planner.core.planning.planners.flood_fill import FloodFill
from hnr_planner.core.planning.planners.hit_and_run_connect import (
    HitAndRunConnect,
    HitAndRunConnectSearch,
)
from hnr_planner.core.spaces.grid.traversal import GridData

#: Transitions before the flood fill begins, and cells to which it spreads in each one after that.
FILL_AFTER, CELLS_OF_A_STEP = 1000, 32


@dataclass(frozen=True)
class Auto:
    """
    The default planner: trees of Hit-and-Run steps from both ends, later beside a flood fill.

    The flood fill begins on a grid, after ``FILL_AFTER`` steps; where it finds no path, the trees
    grow on. The planner has no settings. ``name`` is the name of the method, so it equals that of
    ``HitAndRunConnect``; a path of the flood fill is named ``flood_fill``.
    """

    name: ClassVar[str] = HitAndRunConnect.name

    def start(self, problem: Problem, rng: Stream) -> 'AutoSearch':
        """Return a search whose trees begin at the problem's start and at its goal."""
        return AutoSearch(problem, rng)


@dataclass
class AutoSearch(HitAndRunConnectSearch):
    """Search with two trees, and on a grid with a flood fill beside them after some steps."""

    #: None before it begins, and in a space that is no grid.
    _fill: FloodFill | None = field(init=False, default=None)
    #: Whether the flood fill has found a path before the trees.
    _filled: bool = field(init=False, default=False)

    @property
    def made_by(self) -> str:
        """Name of the method that found the path: ``flood_fill``, or that of the two trees."""
        return 'flood_fill' if self._filled else Auto.name

    @property
    def solved(self) -> bool:
        """Whether the trees solved the problem, or the flood fill has found a path."""
        return self._filled or super().solved

    @property
    def path(self) -> Floats:
        """Path (m, dim) of a solved search, kernel frame: of the flood fill, or of the trees."""
        return self._fill.path if self._fill is not None and self._filled else super().path

    def advance(self, n_iterations: int) -> None:
        """
        Take at most ``n_iterations`` further steps, fewer once the search is solved.

        After ``FILL_AFTER`` steps in all, the flood fill spreads to ``CELLS_OF_A_STEP`` cells in
        each further step.
        """
        alone = min(n_iterations, max(FILL_AFTER - self.iterations, 0))
        if not isinstance(self.problem.space, GridData):
            alone = n_iterations
        super().advance(alone)
        if alone < n_iterations and not self.solved:
            self._advance_both(n_iterations - alone)

    def _advance_both(self, n_iterations: int) -> None:
        """Take at most ``n_iterations`` further steps, and let the flood fill spread beside."""
        if self._fill is None:
            self._fill = FloodFill(self.problem)
        n_cells = self._fill.advance(n_iterations * CELLS_OF_A_STEP)
        found_in = -(-n_cells // CELLS_OF_A_STEP)
        super().advance(found_in if self._fill.solved else n_iterations)
        self._filled = self._fill.solved and not super().solved
