"""Compiling what a request runs, before its clock does."""

from typing import Any

from hnr_planner.core.kernels.streams import stream
from hnr_planner.core.planning.limits import Budget
from hnr_planner.core.planning.request import outcome_without_search
from hnr_planner.core.spaces.primitives import kind_of
from hnr_planner.core.trajectories.attempt import is_free, to_trajectory
from hnr_planner.core.trajectories.connect import compile_connect, KinodynamicConnect
from hnr_planner.core.trajectories.inevitable import compile_inevitable
from hnr_planner.core.trajectories.problem import is_at_goal, Motion
from hnr_planner.core.trajectories.request import KinodynamicRequest
from hnr_planner.core.trajectories.shorten import shorten
from hnr_planner.core.trajectories.steps import can_brake
import numpy as np

_compiled: set[tuple[Any, ...]] = set()


def compile_kernels(request: KinodynamicRequest) -> None:
    """Compile, once for each kind of space, planner and system, before any clock runs."""
    system, geometric = request.system, request.problem.geometric
    kinds = kind_of(geometric.space), type(request.planner), type(request.problem.system)
    if kinds in _compiled:
        return
    # Start and goal are not known to be free yet: the corners of the bounds replace them.
    rest = np.append(geometric.lower, np.zeros(system.state_dim - system.dim))
    bounded = geometric._replace(start=geometric.lower, goal=geometric.upper)
    problem = request.problem._replace(geometric=bounded, start=rest)
    outcome_without_search(request.geometric)
    is_at_goal(problem, rest)
    can_brake(problem, rest, system.control_dim)
    compile_inevitable(geometric.space)
    search = request.planner.start(problem, stream(0))
    for _ in range(2):
        search.advance(0)
    if isinstance(request.planner, KinodynamicConnect):
        compile_connect(problem)
    motion = Motion(np.zeros(1), np.stack([rest, rest]), np.zeros((1, system.control_dim)))
    if request.shortens:
        shorten(problem, motion, stream(0), 0, True)
    unlimited = Budget(np.inf)
    trajectory = to_trajectory(request, motion, unlimited)
    is_free(request, trajectory, unlimited)
    trajectory.length  # noqa: B018
    _compiled.add(kinds)
