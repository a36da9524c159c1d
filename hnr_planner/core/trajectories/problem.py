"""
Planning problems for systems, and the interface of their planners and searches.

A planner is a frozen dataclass whose fields are its settings; its ``start`` gives a search, and
``advance`` counts transitions, as for paths; but a search ends with a motion. All arrays are in
the kernel frame of the space.
"""

from typing import Any, Literal, NamedTuple, Protocol, TypeAlias

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.lengths import distance, norm
from hnr_planner.core.planning.planner import Problem, Search
from hnr_planner.core.systems.primitives import velocity
import numpy as np

#: Effect of the boundary: it must not be met, or it stops the robot, which continues from there.
Boundary: TypeAlias = Literal['forbidden', 'inelastic']
BOUNDARIES: tuple[Boundary, ...] = ('forbidden', 'inelastic')
#: Shortest step of a motion [s]; twice the shortest of a trajectory, whose times are rounded sums.
SHORTEST_STEP = 2e-9


class KinodynamicProblem(NamedTuple):
    """
    A planning problem for a system in the kernel frame of a space, as it is passed to kernels.

    Attributes
    ----------
    geometric : Problem
        The problem for a point without inertia.
    system : NamedTuple
        The compiled system.
    start : (state_dim,)
        The state at the start.
    goal_speed : float
        Largest speed in the goal region; may be inf.

    """

    geometric: Problem
    system: Any
    start: Floats
    goal_speed: float


class Motion(NamedTuple):
    """Durations (m - 1,) [s] and controls (m - 1, control_dim) of steps; states (m, state_dim)."""

    durations: Floats
    states: Floats
    controls: Floats


class KinodynamicSearch(Search, Protocol):
    """A running search for a motion."""

    @property
    def motion(self) -> Motion:
        """Motion of a solved search, as it was found."""

    def draft(self, motion: Motion) -> Motion:
        """Return the motion from which shortening starts: ``motion``, or a better one."""


class KinodynamicPlanner(Protocol):
    """A planner for systems."""

    @property
    def name(self) -> str:
        """Name in the table of algorithms."""

    @property
    def boundary(self) -> Boundary:
        """Effect of the boundary on a step that meets it."""

    @property
    def samples_goal(self) -> bool:
        """Whether states are sampled, so that only a goal region can be reached, not a point."""

    def start(self, problem: KinodynamicProblem, rng: Stream) -> KinodynamicSearch:
        """Start a search for a motion that solves ``problem``, with a random stream."""


@kernel
def is_at_goal(problem, state):
    """Return whether a state lies in the goal region and is slow enough for it."""
    geometric, dim = problem.geometric, len(problem.geometric.goal)
    if distance(state[:dim], geometric.goal) > geometric.goal_radius:
        return False
    return speed_of(problem.system, state, dim) <= problem.goal_speed


@kernel
def speed_of(system, state, dim):
    """Return the speed of a state (state_dim,)."""
    v = np.empty(dim)
    velocity(system, state, v)
    return norm(v)
