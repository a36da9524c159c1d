"""
Integration steps: how a transition of the paper's kinodynamic planners is driven.

The controller takes one step of constant control after another towards a desired position and
velocity. Every step is kept as a row of a table, with the row that it came from. What the boundary
does to a step that meets it is a setting:

``inelastic``
    The step ends right before the boundary, and at rest (paper, Section 5).
``forbidden``
    The step is not taken; nor is one whose end could not be braked straight to rest any more. So
    no state that is kept has a collision ahead of it that cannot be avoided.
"""

from dataclasses import dataclass, field
from typing import ClassVar, Literal, NamedTuple, TypeAlias

from hnr_planner.core.checks import check_choice, check_number, Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.lengths import distance
from hnr_planner.core.planning.planner import with_room
from hnr_planner.core.spaces.primitives import contains_around
from hnr_planner.core.systems.system import check_limit
from hnr_planner.core.systems.primitives import brake, contact, halt, move, steer, velocity
from hnr_planner.core.trajectories.problem import (
    BOUNDARIES,
    Boundary,
    is_at_goal,
    KinodynamicProblem,
    Motion,
    speed_of,
)
from hnr_planner.core.trees import NONE, rows_to
import numpy as np
from numpy.typing import NDArray

#: How a transition ends: after one step, or when the target is no longer getting nearer.
Transition: TypeAlias = Literal['arrival', 'step']
TRANSITIONS: tuple[Transition, ...] = ('arrival', 'step')
#: Steps in one transition at most.
STEPS_MAX = 256


class Steps(NamedTuple):
    """
    Steps in a table; row 0 is the start, which no step led to.

    Attributes
    ----------
    states : (rows, state_dim)
        Where each step ends.
    parents : (rows,) int64
        The row where it began; NONE for the start.
    controls : (rows, control_dim)
        Its control.
    durations : (rows,)
        How long it took.

    """

    states: Floats
    parents: NDArray[np.int64]
    controls: Floats
    durations: Floats


class Driving(NamedTuple):
    """
    How transitions are driven; kernels take it as it is.

    Attributes
    ----------
    inelastic : bool
        Whether the boundary stops the robot rather than forbid the step.
    one_step : bool
        Whether a transition is one step.
    time_step : float
        Duration of a step [s].
    velocity_weight : float
        What a difference in velocity counts beside one in position [s].

    """

    inelastic: bool
    one_step: bool
    time_step: float
    velocity_weight: float


@dataclass(frozen=True)
class DrivenPlanner:
    """
    Settings that the paper's two kinodynamic planners share.

    Attributes
    ----------
    boundary : 'inelastic' or 'forbidden'
        What the boundary does: it stops the robot there (the paper's), or it must not be met.
    transition : 'arrival' or 'step'
        What the paper's count of transitions counts, which it does not say: driving until the
        target is no longer getting nearer or the boundary is met, or one step.
    time_step : float
        Duration of an integration step [s], above 0.
    velocity_weight : float
        What a difference in velocity counts beside one in position [s], for the controller and
        for the nearest vertex.

    """

    boundary: Boundary = 'inelastic'
    transition: Transition = 'arrival'
    time_step: float = 0.1
    velocity_weight: float = 1.0

    samples_goal: ClassVar[bool] = True

    def __post_init__(self) -> None:
        check_choice('boundary', self.boundary, BOUNDARIES)
        check_choice('transition', self.transition, TRANSITIONS)
        object.__setattr__(self, 'time_step', check_limit('time_step', self.time_step))
        weight = check_number('velocity_weight', self.velocity_weight, 0.0, 1e9)
        object.__setattr__(self, 'velocity_weight', weight)

    @property
    def driving(self) -> Driving:
        """The settings as kernels take them."""
        return Driving(
            self.boundary == 'inelastic',
            self.transition == 'step',
            self.time_step,
            self.velocity_weight,
        )


