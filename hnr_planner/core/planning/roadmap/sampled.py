"""
Roadmaps from samples: shortest paths between corners that Hit-and-Run finds, in any plane space.

Short paths bend at the corners of obstacles, so these are the nodes, and a table holds the
shortest paths between all of them. A request only connects its ends: the nodes to try are the
*exits* of the Hit-and-Run draws near start and goal, and of all pairs of visible exits the one
with the shortest path is taken.
"""

from dataclasses import dataclass
import math

from hnr_planner.core.cancellation import Event
from hnr_planner.core.checks import Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.copies import copy_rows
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.planning.planner import PathSearch, Problem
from hnr_planner.core.planning.planners.auto import Auto
from hnr_planner.core.planning.roadmap.build import build_data, N_DRAWS
from hnr_planner.core.planning.roadmap.data import empty_roadmap, RoadmapData
from hnr_planner.core.planning.roadmap.exits import visible_nodes, walk_to_node
from hnr_planner.core.planning.roadmap.solved import SolvedSearch
from hnr_planner.core.spaces.primitives import segment_is_free
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.trees import branch, NONE
import numpy as np


@dataclass(frozen=True, eq=False)
class SampledRoadmap:
    """The roadmap of any space of the plane: the data computed from its draws."""

    data: RoadmapData

    @classmethod
    def build(cls, space: Space, seed: int, cancel: Event | None) -> 'SampledRoadmap':
        """
        Build the roadmap of a space from ``N_DRAWS`` draws.

        Raises
        ------
        Cancelled
            When ``cancel`` was set.
        RequestError
            When the space is not of the plane.

        """
        _check_plane(space)
        return cls(build_data(empty_roadmap(space), space, N_DRAWS, seed, cancel))

    def repaired(self, space: Space, seed: int, cancel: Event | None) -> 'SampledRoadmap | None':
        """
        Return the roadmap of another space: this one, repaired where the spaces differ.

        It is None where ``space`` is of another kind or has another frame.

        Raises
        ------
        Cancelled
            When ``cancel`` was set.

        """
        if not _same_frame(self.space, space):
            return None
        return SampledRoadmap(build_data(self.data, space, self.data.n_draws, seed, cancel))

    def grown(self, seed: int, cancel: Event | None) -> 'SampledRoadmap':
        """
        Return a roadmap of the same space from twice as many draws.

        Raises
        ------
        Cancelled
            When ``cancel`` was set.

        """
        return SampledRoadmap(
            build_data(self.data, self.space, 2 * self.data.n_draws, seed, cancel)
        )

    @property
    def space(self) -> Space:
        """The space of the roadmap."""
        return self.data.space

    @property
    def nodes(self) -> Floats:
        """Nodes (n, 2), kernel frame: corners of obstacles, moved a little into free space."""
        return self.data.nodes

    @property
    def arrays(self) -> tuple[object, ...]:
        """All arrays of the roadmap, in tuples."""
        return tuple(vars(self.data).values())

    def start(self, problem: Problem, rng: Stream) -> PathSearch:
        """Return a solved search, or one of ``Auto`` where the roadmap connects no ends."""
        nodes, paths, exits = self.data.nodes, self.data.shortest_paths, self.data.exits
        space, ends = problem.space, (problem.start[np.newaxis], problem.goal[np.newaxis])
        path, taut = shortest_path(space, nodes, paths, exits, *ends), True
        if len(path) == 0:
            ahead, back = (walk_to_node(space, nodes, exits, end[0], rng) for end in ends)
            path = shortest_path(space, nodes, paths, exits, ahead, back)
            taut = False
        return SolvedSearch(path, taut) if len(path) else Auto().start(problem, rng)


def _check_plane(space: Space) -> None:
    """
    Raise RequestError for a space that has not dimension 2.

    In more dimensions shortest paths bend anywhere along edges of obstacles, not at corners.
    """
    if space.dim != 2:
        raise RequestError(
            f'a roadmap is of the corners of a plane: space must have dimension 2, this '
            f'{type(space).__name__} has {space.dim}'
        )


def _same_frame(a: Space, b: Space) -> bool:
    """Return whether points have the same numbers in the kernel frames of both spaces."""
    if type(a.data) is not type(b.data) or not np.array_equal(a.kernel_bounds, b.kernel_bounds):
        return False
    bounds = np.stack([*a.bounds, *b.bounds])
    return np.array_equal(a.to_kernel(bounds), b.to_kernel(bounds))


@kernel
def shortest_path(space, nodes, paths, exits, ahead, back):
    """
    Return the shortest path (m, dim) over nodes that joins two walks; (0, dim) if there is none.

    The walks (k, dim), ``ahead`` and ``back``, begin at the start and at the goal. The path
    follows both and connects their last points over nodes visible from these points.
    """
    space, nodes, paths, exits = borrowed(space), borrowed(nodes), borrowed(paths), borrowed(exits)
    leaving, before = visible_nodes(space, nodes, exits, ahead[-1], True)
    arriving, after = visible_nodes(space, nodes, exits, back[-1], False)
    shortest, first, last = math.inf, NONE, NONE
    for i in range(len(leaving)):
        for j in range(len(arriving)):
            length = before[i] + paths.distance[leaving[i], arriving[j]] + after[j]
            if length < shortest:
                shortest, first, last = length, leaving[i], arriving[j]
    if first == NONE:
        return np.empty((0, nodes.shape[1]))
    # Later nodes of the path may be visible too: leave out those before.
    while first != last and segment_is_free(space, ahead[-1], nodes[paths.previous[last, first]]):
        first = paths.previous[last, first]
    while first != last and segment_is_free(space, nodes[paths.previous[first, last]], back[-1]):
        last = paths.previous[first, last]
    between = branch(nodes, paths.previous[first], last)
    left = len(ahead)
    arrived = left + len(between)
    path = np.empty((arrived + len(back), nodes.shape[1]))
    copy_rows(path[:left], ahead)
    copy_rows(path[left:arrived], between)
    copy_rows(path[arrived:], back[::-1])
    return path
