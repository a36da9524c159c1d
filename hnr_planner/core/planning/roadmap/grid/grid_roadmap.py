"""
Exact roadmaps of grids: shortest paths over the graph of the corners.

Free space is open, so a shortest path is a limit: its bends are corners of obstacles. The path
that is returned passes each corner at the space's margin.
"""

from dataclasses import dataclass
from typing import Any

from hnr_planner.core.cancellation import Event
from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.planning.planner import PathSearch, Problem
from hnr_planner.core.planning.planners.polyanya import Polyanya
from hnr_planner.core.planning.planners.taut_path import step_aside
from hnr_planner.core.planning.roadmap.grid.corners import STEP_X, X
from hnr_planner.core.planning.roadmap.grid.graph import build_graph, Graph, repair_graph
from hnr_planner.core.planning.roadmap.grid.search import shortest_paths
from hnr_planner.core.planning.roadmap.solved import SolvedSearch
from hnr_planner.core.spaces.grid.grid_space import GridSpace
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class GridRoadmap:
    """The exact roadmap of a grid; it draws nothing, so that seeds have no effect."""

    space: GridSpace
    graph: Graph

    @classmethod
    def build(cls, space: GridSpace, cancel: Event | None) -> 'GridRoadmap':
        """
        Build the roadmap of a grid.

        Raises
        ------
        Cancelled
            When ``cancel`` was set.

        """
        return cls(space, build_graph(space, cancel))

    def repaired(self, space: Space, _seed: int, cancel: Event | None) -> 'GridRoadmap | None':
        """
        Return the roadmap of another grid: this one, repaired where cells have changed.

        It equals the roadmap built from nothing. It is None where ``space`` is no grid of the same
        shape; resolution and origin do not matter, since the graph is in units of cells.

        Raises
        ------
        Cancelled
            When ``cancel`` was set.

        """
        if not isinstance(space, GridSpace) or space.shape != self.space.shape:
            return None
        return GridRoadmap(space, repair_graph(self.graph, self.space, space, cancel))

    def grown(self, _seed: int, _cancel: Event | None) -> 'GridRoadmap':
        """Return this roadmap: no path of it could be shorter."""
        return self

    @property
    def nodes(self) -> Floats:
        """Corners (n, 2), kernel frame, moved into free space by the margin."""
        return self._beside(np.arange(len(self.graph.corners.ends)))

    @property
    def arrays(self) -> tuple[object, ...]:
        """All arrays of the roadmap, in tuples; the slabs belong to the space."""
        return self.graph[1:]

    def distances(self, starts: Floats, goals: Floats) -> Floats:
        """Return the lengths (k,) [m] of the shortest paths between points (k, 2) [m]."""
        ends = self.space.to_kernel(starts), self.space.to_kernel(goals)
        return shortest_paths(self.graph, self.space.data, *ends)[0] * self.space.scale

    def start(self, problem: Problem, rng: Stream) -> PathSearch:
        """
        Return a solved search; for a goal region the search of ``Polyanya``, which is exact too.

        The graph has the shortest paths to points; which point of a region is the nearest is
        not known before.
        """
        if problem.goal_radius > 0.0:
            return Polyanya().for_space(self.space).start(problem, rng)
        ends = problem.start[np.newaxis], problem.goal[np.newaxis]
        lengths, _, bends = shortest_paths(self.graph, problem.space, *ends)
        points = np.concatenate([ends[0], self._beside(bends), ends[1]])
        path = step_aside(problem.space, points, problem.margin)
        return SolvedSearch(path, True, lengths[0])

    def _beside(self, corners: NDArray[Any]) -> Floats:
        """Return the points (k, 2), kernel frame, at the margin from corners (k,)."""
        places = self.graph.corners.places[corners]
        return places[:, X:STEP_X] + self.space.margin * places[:, STEP_X:]
