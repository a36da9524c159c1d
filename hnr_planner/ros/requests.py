"""What is asked of the planner, and what it answers: data, without ROS."""

from dataclasses import dataclass
import math

from hnr_planner.core import PlanResult
from hnr_planner.ros.map_store import MapSnapshot
from hnr_planner.ros.orientations import LEVEL, normalised, Quaternion
from hnr_planner.ros.outcomes import Outcome, Refusal
from hnr_planner.ros.path_validity import PlanarPose
import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Pose:
    """
    A pose as it was asked for.

    Parameters
    ----------
    position : (x, y, z)
        In metres.
    orientation : Quaternion
        Of any norm.
    frame : str
        Where it is given; empty for the map's frame.
    stamp : int
        Time of the frame [ns]; 0 for the latest known.

    """

    position: tuple[float, float, float]
    orientation: Quaternion = LEVEL
    frame: str = ''
    stamp: int = 0

    @property
    def point(self) -> tuple[float, float]:
        """Return (x, y)."""
        return self.position[0], self.position[1]


NOWHERE = Pose((math.nan, math.nan, math.nan))
"""The start or goal of a request that came without one: NO_START or BAD_REQUEST."""


@dataclass(frozen=True)
class Request:
    """
    A path is asked for, through the poses of `via` in their order.

    `tolerance` [m] is how far from a blocked goal, and from those on the way, it may pass.
    """

    start: Pose
    goal: Pose
    tolerance: float
    algorithm: str
    via: tuple[Pose, ...] = ()

    @property
    def named_poses(self) -> tuple[tuple[str, Pose], ...]:
        """Return all poses, each with its name in words."""
        via = tuple((f'pose {place} on the way', pose) for place, pose in enumerate(self.via, 1))
        return (('start', self.start), *via, ('goal', self.goal))

    @property
    def omits_start(self) -> bool:
        """Return whether the start looks like one that was left out."""
        return self.start.frame == '' and self.start.point == (0.0, 0.0)


@dataclass(frozen=True)
class Report:
    """
    The answer to a request.

    Parameters
    ----------
    outcome : Outcome
        The name of what happened.
    why : str
        The same in words, with the values.
    request : Request
        What was asked for; in the map's frame once something was planned.
    elapsed : float
        Time from the request to this report [s].
    snapshot : MapSnapshot, optional
        The map that the answer holds for; None when there was none.
    result : PlanResult, optional
        What the planner returned; None when nothing was planned.
    clearance : float
        Smallest distance between the path and an obstacle [m]; NaN without a path.
    escape : float
        Length of the first segment of the path, where that leads out of a start that is not free
        [m]; 0 where the start is free.
    blocked : PlanarPose, optional
        Where a path found before is blocked now.

    """

    outcome: Outcome
    why: str
    request: Request
    elapsed: float
    snapshot: MapSnapshot | None = None
    result: PlanResult | None = None
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
        """Return the vertices of the path, an array (m, 2); none unless solved."""
        if self.solved and self.result is not None:
            return self.result.path
        return np.empty((0, 2))

    @property
    def free_path(self) -> NDArray[np.float64]:
        """Return the part of the path that is free: all but the way out of a blocked start."""
        return self.path[1:] if self.escape > 0.0 else self.path

    @property
    def frame(self) -> str:
        """Return the map's frame, empty without a map."""
        return '' if self.snapshot is None else self.snapshot.frame

    @property
    def goal_orientation(self) -> Quaternion:
        """Return the orientation asked for at the goal, with norm 1."""
        return normalised(self.request.goal.orientation) or LEVEL

    @property
    def offset(self) -> float:
        """Return how far the path ends from the goal asked for [m]; NaN without a path."""
        if not self.solved:
            return math.nan
        return float(math.dist(self.path[-1], self.request.goal.point))


def check_request(request: Request) -> None:
    """Raise Refusal (NO_START, BAD_REQUEST) when `request` makes no sense on any map."""
    if request.start is NOWHERE:
        raise Refusal(Outcome.NO_START, 'there is no start yet to plan from')
    if request.goal is NOWHERE:
        raise Refusal(Outcome.BAD_REQUEST, 'there is no goal to plan to')
    for name, pose in request.named_poses:
        for part, numbers in (('position', pose.position), ('orientation', pose.orientation)):
            if not all(math.isfinite(number) for number in numbers):
                raise Refusal(
                    Outcome.BAD_REQUEST,
                    f'the {part} of the {name} must be finite, got {list(numbers)}',
                )
        if pose.stamp < 0:
            raise Refusal(
                Outcome.BAD_REQUEST,
                f'the stamp of the {name} must not be negative, got {pose.stamp} ns',
            )
    if normalised(request.goal.orientation) is None:
        raise Refusal(
            Outcome.BAD_REQUEST,
            'the orientation of the goal must be a quaternion with a norm above 0, got '
            f'{list(request.goal.orientation)}',
        )
    if not 0.0 <= request.tolerance < math.inf:
        raise Refusal(
            Outcome.BAD_REQUEST,
            f'the tolerance must be finite and not negative, got {request.tolerance} m',
        )
