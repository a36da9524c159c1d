"""Responses to requests for paths, as data."""

from dataclasses import asdict, dataclass, field
import math

from hnr_planner.core import PlanResult
from hnr_planner.core.lengths import path_length
from hnr_planner.core.planning.result import SearchResult
from hnr_planner.core.systems import Trajectory
from hnr_planner.server.geometry.orientations import LEVEL, normalised, Quaternion
from hnr_planner.server.geometry.planar_pose import PlanarPose
from hnr_planner.server.geometry.pose_motions import poses_of, twists_between
from hnr_planner.server.requests.outcomes import Outcome
from hnr_planner.server.requests.plan_request import PlanRequest
from hnr_planner.server.responses.response import Response
import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class PlanResponse(Response):
    """
    How a request for a path ended; points and lengths are in the map's frame [m].

    Parameters
    ----------
    request : PlanRequest
        The request: as it arrived where ``result`` is None, else transformed to the map's frame.
        Where a leg of a path through several poses fails, the request for that leg.
    result : SearchResult, optional
        What the planner returned; None when nothing was planned.
    poses : (n, 7)
        Poses along the path: x, y, z [m] and the quaternion x, y, z, w; none unless solved.
    other_poses : tuple of (n, 7)
        Poses along each alternative, in the order of their lengths.
    trajectory : Trajectory, optional
        States over time of a robot with inertia; None for other robots, or when none was found.
    clearance : float
        Smallest distance between the path and an obstacle [m]; NaN without a path, or where the
        time limit left no time to measure it.
    escape : float
        Length [m] of the first segment of the path, where this segment leads out of a start that
        is not free; 0 where the start is free.
    n_reached : int, optional
        Number of poses that the path reaches, where it ends before the last one of a request; None
        where it reaches all.
    route : str
        Where the path comes from, with the parameter ``keep_route``: 'kept', 'mended' or 'new';
        else empty.
    blocked : PlanarPose, optional
        The first place where a path is blocked by a map that came after the path was found; None
        in the response to a request.

    """

    request: PlanRequest
    result: SearchResult | None = None
    poses: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 7)))
    other_poses: tuple[NDArray[np.float64], ...] = ()
    trajectory: Trajectory | None = None
    clearance: float = math.nan
    escape: float = 0.0
    n_reached: int | None = None
    route: str = ''
    blocked: PlanarPose | None = None

    @property
    def solved(self) -> bool:
        """Whether the outcome is SOLVED: there is a path."""
        return self.outcome is Outcome.SOLVED

    @property
    def searched(self) -> bool:
        """Whether the planner's result has samples; False when it ended before its search."""
        return self.result is not None and len(self.result.samples) > 0

    @property
    def path(self) -> NDArray[np.float64]:
        """
        Vertices (m, 2) of the path in the map's frame [m]; (0, 2) unless solved.

        For a robot with a footprint they are poses (m, 3) [m, m, rad].
        """
        if self.solved and self.result is not None:
            return self.result.path
        return np.empty((0, 2))

    @property
    def poses_of_all(self) -> tuple[NDArray[np.float64], ...]:
        """Poses (n, 7) along the path and along each alternative; none unless solved."""
        return (self.poses, *self.other_poses) if len(self.poses) else ()

    @property
    def others(self) -> tuple[NDArray[np.float64], ...]:
        """Alternatives (m, 2) to the path [m], in the order of their lengths."""
        return self.result.others if self.solved and isinstance(self.result, PlanResult) else ()

    @property
    def has_footprint(self) -> bool:
        """Whether the path is one of a robot with a footprint: it has twists between its poses."""
        return isinstance(self.result, PlanResult) and self.result.twists is not None

    @property
    def free_path(self) -> NDArray[np.float64]:
        """
        Vertices (m, 2) [m] of the path from where it is free: without a start that is not.

        For a robot with a footprint they are the positions of ``poses``.
        """
        if self.has_footprint:
            return self.poses[:, :2]
        return self.path[1:] if self.escape > 0.0 else self.path

    @property
    def motions(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """
        Poses (m, 3) [m, m, rad] and the twists (m - 1, 3) between them along the path.

        For a robot that is a circle they are those of ``poses``, turned along the path.
        """
        if isinstance(self.result, PlanResult) and self.result.twists is not None:
            return self.result.path, self.result.twists
        poses = poses_of(self.poses[1:] if self.escape > 0.0 else self.poses)
        return poses, twists_between(poses)

    @property
    def goal_orientation(self) -> Quaternion:
        """Orientation requested at the goal, with norm 1; no rotation where it has none."""
        return normalised(self.request.goal.orientation) or LEVEL

    @property
    def offset(self) -> float:
        """Distance from the last vertex of the path to the goal [m]; NaN without a path."""
        if not self.solved:
            return math.nan
        return float(math.dist(self.path[-1, :2], self.request.goal.point))

    @property
    def algorithm(self) -> str:
        """Name of the planner that planned; that of the request when nothing was planned."""
        return self.request.algorithm if self.result is None else self.result.planner

    @property
    def values(self) -> dict[str, str]:
        """Published values of the request as text, by name; in seconds and metres, NaN unknown."""
        values = super().values | {
            'clearance': f'{self.clearance:.6g}',
            'offset': f'{self.offset:.6g}',
            'escape': f'{self.escape if self.solved else math.nan:.6g}',
        }
        if self.route:
            values['route'] = self.route
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
            'planning_time': f'{self.elapsed:.6f}',
            **{name: f'{n:.6f}' for name, n in asdict(self.times).items()},
            'first_solution_time': f'{first.elapsed if first else math.nan:.6f}',
            'first_solution_length': f'{first.length if first else math.nan:.6g}',
            'length': f'{result.length if self.solved else math.nan:.6g}',
            'alternatives': str(len(self.poses_of_all)),
            'alternative_lengths': ' '.join(f'{_length(rows):.6g}' for rows in self.poses_of_all),
            'cut_by_time': str(bool(result.cut_by_time)).lower(),
        }


def _length(rows: NDArray[np.float64]) -> float:
    """Return the length [m] of a path through poses (n, 7)."""
    return path_length(rows[:, :2])
