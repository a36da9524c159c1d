"""
What a kinodynamic planner is: like every planner, but its search ends with a motion.

A planner is a frozen dataclass whose fields are its settings, its ``start`` gives a search, and
``advance`` counts transitions. All arrays are in the space's kernel frame.
"""

from typing import Any, Literal, NamedTuple, Protocol, TypeAlias

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.lengths import distance, norm
from hnr_planner.core.planning.planner import Problem, Search
from hnr_planner.core.systems.primitives import velocity
import numpy as np

#: What the boundary does: it stops the robot, which goes on from there, or it must not be met.
Boundary: TypeAlias = Literal['inelastic', 'forbidden']
BOUNDARIES: tuple[Boundary, ...] = ('inelastic', 'forbidden')


class KinodynamicProblem(NamedTuple):
    """
    A planning problem for a system; kernels take it as it is.

    Attributes
    ----------
    place : Problem
        Where to go from and to, as for a robot without inertia.
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
    """States (m, state_dim), and the control of each step (m - 1, control_dim) for its time."""

    durations: Floats
    states: Floats
    controls: Floats


class KinodynamicSearch(Search, Protocol):
    """A search for a motion."""

    @property
    def motion(self) -> Motion:
        """Return the motion of a solved search."""


class KinodynamicPlanner(Protocol):
    """A planner for systems."""

    @property
    def name(self) -> str:
        """Name in the table of algorithms."""

    @property
    def boundary(self) -> Boundary:
        """What the boundary does."""

    @property
    def samples_goal(self) -> bool:
        """Whether it is only by chance that a state lies in the goal region."""

    def start(self, problem: KinodynamicProblem, rng: Stream) -> KinodynamicSearch:
        """Start a search."""


@kernel
def is_at_goal(problem, state):
    """Say whether a state lies in the goal region and is slow enough for it."""
    geometric, dim = problem.geometric, len(problem.geometric.goal)
    if distance(state[:dim], geometric.goal) > geometric.goal_radius:
        return False
    return speed_of(problem.system, state, dim) <= problem.goal_speed


@kernel
def speed_of(system, state, dim):
    """Speed of a state."""
    v = np.empty(dim)
    velocity(system, state, v)
    return norm(v)
