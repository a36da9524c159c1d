"""
Steps of constant control: the table of a search, and the effect of the boundary on a step.

Every step is a row of the table, and names the row whose state the step began at. The effect of
the boundary on a step that meets it is a setting:

``forbidden``
    The step is not taken. Nor is a step taken from whose end straight braking would meet the
    boundary. So from every state in the table, except perhaps the start, a collision can be
    avoided.
``inelastic``
    The step ends right before the boundary, in a state at rest (paper, Section 5).
"""

from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.copies import copy_into
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.lengths import distance
from hnr_planner.core.spaces.primitives import contains_around
from hnr_planner.core.systems.primitives import brake, contact, halt, move
from hnr_planner.core.trajectories.problem import (
    KinodynamicProblem,
    Motion,
    SHORTEST_STEP,
    speed_of,
)
from hnr_planner.core.trees import NONE, rows_to
import numpy as np
from numpy.typing import NDArray


class Steps(NamedTuple):
    """
    The steps of a search as rows; row 0 is the start, which no step leads to.

    Attributes
    ----------
    states : (rows, state_dim)
        The state at the end of each step, in the kernel frame.
    parents : (rows,) int64
        The row whose state the step began at; NONE (-1) for the start.
    controls : (rows, control_dim)
        Constant control of each step, in the kernel frame.
    durations : (rows,)
        Duration of each step [s].

    """

    states: Floats
    parents: NDArray[np.int64]
    controls: Floats
    durations: Floats


def first_step(problem: KinodynamicProblem) -> Steps:
    """Return a table of one row, the start of ``problem``."""
    start, control_dim = problem.start, len(problem.geometric.goal)
    return Steps(
        start[np.newaxis].copy(), np.array([NONE]), np.zeros((1, control_dim)), np.zeros(1)
    )


def motion_to(steps: Steps, row: int) -> Motion:
    """Return the motion along the steps that lead from the start to ``row`` of the table."""
    rows = rows_to(steps.parents, row)
    return Motion(steps.durations[rows[1:]], steps.states[rows], steps.controls[rows[1:]])


@kernel
def take_step(problem, inelastic, duration, state, control, end):
    """
    Write to ``end`` the state at the end of a step of at most ``duration`` [s].

    Returns (duration of the step [s], whether the boundary stopped the robot). The duration is
    below 0 if the step is not taken.
    """
    space, system = problem.geometric.space, problem.system
    met = contact(system, space, state, control, duration)
    if met > duration:
        move(system, state, control, duration, end)
        if inelastic or can_brake(problem, end, len(control)):
            return duration, False
        return -1.0, False
    if not inelastic:
        return -1.0, False
    return _stop_before(problem, state, control, met, end), True


@kernel
def can_brake(problem, state, control_dim):
    """Return whether braking straight to rest from a state (state_dim,) meets no boundary."""
    control = np.empty(control_dim)
    duration = brake(problem.system, state, control)
    return contact(problem.system, problem.geometric.space, state, control, duration) > duration


@kernel
def _stop_before(problem, state, control, met, end):
    """
    Write to ``end`` the state at rest right before contact; return the time of the stop [s].

    ``met`` is the time of contact [s] from ``state``. The stop is earlier by the time in which
    full speed covers the margin, and by more where the boundary is met at a grazing angle. If the
    robot would advance by no more than the margin, it stops at once, in ``SHORTEST_STEP``; if it
    was at rest already, the return value is below 0: the step is not taken.
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
    if duration < SHORTEST_STEP or distance(end[:dim], state[:dim]) <= geometric.margin:
        if speed_of(problem.system, state, dim) == 0.0:
            return -1.0
        duration = SHORTEST_STEP
        copy_into(end, state)
    halt(problem.system, end)
    return duration
