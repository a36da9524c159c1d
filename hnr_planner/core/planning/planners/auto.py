"""
The default planner: Hit-and-Run from both ends, and a flood fill where the steps take long.

In noise, in long strips and in mazes of one cell random steps make little progress. On a grid a
flood fill finds a path wherever there is one. So after ``ROUND`` steps, more than most searches
take, a flood fill goes on beside the trees, and the first of the two to find a path ends the
search. At once it spreads to as many cells as suffice in noise, and then ever faster, since the
trees are soon done in wide mazes and never in narrow ones. The samples of the steps are kept.
"""

from dataclasses import dataclass, field
import math
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

#: Transitions of a round. In those of round k, counted from 0, k cells of the flood fill spread.
ROUND = 1000
#: Cells that spread at the beginning of round 1, for each row and column of the grid: in 30 %
#: noise, twice as many as between two random points.
AT_ONCE = 2


@dataclass(frozen=True)
class Auto:
    """
    The default planner: trees of Hit-and-Run steps from both ends, later beside a flood fill.

    The flood fill begins on a grid, after ``ROUND`` steps; where it finds no path, the trees
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

        The flood fill begins after ``ROUND`` steps in all.
        """
        if not isinstance(self.problem.space, GridData):
            super().advance(n_iterations)
            return
        end = self.iterations + n_iterations
        while self.iterations < end and not self.solved:
            in_round, of_round = divmod(self.iterations, ROUND)
            self._advance_both(min(end - self.iterations, ROUND - of_round), in_round)

    def _advance_both(self, n_iterations: int, cells_of_a_step: int) -> None:
        """Take at most ``n_iterations`` steps; in each, some cells of the flood fill spread."""
        if cells_of_a_step == 0:
            super().advance(n_iterations)
            return
        at_once = 0
        if self._fill is None:
            self._fill = FloodFill(self.problem)
            at_once = AT_ONCE * sum(self.problem.space.free_distance.shape)
        n_cells = self._fill.advance(at_once + n_iterations * cells_of_a_step)
        found_in = max(math.ceil((n_cells - at_once) / cells_of_a_step), 1)
        super().advance(found_in if self._fill.solved else n_iterations)
        self._filled = self._fill.solved and not super().solved
