"""Requests for paths as data classes, and the checks of a request that need no map."""

from dataclasses import dataclass
import math

from hnr_planner.core import KINODYNAMIC_PLANNERS
from hnr_planner.server.geometry.orientations import LEVEL, normalised, Quaternion
from hnr_planner.server.parameters.settings import SERVED_ALGORITHMS
from hnr_planner.server.requests.outcomes import Outcome, Refusal


@dataclass(frozen=True)
class Pose:
    """
    A pose as it was requested, not checked yet.

    Parameters
    ----------
    position : (x, y, z)
        Position in ``frame`` [m].
    orientation : Quaternion
        Orientation in ``frame``: (x, y, z, w), of any norm.
    frame : str
        Frame of position and orientation; empty for the map's frame.
    stamp : int
        ROS time [ns] at which the transform from ``frame`` is looked up; 0 for the latest known.

    """

    position: tuple[float, float, float]
    orientation: Quaternion = LEVEL
    frame: str = ''
    stamp: int = 0

    @property
    def point(self) -> tuple[float, float]:
        """Position (x, y) in the frame of the pose [m]."""
        return self.position[0], self.position[1]


#: Stands for a start or goal that a request lacks; it is refused as NO_START or BAD_REQUEST.
NOWHERE = Pose((math.nan, math.nan, math.nan))


@dataclass(frozen=True)
class PlanRequest:
    """
    A request for a path from ``start`` through the poses of ``via`` to ``goal``.

    Parameters
    ----------
    start, goal : Pose
        The ends of the path.
    tolerance : float
        Largest distance [m] from the goal at which the path may end, where the goal is blocked or
        unreachable; it holds for each pose of ``via`` too.
    algorithm : str
        One of ``SERVED_ALGORITHMS``.
    via : tuple of Pose
        Poses to pass between start and goal, in their order.

    """

    start: Pose
    goal: Pose
    tolerance: float
    algorithm: str
    via: tuple[Pose, ...] = ()

    @property
    def named_poses(self) -> tuple[tuple[str, Pose], ...]:
        """All poses in the order of the path, as pairs (name in words, pose)."""
        via = tuple((f'pose {number} on the way', pose) for number, pose in enumerate(self.via, 1))
        return (('start', self.start), *via, ('goal', self.goal))

    @property
    def omits_start(self) -> bool:
        """Whether the start has an empty frame and lies at (0, 0), as if it was left out."""
        return self.start.frame == '' and self.start.point == (0.0, 0.0)

    @property
    def has_inertia(self) -> bool:
        """Whether the algorithm plans for a robot with inertia (a kinodynamic planner)."""
        return self.algorithm in KINODYNAMIC_PLANNERS

    @property
    def names_a_planner(self) -> bool:
        """Whether the algorithm is served, and without inertia where there are ``via`` poses."""
        return self.algorithm in SERVED_ALGORITHMS and not (self.has_inertia and self.via)


def check_request(request: PlanRequest) -> None:
    """
    Raise Refusal (NO_START, BAD_REQUEST) when ``request`` cannot be served on any map.

    Start and goal must be there, the algorithm must be served, positions and orientations must be
    finite, stamps not negative, the norm of the goal's orientation above 0, and the tolerance
    finite and not negative.
    """
    if request.start is NOWHERE:
        raise Refusal(Outcome.NO_START, 'there is no start yet to plan from')
    if request.goal is NOWHERE:
        raise Refusal(Outcome.BAD_REQUEST, 'there is no goal to plan to')
    _check_algorithm(request)
    for name, pose in request.named_poses:
        _check_pose(name, pose)
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


def _check_algorithm(request: PlanRequest) -> None:
    if request.names_a_planner:
        return
    if request.has_inertia:
        why = f'{request.algorithm} plans from one pose to another, not through poses on the way'
    else:
        names = ', '.join(SERVED_ALGORITHMS)
        why = f'no planner is called {request.algorithm!r}: the names are {names}'
    raise Refusal(Outcome.BAD_REQUEST, why)


def _check_pose(name: str, pose: Pose) -> None:
    for field, numbers in (('position', pose.position), ('orientation', pose.orientation)):
        if not all(math.isfinite(number) for number in numbers):
            raise Refusal(
                Outcome.BAD_REQUEST,
                f'the {field} of the {name} must be finite, got {list(numbers)}',
            )
    if pose.stamp < 0:
        raise Refusal(
            Outcome.BAD_REQUEST,
            f'the stamp of the {name} must not be negative, got {pose.stamp} ns',
        )
