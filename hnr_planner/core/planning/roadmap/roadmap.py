"""
Roadmaps: shortest paths between the corners of a map, computed once for many requests.

There are two kinds: exact ones on grids (``grid``), and in other spaces of the plane those from
samples (``sampled``).
"""

from dataclasses import dataclass
from typing import ClassVar

from hnr_planner.core.cancellation import Event
from hnr_planner.core.checks import check_points, check_seed, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.modes import waiting_for_machine_code
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.planning.planner import PathSearch, Problem
from hnr_planner.core.planning.roadmap.grid.grid_roadmap import GridRoadmap
from hnr_planner.core.planning.roadmap.sampled import SampledRoadmap
from hnr_planner.core.spaces.grid.grid_space import GridSpace
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import ArrayLike


@dataclass(frozen=True, eq=False, repr=False)
class Roadmap:
    """
    A planner with the shortest paths of its space computed in advance: ``Roadmap.build``.

    On a ``GridSpace`` its paths are the shortest, and results say so: ``PlanResult.lower_bound``
    is their length, up to margins at corners. Paths to a goal region are searched for by
    ``Polyanya``. In other spaces of the plane they are hardly longer
    than the shortest.

    It is immutable: ``update`` and ``grow`` return new roadmaps. A result is a pure function of
    the roadmap, the request and its seed; the seed matters only where the roadmap cannot answer.

    Attributes
    ----------
    seed : int
        The seed that reproduces the roadmap; it has no effect on a grid.

    """

    seed: int
    _kind: GridRoadmap | SampledRoadmap

    name: ClassVar[str] = 'roadmap'

    @classmethod
    def build(
        cls, space: Space, *, seed: int | None = None, cancel: Event | None = None
    ) -> 'Roadmap':
        """
        Build the roadmap of a space.

        On a grid it takes some milliseconds for each thousand corners of obstacles; in another
        space seconds, since the work is bounded by counts. The first call for a kind of space
        waits for the compiler as well, and logs that it does.

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
        seed = check_seed(seed)
        with waiting_for_machine_code('a roadmap'):
            if isinstance(space, GridSpace):
                return cls(seed, GridRoadmap.build(space, cancel))
            return cls(seed, SampledRoadmap.build(space, seed, cancel))

    def update(self, space: Space, *, cancel: Event | None = None) -> 'Roadmap':
        """
        Return a roadmap of ``space``: that of this roadmap, repaired where the spaces differ.

        Where the spaces are of different kinds, grids of different shapes, or other spaces in
        different frames, it is built from nothing.

        Raises
        ------
        Cancelled
            When ``cancel`` was set.

        """
        with waiting_for_machine_code('a roadmap'):
            kind = self._kind.repaired(space, self.seed, cancel)
        if kind is None:
            return Roadmap.build(space, seed=self.seed, cancel=cancel)
        return Roadmap(self.seed, kind)

    def grow(self, *, cancel: Event | None = None) -> 'Roadmap':
        """
        Return a roadmap of the same space with shorter paths, from twice as many draws.

        On a grid the paths are the shortest already, and it is this roadmap.

        Raises
        ------
        Cancelled
            When ``cancel`` was set.

        """
        with waiting_for_machine_code('a roadmap'):
            kind = self._kind.grown(self.seed, cancel)
        return self if kind is self._kind else Roadmap(self.seed, kind)

    @property
    def space(self) -> Space:
        """The space of the roadmap; the space of a request has to be this very object."""
        return self._kind.space

    @property
    def nodes(self) -> Floats:
        """Nodes (n, dim): corners of obstacles, moved a little into free space, caller's frame."""
        return self.space.from_kernel(self._kind.nodes)

    @property
    def nbytes(self) -> int:
        """Memory of the roadmap [bytes], without that of its space."""
        return _n_bytes(self._kind.arrays)

    def __repr__(self) -> str:
        """Return the space, the number of nodes and the memory."""
        return (
            f'Roadmap({self.space!r}, nodes={len(self._kind.nodes)}, '
            f'megabytes={self.nbytes / 1e6:.2g})'
        )

    def distances(self, starts: ArrayLike, goals: ArrayLike) -> Floats:
        """
        Return the lengths (k,) [m] of the shortest paths for many requests in one call, on a grid.

        Parameters
        ----------
        starts, goals : (k, 2)
            Ends of the requests in the map frame [m].

        Returns
        -------
        (k,)
            Lengths as ``PlanResult.lower_bound`` gives them; inf where no path exists or an end is
            not free.

        Raises
        ------
        RequestError
            When the roadmap is not of a grid, or starts and goals have not the same shape (k, 2).

        """
        if not isinstance(self._kind, GridRoadmap):
            raise RequestError(
                f'distances are exact on a GridSpace only, this roadmap is of a '
                f'{type(self.space).__name__}'
            )
        starts, goals = check_points('starts', starts, 2), check_points('goals', goals, 2)
        if starts.ndim != 2 or starts.shape != goals.shape:
            raise RequestError(
                f'starts and goals must have the same shape (k, 2), got {starts.shape} and '
                f'{goals.shape}'
            )
        return self._kind.distances(starts, goals)

    def for_space(self, space: Space) -> 'Roadmap':
        """Return the roadmap, or raise RequestError where it is not that of ``space``."""
        if space is not self.space:
            raise RequestError('the roadmap is of another space: call its update(space) first')
        return self

    def start(self, problem: Problem, rng: Stream) -> PathSearch:
        """Return a solved search, or one of ``Auto`` where the roadmap connects no ends."""
        return self._kind.start(problem, rng)


def _n_bytes(arrays: object) -> int:
    """Return the memory [bytes] of all arrays in tuples of any depth."""
    if isinstance(arrays, tuple):
        return sum(map(_n_bytes, arrays))
    return arrays.nbytes if isinstance(arrays, np.ndarray) else 0
