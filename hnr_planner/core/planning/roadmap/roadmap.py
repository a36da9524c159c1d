"""
Roadmaps: the shortest paths between the corners of a map, for many requests.

Short paths bend at the corners of obstacles, so these are the nodes, and a table holds the
shortest paths between all of them. A request only connects its ends: the nodes to try are the
*exits* of the Hit-and-Run draws near start and goal, and of all pairs of visible exits the one
with the shortest path is taken.
"""

from dataclasses import dataclass
import math
from typing import ClassVar

from hnr_planner.core.cancellation import Event
from hnr_planner.core.checks import check_seed, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.copies import copy_rows
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.modes import waiting_for_machine_code
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.planning.planner import PathSearch, Problem
from hnr_planner.core.planning.planners.auto import Auto
from hnr_planner.core.planning.roadmap.build import build_data, N_DRAWS
from hnr_planner.core.planning.roadmap.data import empty_roadmap, RoadmapData
from hnr_planner.core.planning.roadmap.exits import visible_nodes, walk_to_node
from hnr_planner.core.spaces.primitives import segment_is_free
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.trees import branch, NONE
import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False, repr=False)
class Roadmap:
    """
    A planner with the shortest paths of its space computed in advance: ``Roadmap.build``.

    It is immutable: ``update`` and ``grow`` return new roadmaps. A result is a pure function of
    the roadmap, the request and its seed; the seed matters only where the roadmap does not connect
    nodes visible from start and goal.

    Attributes
    ----------
    seed : int
        The seed that reproduces the roadmap.

    """

    seed: int
    _data: RoadmapData

    name: ClassVar[str] = 'roadmap'

    @classmethod
    def build(
        cls, space: Space, *, seed: int | None = None, cancel: Event | None = None
    ) -> 'Roadmap':
        """
        Build the roadmap of a space.

        It takes seconds: the work is bounded by counts, whatever the size of the map. The first
        call for a kind of space waits for the compiler as well; interpreted it would take minutes.

        Parameters
        ----------
        space : Space
            Any space of dimension 2, also with several components or without free points.
        seed : int, optional
            Equal seeds give equal roadmaps. Fresh when left out.
        cancel : threading.Event, optional
            Ends the call soon after it is set.

        Raises
        ------
        Cancelled
            When ``cancel`` was set.
        RequestError
            When the space is not of the plane, or the seed no whole number of at least 0.

        """
        _check_plane(space)
        seed = check_seed(seed)
        with waiting_for_machine_code():
            return cls(seed, build_data(empty_roadmap(space), space, N_DRAWS, seed, cancel))

    def update(self, space: Space, *, cancel: Event | None = None) -> 'Roadmap':
        """
        Return a roadmap of ``space``: the data of this roadmap, repaired where the spaces differ.

        Where ``space`` is of another kind or has another frame, its roadmap is built from nothing.

        Raises
        ------
        Cancelled
            When ``cancel`` was set.

        """
        if not _same_frame(self.space, space):
            return Roadmap.build(space, seed=self.seed, cancel=cancel)
        with waiting_for_machine_code():
            data = build_data(self._data, space, self._data.n_draws, self.seed, cancel)
        return Roadmap(self.seed, data)

    def grow(self, *, cancel: Event | None = None) -> 'Roadmap':
        """
        Return a roadmap of the same space from twice as many draws, for shorter paths.

        Raises
        ------
        Cancelled
            When ``cancel`` was set.

        """
        with waiting_for_machine_code():
            data = build_data(self._data, self.space, 2 * self._data.n_draws, self.seed, cancel)
        return Roadmap(self.seed, data)

    @property
    def space(self) -> Space:
        """The space of the roadmap; the space of a request has to be this very object."""
        return self._data.space

    @property
    def nodes(self) -> Floats:
        """Nodes (n, dim): corners of obstacles, moved a little into free space, caller's frame."""
        return self.space.from_kernel(self._data.nodes)

    def start(self, problem: Problem, rng: Stream) -> PathSearch:
        """
        Return a solved search, or an ``Auto`` search where the roadmap does not connect the ends.

        Raises
        ------
        RequestError
            When the request is for another space.

        """
        if problem.space is not self.space.data:
            raise RequestError('the roadmap is of another space: call its update(space) first')
        nodes, paths, exits = self._data.nodes, self._data.shortest_paths, self._data.exits
        space, ends = problem.space, (problem.start[np.newaxis], problem.goal[np.newaxis])
        path, taut = shortest_path(space, nodes, paths, exits, *ends), True
        if len(path) == 0:
            ahead, back = (walk_to_node(space, nodes, exits, end[0], rng) for end in ends)
            path = shortest_path(space, nodes, paths, exits, ahead, back)
            taut = False
        return SolvedSearch(path, taut) if len(path) else Auto().start(problem, rng)


@dataclass
class SolvedSearch:
    """
    A search solved by the roadmap, without a transition.

    Attributes
    ----------
    path : (m, dim)
        Path from start to goal, kernel frame.
    taut : bool
        Whether the path is taut already, so that it is not shortened.

    """

    path: Floats
    taut: bool
    iterations: ClassVar[int] = 0
    solved: ClassVar[bool] = True

    @property
    def samples(self) -> Floats:
        """Vertices (m, dim) of the path, kernel frame."""
        return self.path

    @property
    def parents(self) -> NDArray[np.int64]:
        """Index (m,) of the vertex before each vertex of the path; -1 for the start."""
        return np.arange(-1, len(self.path) - 1)

    @property
    def counts(self) -> dict[str, int]:
        """Further counts by name: an empty dict, since a roadmap has none."""
        return {}

    def advance(self, n_iterations: int) -> None:
        """Do nothing: the search is solved."""


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
