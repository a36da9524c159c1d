"""
Planning problems for systems, and the interface of their planners and searches.

A planner is a frozen dataclass whose fields are its settings. Its method ``start`` returns a
search, whose ``advance`` counts transitions, as in a search for a path; but the search ends with a
motion. All arrays are in the kernel frame of the space.
"""

from typing import Any, Literal, NamedTuple, Protocol, TypeAlias

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.lengths import distance, norm
from hnr_planner.core.planning.planner import Problem, Search
from hnr_planner.core.systems.primitives import velocity
import numpy as np

#: Effect of the boundary: forbidden, no step may meet it; inelastic, it stops the robot, which
#: continues from rest.
Boundary: TypeAlias = Literal['forbidden', 'inelastic']
BOUNDARIES: tuple[Boundary, ...] = ('forbidden', 'inelastic')
#: Shortest step of a motion [s]; twice the shortest of a trajectory, whose times are rounded sums.
SHORTEST_STEP = 2e-9


class KinodynamicProblem(NamedTuple):
    """
    A planning problem for a system in the kernel frame of a space, as a NamedTuple for kernels.

    Attributes
    ----------
    geometric : Problem
        The same start position, goal and space for a point without inertia.
    system : NamedTuple
        The compiled system.
    start : (state_dim,)
        The state at the start.
    goal_speed : float
        Largest speed at which a state in the goal region solves the problem; may be inf.

    """

    geometric: Problem
    system: Any
    start: Floats
    goal_speed: float


class Motion(NamedTuple):
    """
    A motion in steps of constant control, in the kernel frame of a space.

    Step ``k`` leads from ``states[k]`` to ``states[k + 1]``: durations (m - 1,) [s], states
    (m, state_dim), controls (m - 1, control_dim).
    """

    durations: Floats
    states: Floats
    controls: Floats


class KinodynamicSearch(Search, Protocol):
    """A running search for a motion of a system."""

    @property
    def motion(self) -> Motion:
        """Motion from start to goal as the search found it; valid only once ``solved`` is true."""

    def draft(self, motion: Motion) -> Motion:
        """Return the motion from which shortening starts: ``motion``, or a faster one."""


class KinodynamicPlanner(Protocol):
    """A planner for systems: settings, and a method that starts a search."""

    @property
    def name(self) -> str:
        """Name in the table of algorithms."""

    @property
    def boundary(self) -> Boundary:
        """Effect of the boundary on a step that meets it."""

    @property
    def samples_goal(self) -> bool:
        """Whether states are random, so that a goal needs a radius and a goal speed above 0."""

    def start(self, problem: KinodynamicProblem, rng: Stream) -> KinodynamicSearch:
        """Return a new search for a motion that solves ``problem``, with a random stream."""


@kernel
def is_at_goal(problem, state):
    """Return whether a state lies in the goal region and is no faster than ``goal_speed``."""
    geometric, dim = problem.geometric, len(problem.geometric.goal)
    if distance(state[:dim], geometric.goal) > geometric.goal_radius:
        return False
    return speed_of(problem.system, state, dim) <= problem.goal_speed


@kernel
def speed_of(system, state, dim):
    """Return the speed of a state (state_dim,) whose position has ``dim`` coordinates."""
    v = np.empty(dim)
    velocity(system, state, v)
    return norm(v)