@dataclass
class DrivenSearch:
    """A table of steps under way."""

    problem: KinodynamicProblem
    driving: Driving
    rng: Stream
    iterations: int = field(init=False, default=0)
    solved: bool = field(init=False, default=False)
    n_steps: int = field(init=False, default=0)
    _n_rows: int = field(init=False, default=1)
    _steps: Steps = field(init=False)

    def __post_init__(self) -> None:
        self._steps = first_step(self.problem.start, len(self.problem.geometric.goal))

    @property
    def samples(self) -> Floats:
        """Positions (k, dim) at the start and at the end of each step."""
        rows = slice(self._n_rows)
        return self._steps.states[rows, : len(self.problem.geometric.goal)]

    @property
    def parents(self) -> NDArray[np.int64]:
        """Index (k,) of the sample that each step began at."""
        return self._steps.parents[: self._n_rows]

    @property
    def counts(self) -> dict[str, int]:
        """Integration steps, those that were not taken included."""
        return {'integration_steps': self.n_steps}

    @property
    def motion(self) -> Motion:
        """The steps that lead to the newest state."""
        return motion_to(self._steps, self._n_rows - 1)

    def _make_room(self, n_iterations: int) -> None:
        rows = self._n_rows + n_iterations * (1 if self.driving.one_step else STEPS_MAX)
        self._steps = Steps(*(with_room(column, rows) for column in self._steps))


def first_step(start: Floats, control_dim: int) -> Steps:
    """Return the table that holds the start."""
    return Steps(
        start[np.newaxis].copy(), np.array([NONE]), np.zeros((1, control_dim)), np.zeros(1)
    )


def motion_to(steps: Steps, row: int) -> Motion:
    """Return the motion of the steps from the start to ``row``."""
    rows = rows_to(steps.parents, row)
    return Motion(steps.durations[rows[1:]], steps.states[rows], steps.controls[rows[1:]])


@kernel
def drive(problem, driving, steps, n_rows, parent, position, velocity_wanted):
    """
    Drive from row ``parent`` towards a target: (rows, steps tried, whether the goal is reached).

    The first step is kept wherever it leads; a later one that comes no nearer is not.
    """
    row, tried, nearest = parent, 0, np.inf
    while tried < STEPS_MAX:
        state, control, end = steps.states[row], steps.controls[n_rows], steps.states[n_rows]
        steer(
            problem.system,
            state,
            position,
            velocity_wanted,
            driving.velocity_weight,
            driving.time_step,
            control,
        )
        duration, stopped = take_step(problem, driving, state, control, end)
        tried += 1
        if duration < 0.0:
            break
        away = _distance_to(problem.system, driving, end, position, velocity_wanted)
        if tried > 1 and not stopped and away >= nearest:
            break
        nearest = away
        steps.parents[n_rows], steps.durations[n_rows] = row, duration
        row, n_rows = n_rows, n_rows + 1
        if is_at_goal(problem, end):
            return n_rows, tried, True
        if stopped or driving.one_step:
            break
    return n_rows, tried, False


@kernel
def _distance_to(system, driving, state, position, velocity_wanted):
    """Squared distance to a target, as the controller sees it."""
    dim = len(position)
    v, squared = np.empty(dim), 0.0
    velocity(system, state, v)
    for i in range(dim):
        squared += (position[i] - state[i]) ** 2
        squared += (driving.velocity_weight * (velocity_wanted[i] - v[i])) ** 2
    return squared


@kernel
def take_step(problem, driving, state, control, end):
    """Write the end of a step: (how long it took, below 0 for none; whether it was stopped)."""
    space, system = problem.geometric.space, problem.system
    met = contact(system, space, state, control, driving.time_step)
    if met > driving.time_step:
        move(system, state, control, driving.time_step, end)
        if driving.inelastic or can_brake(problem, end, len(control)):
            return driving.time_step, False
        return -1.0, False
    if not driving.inelastic:
        return -1.0, False
    return _stop_before(problem, state, control, met, end), True


@kernel
def can_brake(problem, state, control_dim):
    """Say whether braking straight to rest meets no boundary."""
    control = np.empty(control_dim)
    duration = brake(problem.system, state, control)
    return contact(problem.system, problem.geometric.space, state, control, duration) > duration


@kernel
def _stop_before(problem, state, control, met, end):
    """
    Write the state at rest right before the boundary is met; likewise.

    In the time that the margin takes at full speed; where the boundary is met at a grazing angle
    that is not enough, and it goes back further. A robot already there stops where it is.
    """
    geometric, dim = problem.geometric, len(problem.geometric.goal)
    back = geometric.margin / problem.system.max_speed
    duration = met - back
    while duration > 0.0:
        move(problem.system, state, control, duration, end)
        if contains_around(geometric.space, end[:dim], geometric.margin / 8.0):
            break
        duration -= back
        back *= 10.0
    if duration <= 0.0 or distance(end[:dim], state[:dim]) <= geometric.margin:
        if speed_of(problem.system, state, dim) == 0.0:
            return -1.0
        duration, end[:] = 0.0, state
    halt(problem.system, end)
    return duration
