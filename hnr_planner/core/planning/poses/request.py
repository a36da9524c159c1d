"""Validation of requests for paths of poses, and their problem in the kernel frame."""

from dataclasses import dataclass
import math
from typing import Any

from hnr_planner.core.checks import check_number, check_point, check_seed, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.streams import Stream, stream
from hnr_planner.core.planning.poses.connections import Prices
from hnr_planner.core.planning.poses.search import drives_ahead_only, POSE_PLANNERS, proposals_of
from hnr_planner.core.planning.poses.trees import PoseProblem, Proposals
from hnr_planner.core.spaces.poses.disc import Disc
from hnr_planner.core.spaces.poses.drive import CAR, OMNIDIRECTIONAL
from hnr_planner.core.spaces.poses.motion import wrap
from hnr_planner.core.spaces.poses.pose_space import PoseSpace
import numpy as np
from numpy.typing import ArrayLike

#: Names of ``plan`` that stand for another planner here.
STANDS_FOR = {'auto': 'hit_and_run_connect'}
#: Number of poses of a goal region that the goal's tree grows from.
N_GOALS = 16
#: Price of a change between driving ahead and backwards, in turning radii of a car, or in reaches
#: of other footprints; and that of turning in place by 1 rad, in reaches.
CHANGE, TURN = 1.0, 0.5
#: Distance that counts as much as a turn of 1 rad for the nearest vertex, in turning radii or
#: reaches, and that for a car that must not reverse, for which a turn is a long way.
WEIGHT, WEIGHT_AHEAD = 0.5, 1.0
#: ``PoseProblem.lead`` and ``PoseProblem.room`` of a car that must not reverse, in turning radii.
LEAD, ROOM = 0.7, 1.0
#: Distance [cells] before a contact at which motions stop, at the least: a path that touches an
#: obstacle but for rounding is of no use to a robot.
STAND_OFF = 1e-3


@dataclass(frozen=True)
class PoseRequest:
    """
    A validated request for a path of poses, in the caller's frame.

    Attributes
    ----------
    space : PoseSpace
        Where the robot has to be free.
    start, goal : (3,)
        Poses [m, m, rad].
    goal_radius, heading_tolerance : float
        How far the path's end may be from the goal [m], and how far it may be turned [rad].
    name : str
        Name of the planner.
    proposals : Proposals
        How the planner extends its trees.
    simplify : bool
        Whether the path is shortened.
    reverse_penalty : float
        Factor on the length driven backwards.
    seed : int
        Seed from which every random stream of the request follows.

    """

    space: PoseSpace
    start: Floats
    goal: Floats
    goal_radius: float
    heading_tolerance: float
    name: str
    proposals: Proposals
    simplify: bool
    reverse_penalty: float
    seed: int

    def stream(self, *purpose: int) -> Stream:
        """Return the random stream that follows from the seed and the numbers of a purpose."""
        return stream(self.seed, *purpose)

    @property
    def prices(self) -> Prices:
        """What motions cost, in the kernel frame."""
        data = self.space.data
        if data.drive == OMNIDIRECTIONAL:
            return Prices(1.0, 0.0, TURN * data.reach)
        unit = 1.0 / data.max_curvature if data.drive == CAR else data.reach
        return Prices(self.reverse_penalty, CHANGE * unit, TURN * data.reach)

    def problem(self, guide: Floats, disc: Disc) -> PoseProblem:
        """Return the problem in the kernel frame, with a guide (k, 3) of the disc."""
        space = self.space
        data = space.data
        lower, upper = space.kernel_bounds
        is_ahead_only = drives_ahead_only(space)
        unit = 1.0 / data.max_curvature if data.drive == CAR else data.reach
        return PoseProblem(
            data,
            self.prices,
            lower,
            upper,
            guide,
            disc.kernel_centre,
            (WEIGHT_AHEAD if is_ahead_only else WEIGHT) * unit,
            max(space.margin, STAND_OFF),
            LEAD * unit if is_ahead_only else 0.0,
            ROOM * unit if is_ahead_only else 0.0,
        )

    def ends(self) -> Floats:
        """
        Return the start, the goal, and further poses of the goal region (k, 3), caller's frame.

        They are drawn uniformly, where the region is more than one pose.
        """
        ends = np.array((self.start, self.goal))
        if self.goal_radius == 0.0 and self.heading_tolerance == 0.0:
            return ends
        rng = np.random.default_rng(self.seed)
        angle = rng.uniform(-math.pi, math.pi, N_GOALS - 1)
        distance = self.goal_radius * np.sqrt(rng.random(N_GOALS - 1))
        turn = self.heading_tolerance * rng.uniform(-1.0, 1.0, N_GOALS - 1)
        away = np.column_stack([distance * np.cos(angle), distance * np.sin(angle), turn])
        return np.vstack([ends, self.goal + away])


def check_pose_request(
    space: PoseSpace,
    start: ArrayLike,
    goal: ArrayLike,
    *,
    algorithm: Any,
    goal_radius: float,
    simplify: bool,
    seed: Any,
    heading_tolerance: float = 0.0,
    reverse_penalty: float = 2.0,
    **unknown: Any,
) -> PoseRequest:
    """Return the validated request, or raise RequestError where an argument is malformed."""
    if unknown:
        raise RequestError(
            f'planners of poses have no setting {next(iter(unknown))!r}; they have '
            f'heading_tolerance, reverse_penalty'
        )
    names = (*STANDS_FOR, *POSE_PLANNERS)
    if not isinstance(algorithm, str) or algorithm not in names:
        raise RequestError(
            f'algorithm must be one of {", ".join(names)} in a PoseSpace, got {algorithm!r}'
        )
    name = STANDS_FOR.get(algorithm, algorithm)
    return PoseRequest(
        space,
        _check_pose('start', start),
        _check_pose('goal', goal),
        check_number('goal_radius', goal_radius, 0.0),
        min(check_number('heading_tolerance', heading_tolerance, 0.0), math.pi),
        name,
        proposals_of(name, space),
        bool(simplify),
        check_number('reverse_penalty', reverse_penalty, 1.0),
        check_seed(seed),
    )


def _check_pose(name: str, pose: ArrayLike) -> Floats:
    """Return ``pose`` (3,) with its yaw in [-pi, pi), or raise RequestError."""
    array = check_point(name, pose, 3)
    if not -math.pi <= array[2] < math.pi:
        array[2] = wrap(array[2])
    return array


def refuse_options(**options: Any) -> None:
    """Raise RequestError for an option of ``plan`` that has no meaning for poses yet."""
    for name, (value, without) in options.items():
        if value != without:
            raise RequestError(
                f'{name} must be {without!r} in a PoseSpace, where it has no meaning, '
                f'got {value!r}'
            )
