"""
The controller of the paper's two kinodynamic planners, with their settings and searches.

A transition drives towards a target, a desired position and velocity (paper, Section 5): the
controller takes one step of constant control after another, each as near to the target as the
limits of the system allow.
"""

from dataclasses import dataclass, field
from typing import ClassVar, Literal, NamedTuple, TypeAlias

from hnr_planner.core.checks import check_choice, check_number, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.planning.planner import with_capacity
from hnr_planner.core.systems.primitives import steer, velocity
from hnr_planner.core.systems.system import check_limit
from hnr_planner.core.trajectories.problem import (
    BOUNDARIES,
    Boundary,
    is_at_goal,
    KinodynamicProblem,
    Motion,
    SHORTEST_STEP,
)
from hnr_planner.core.trajectories.steps import first_step, motion_to, Steps, take_step
import numpy as np
from numpy.typing import NDArray

#: End of a transition: 'arrival', when the target comes no nearer; 'step', after one step.
Transition: TypeAlias = Literal['arrival', 'step']
TRANSITIONS: tuple[Transition, ...] = ('arrival', 'step')
#: Largest number of steps in one transition.
STEPS_MAX = 256


class Driving(NamedTuple):
    """
    Settings of a driven planner, as a NamedTuple for kernels.

    Attributes
    ----------
    inelastic : bool
        Whether the boundary stops the robot; otherwise a step that meets it is not taken.
    one_step : bool
        Whether a transition is one step; otherwise it goes on until the target comes no nearer.
    time_step : float
        Duration of a step [s], unless the boundary cuts it short.
    velocity_weight : float
        Factor [s] that makes a difference in velocity comparable with one in position.

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
    boundary : 'forbidden' or 'inelastic'
        Effect of the boundary. Forbidden: steps that meet it are not taken. Inelastic (the
        paper's): the robot stops right before it and may go on from there.
    transition : 'arrival' or 'step'
        Unit of the count of transitions, which the paper leaves open: driving until the target
        comes no nearer or the boundary is met, or one step.
    time_step : float
        Duration of an integration step [s], finite, at least 2e-9.
    velocity_weight : float
        Factor [s] that makes a difference in velocity comparable with one in position, for the
        controller and, in RRT, for the nearest vertex.

    """

    boundary: Boundary = 'forbidden'
    transition: Transition = 'arrival'
    time_step: float = 0.1
    velocity_weight: float = 1.0

    samples_goal: ClassVar[bool] = True

    def __post_init__(self) -> None:
        check_choice('boundary', self.boundary, BOUNDARIES)
        check_choice('transition', self.transition, TRANSITIONS)
        time_step = check_limit('time_step', self.time_step)
        if time_step < SHORTEST_STEP:
            raise RequestError(
                f'time_step must be at least {SHORTEST_STEP:g} s, got {time_step!r}'
            )
        object.__setattr__(self, 'time_step', time_step)
        weight = check_number('velocity_weight', self.velocity_weight, 0.0, 1e9)
        object.__setattr__(self, 'velocity_weight', weight)

    @property
    def driving(self) -> Driving:
        """The settings as a ``Driving``, which kernels take."""
        return Driving(
            self.boundary == 'inelastic',
            self.transition == 'step',
            self.time_step,
            self.velocity_weight,
        )


@dataclass
class DrivenSearch:
    """A running search that stores its steps in a table, which grows with every batch."""

    problem: KinodynamicProblem
    driving: Driving
    rng: Stream
    iterations: int = field(init=False, default=0)
    solved: bool = field(init=False, default=False)
    n_steps: int = field(init=False, default=0)
    _n_rows: int = field(init=False, default=1)
    _steps: Steps = field(init=False)

    def __post_init__(self) -> None:
        self._steps = first_step(self.problem)

    @property
    def samples(self) -> Floats:
        """Positions (k, dim) at the start and at the end of each step."""
        rows = slice(self._n_rows)
        return self._steps.states[rows, : len(self.problem.geometric.goal)]

    @property
    def parents(self) -> NDArray[np.int64]:
        """Index (k,) into ``samples`` of the sample that each step began at; -1 for the start."""
        return self._steps.parents[: self._n_rows]

    @property
    def counts(self) -> dict[str, int]:
        """Number of integration steps tried, as ``integration_steps``: also those not taken."""
        return {'integration_steps': self.n_steps}

    @property
    def motion(self) -> Motion:
        """The motion from the start to the newest state: the solution once ``solved`` is true."""
        return motion_to(self._steps, self._n_rows - 1)

    def draft(self, motion: Motion) -> Motion:
        """Return ``motion`` unchanged: this search knows no better motion to shorten."""
        return motion

    def _grow_arrays(self, n_iterations: int) -> None:
        rows = self._n_rows + n_iterations * (1 if self.driving.one_step else STEPS_MAX)
        self._steps = Steps(*(with_capacity(column, rows) for column in self._steps))


@kernel
def drive(problem, driving, steps, n_rows, parent, position, velocity_wanted):
    """
    Drive from row ``parent`` of the table ``steps`` towards a desired position and velocity.

    Returns (number of rows, steps tried, whether the goal is reached). The first step is kept if
    the boundary permits it; a later step is kept only if it comes nearer to the target, or if the
    boundary stops it. Driving ends at the first step that is not kept, at the boundary, at the
    goal, or after ``STEPS_MAX`` steps (one step with ``one_step``).
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
        duration, stopped = take_step(
            problem, driving.inelastic, driving.time_step, state, control, end
        )
        tried += 1
        if duration < 0.0:
            break
        away = _squared_distance(problem.system, driving, end, position, velocity_wanted)
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
def _squared_distance(system, driving, state, position, velocity_wanted):
    """Return the squared distance of a state to a target, over position and weighted velocity."""
    dim = len(position)
    v, squared = np.empty(dim), 0.0
    velocity(system, state, v)
    for i in range(dim):
        squared += (position[i] - state[i]) ** 2
        squared += (driving.velocity_weight * (velocity_wanted[i] - v[i])) ** 2
    return squared
