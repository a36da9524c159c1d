"""
A roadmap: what is known of short paths on a map, for many requests.

Short paths bend at the corners of obstacles, so these are the nodes, and a table holds all
shortest ways between them. What is left for a request is to get there and away: start and goal
leave by the *exits* of the Hit-and-Run draws around them, and of all pairs of exits that they see
the one is taken that makes the whole path shortest.
"""

from dataclasses import dataclass
import math
from typing import ClassVar

from hnr_planner.core.cancellation import Event
from hnr_planner.core.checks import check_seed, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream, stream
from hnr_planner.core.planning.planner import compile_search, make_problem, PathSearch, Problem
from hnr_planner.core.planning.planners.hit_and_run_connect import HitAndRunConnect
from hnr_planner.core.planning.roadmap.build import learn, N_DRAWS
from hnr_planner.core.planning.roadmap.data import Knowledge, nothing_known
from hnr_planner.core.planning.roadmap.exits import nodes_seen, way_to_node
from hnr_planner.core.spaces.primitives import segment_is_free
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.trees import branch, NONE
import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False, repr=False)
class Roadmap:
    """
    A planner that knows its space: ``Roadmap.build``.

    It never changes: ``update`` and ``grow`` return new ones. An answer is a pure function of the
    roadmap, the request and its seed, which matters only where start or goal sees no node.

    Attributes
    ----------
    seed : int
        The seed that builds it again.

    """

    seed: int
    _known: Knowledge

    name: ClassVar[str] = 'roadmap'

    @classmethod
    def build(
        cls, space: Space, *, seed: int | None = None, cancel: Event | None = None
    ) -> 'Roadmap':
        """
        Learn a space. It takes seconds: bounded by counts, it does not grow with the map's size.

        Parameters
        ----------
        space : Space
            Any space of the plane, in one part or more, even without free points.
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
        _compile(space)
        return cls(seed, learn(nothing_known(space), space, N_DRAWS, seed, cancel))

    def update(self, space: Space, *, cancel: Event | None = None) -> 'Roadmap':
        """
        Return a roadmap of ``space``: this one, mended where the spaces differ.

        Raises
        ------
        Cancelled
            When ``cancel`` was set.

        """
        if not _same_frame(self.space, space):
            return Roadmap.build(space, seed=self.seed, cancel=cancel)
        known = learn(self._known, space, self._known.n_draws, self.seed, cancel)
        return Roadmap(self.seed, known)

    def grow(self, *, cancel: Event | None = None) -> 'Roadmap':
        """
        Return a roadmap of the same space that knows more: from twice as many draws.

        Raises
        ------
        Cancelled
            When ``cancel`` was set.

        """
        known = learn(self._known, self.space, 2 * self._known.n_draws, self.seed, cancel)
        return Roadmap(self.seed, known)

    @property
    def space(self) -> Space:
        """The space that it was built for; requests have to be for the same one."""
        return self._known.space

    @property
    def nodes(self) -> Floats:
        """Nodes (n, dim): corners of the space, in the caller's frame."""
        return self.space.from_kernel(self._known.nodes)

    def start(self, problem: Problem, rng: Stream) -> PathSearch:
        """
        Answer a request, or start trees where the roadmap does not lead from start to goal.

        Raises
        ------
        RequestError
            When the request is for another space.

        """
        if problem.space is not self.space.data:
            raise RequestError('the roadmap is of another space: call its update(space) first')
        nodes, ways, exits = self._known.nodes, self._known.ways, self._known.exits
        space, ends = problem.space, (problem.start[np.newaxis], problem.goal[np.newaxis])
        path, taut = shortest_path(space, nodes, ways, exits, *ends), True
        if len(path) == 0:
            ahead, back = (way_to_node(space, nodes, exits, end[0], rng) for end in ends)
            path = shortest_path(space, nodes, ways, exits, ahead, back)
            taut = False
        return Answer(path, taut) if len(path) else HitAndRunConnect().start(problem, rng)


@dataclass
class Answer:
    """
    A search that has found its path without a transition.

    Attributes
    ----------
    path : (m, dim)
    taut : bool
        Whether there is nothing to gain from pulling it.

    """

    path: Floats
    taut: bool
    iterations: ClassVar[int] = 0
    solved: ClassVar[bool] = True

    @property
    def samples(self) -> Floats:
        """The path itself."""
        return self.path

    @property
    def parents(self) -> NDArray[np.int64]:
        """Each vertex was reached from the one before."""
        return np.arange(-1, len(self.path) - 1)

    @property
    def counts(self) -> dict[str, int]:
        """Nothing was counted."""
        return {}

    def advance(self, n_iterations: int) -> None:
        """Do nothing: there is nothing left to do."""


def _check_plane(space: Space) -> None:
    """Refuse spaces in which shortest paths bend anywhere along edges, not at a few corners."""
    if space.dim != 2:
        raise RequestError(
            f'a roadmap is of the corners of a plane: space must have dimension 2, this '
            f'{type(space).__name__} has {space.dim}'
        )


def _compile(space: Space) -> None:
    """Compile what requests on this kind of space may run, before one of them waits for it."""
    (lower, upper), rng = space.kernel_bounds, stream(0)
    nothing = nothing_known(space)
    for_nodes = nothing.nodes, nothing.ways, nothing.exits
    shortest_path(space.data, *for_nodes, lower[np.newaxis], upper[np.newaxis])
    way_to_node(space.data, nothing.nodes, nothing.exits, lower, rng)
    start, goal = space.bounds
    compile_search(HitAndRunConnect(), make_problem(space, start, goal, goal_radius=0.0))


def _same_frame(a: Space, b: Space) -> bool:
    """Say whether points have the same numbers in the kernel frames of both spaces."""
    if type(a.data) is not type(b.data) or not np.array_equal(a.kernel_bounds, b.kernel_bounds):
        return False
    bounds = np.stack([*a.bounds, *b.bounds])
    return np.array_equal(a.to_kernel(bounds), b.to_kernel(bounds))


@kernel
def shortest_path(space, nodes, ways, exits, ahead, back):
    """
    Return the shortest path (m, dim) over nodes between two ways; (0, dim) where none is known.

    The ways (k, dim) lead from start and from goal to points that see a node.
    """
    space, nodes, ways, exits = borrowed(space), borrowed(nodes), borrowed(ways), borrowed(exits)
    leaving, before = nodes_seen(space, nodes, exits, ahead[-1], True)
    arriving, after = nodes_seen(space, nodes, exits, back[-1], False)
    shortest, first, last = math.inf, NONE, NONE
    for i in range(len(leaving)):
        for j in range(len(arriving)):
            length = before[i] + ways.distance[leaving[i], arriving[j]] + after[j]
            if length < shortest:
                shortest, first, last = length, leaving[i], arriving[j]
    if first == NONE:
        return np.empty((0, nodes.shape[1]))
    # What the exits of the draws around do not tell: the way may be joined further on.
    while first != last and segment_is_free(space, ahead[-1], nodes[ways.previous[last, first]]):
        first = ways.previous[last, first]
    while first != last and segment_is_free(space, nodes[ways.previous[first, last]], back[-1]):
        last = ways.previous[first, last]
    return np.concatenate((ahead, branch(nodes, ways.previous[first], last), back[::-1]))
