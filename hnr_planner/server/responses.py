"""Responses to requests for paths and for draws, as data."""

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
import math

from hnr_planner.core import FreeSpaceDraws
from hnr_planner.core.planning.result import SearchResult
from hnr_planner.core.systems import Trajectory
from hnr_planner.server.map_store import MapSnapshot
from hnr_planner.server.orientations import LEVEL, normalised, Quaternion
from hnr_planner.server.outcomes import Outcome
from hnr_planner.server.path_validity import PlanarPose
from hnr_planner.server.requests import PlanRequest
from hnr_planner.server.settings import Settings
import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Response(ABC):
    """
    How a request ended.

    Parameters
    ----------
    outcome : Outcome
        The name of what happened.
    why : str
        The same in words, with the values.
    elapsed : float
        Time from the request to this response [s].
    tier : str
        'compiled' when machine code did all of the work, 'interpreted' when some of it was not
        there yet.
    snapshot : MapSnapshot, optional
        The map that the response holds for; None when there was none.

    """

    outcome: Outcome
    why: str
    elapsed: float = field(default=0.0, kw_only=True)
    tier: str = field(default='compiled', kw_only=True)
    snapshot: MapSnapshot | None = field(default=None, kw_only=True)

    @property
    def frame(self) -> str:
        """Return the map's frame, empty without a map."""
        return '' if self.snapshot is None else self.snapshot.frame

    @property
    def searched(self) -> bool:
        """Return whether a path was searched for, found or not."""
        return False

    @property
    @abstractmethod
    def algorithm(self) -> str:
        """Return the name of the planner or walk."""

    @property
    def values(self) -> dict[str, str]:
        """Return what is published about the request; seconds and metres, NaN where unknown."""
        return {
            'why': self.why,
            'algorithm': self.algorithm,
            'elapsed': f'{self.elapsed:.6f}',
            'tier': self.tier,
        }


@dataclass(frozen=True)
class PlanResponse(Response):
    """
    How a request for a path ended.

    Parameters
    ----------
    request : PlanRequest
        The request; in the map's frame once something was planned.
    result : SearchResult, optional
        What the planner returned; None when nothing was planned.
    poses : (n, 7)
        Poses along the path: x, y, z [m] and the quaternion x, y, z, w; none unless solved.
    trajectory : Trajectory, optional
        What a robot with inertia does over time.
    clearance : float
        Smallest distance between the path and an obstacle [m]; NaN without a path, or where the
        time limit left no time to measure it.
    escape : float
        Length of the first segment of the path, where that leads out of a start that is not free
        [m]; 0 where the start is free.
    blocked : PlanarPose, optional
        Where a path found before is blocked now.

    """

    request: PlanRequest
    result: SearchResult | None = None
    poses: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 7)))
    trajectory: Trajectory | None = None
    clearance: float = math.nan
    escape: float = 0.0
    blocked: PlanarPose | None = None

    @property
    def solved(self) -> bool:
        """Return whether there is a path."""
        return self.outcome is Outcome.SOLVED

    @property
    def searched(self) -> bool:
        """Return whether there was anything to search for, solved or not."""
        return self.result is not None and len(self.result.samples) > 0

    @property
    def path(self) -> NDArray[np.float64]:
        """Return the vertices (m, 2) of the path [m]; none unless solved."""
        if self.solved and self.result is not None:
            return self.result.path
        return np.empty((0, 2))

    @property
    def free_path(self) -> NDArray[np.float64]:
        """Return the vertices of the path without the way out of a start that is not free."""
        return self.path[1:] if self.escape > 0.0 else self.path

    @property
    def goal_orientation(self) -> Quaternion:
        """Return the orientation requested at the goal, with norm 1."""
        return normalised(self.request.goal.orientation) or LEVEL

    @property
    def offset(self) -> float:
        """Return the distance from the path's end to the goal [m]; NaN without a path."""
        if not self.solved:
            return math.nan
        return float(math.dist(self.path[-1], self.request.goal.point))

    @property
    def algorithm(self) -> str:
        """Return the planner that planned, or else the one requested."""
        return self.request.algorithm if self.result is None else self.result.planner

    @property
    def values(self) -> dict[str, str]:
        """Return what is published about the request; seconds and metres, NaN where unknown."""
        values = super().values | {
            'clearance': f'{self.clearance:.6g}',
            'offset': f'{self.offset:.6g}',
            'escape': f'{self.escape if self.solved else math.nan:.6g}',
        }
        if self.blocked is not None:
            values |= {f'blocked_{name}': f'{n:.6g}' for name, n in self.blocked._asdict().items()}
        if self.result is not None:
            values |= self._search_values(self.result)
        return values

    def _search_values(self, result: SearchResult) -> dict[str, str]:
        first = result.first_solution
        return {
            'seed': str(result.seed),
            'iterations': str(result.iterations),
            'samples': str(len(result.samples)),
            'planning_time': f'{result.elapsed:.6f}',
            'first_solution_time': f'{first.elapsed if first else math.nan:.6f}',
            'first_solution_length': f'{first.length if first else math.nan:.6g}',
            'length': f'{result.length if self.solved else math.nan:.6g}',
            'cut_by_time': str(bool(result.cut_by_time)).lower(),
        }


@dataclass(frozen=True)
class SampleResponse(Response):
    """
    How a request for draws ended.

    Parameters
    ----------
    settings : Settings
        The parameters that said what to draw.
    draws : FreeSpaceDraws, optional
        One chain of them; None after a failure.

    """

    settings: Settings
    draws: FreeSpaceDraws | None = None

    @property
    def points(self) -> NDArray[np.float64]:
        """Return the draws (n, 2) [m]; none after a failure."""
        return np.empty((0, 2)) if self.draws is None else self.draws.points[0]

    @property
    def n_components(self) -> int:
        """Return how many connected components of the free space the draws lie in."""
        return 0 if self.draws is None else len(np.unique(self.draws.components))

    @property
    def parents(self) -> NDArray[np.intp]:
        """Return the index (n,) of the draw that each is one step away from; -1 for none."""
        if self.draws is None or self.settings.sample_thin > 1:
            return np.full(len(self.points), -1)
        return self.draws.previous[0]

    @property
    def algorithm(self) -> str:
        """Return the walk that the parameters name."""
        return self.settings.sample_walk

    @property
    def values(self) -> dict[str, str]:
        """Return what is published about the request; seconds."""
        values = super().values
        if self.draws is not None:
            n_steps = (len(self.points) - self.n_components) * self.settings.sample_thin
            values |= {
                'seed': str(self.draws.seed),
                'iterations': str(n_steps),
                'samples': str(len(self.points)),
                'parts': str(self.n_components),
            }
        return values
