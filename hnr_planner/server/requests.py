"""What is asked of the planner: data, without ROS."""

from dataclasses import dataclass
import math

from hnr_planner.ros.messages.orientations import LEVEL, normalised, Quaternion
from hnr_planner.server.outcomes import Outcome, Refusal


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
class PlanRequest:
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


def check_request(request: PlanRequest) -> None:
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
