"""
Steps of constant control: the table of a search, and the effect of the boundary on a step.

Every step is a row of the table, with the row that it began at. The effect of the boundary on a
step that meets it is a setting:

``forbidden``
    The step is not taken; nor is one from whose end straight braking would meet the boundary. So
    from every state in the table a collision can be avoided.
``inelastic``
    The step ends right before the boundary, and at rest (paper, Section 5).
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
    Steps in a table; row 0 is the start, which is the end of no step.

    Attributes
    ----------
    states : (rows, state_dim)
        The state at the end of each step.
    parents : (rows,) int64
        The row that the step began at; NONE for the start.
    controls : (rows, control_dim)
        Control of each step.
    durations : (rows,)
        Duration of each step [s].

    """

    states: Floats
    parents: NDArray[np.int64]
    controls: Floats
    durations: Floats


def first_step(problem: KinodynamicProblem) -> Steps:
    """Return the table that holds the start."""
    start, control_dim = problem.start, len(problem.geometric.goal)
    return Steps(
        start[np.newaxis].copy(), np.array([NONE]), np.zeros((1, control_dim)), np.zeros(1)
    )


def motion_to(steps: Steps, row: int) -> Motion:
    """Return the motion of the steps from the start to ``row``."""
    rows = rows_to(steps.parents, row)
    return Motion(steps.durations[rows[1:]], steps.states[rows], steps.controls[rows[1:]])


@kernel
def take_step(problem, inelastic, duration, state, control, end):
    """
    Write the end of a step of at most ``duration``.

    Returns (its duration, below 0 where it is not taken; whether the boundary stopped it).
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
    Write the state at rest right before the boundary is met; return when, below 0 for never.

    It is earlier than contact by the time in which full speed covers the margin, and by more where
    the boundary is met at a grazing angle. A moving robot that is nearer to the boundary stops at
    once.
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
