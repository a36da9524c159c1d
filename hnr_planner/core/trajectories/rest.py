"""
Motions from a moving start to rest: straight braking, or a tree of Hit-and-Run steps on curves.

If straight braking meets the boundary, a tree grows from the start. A step has full acceleration
in a uniform random direction. Its duration is uniform up to the time at which the curve meets the
boundary or the limit on speed, at most ``HORIZON`` times the time to brake from full speed. The
tree is complete with the first state from which straight braking is free.
"""

import math

from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import uniform
from hnr_planner.core.lengths import norm
from hnr_planner.core.spaces.lines import uniform_direction
from hnr_planner.core.systems.primitives import brake, contact, move
from hnr_planner.core.trajectories.problem import SHORTEST_STEP
from hnr_planner.core.trajectories.steps import can_brake
from hnr_planner.core.trees import NONE

#: Longest step, in units of the time to brake from full speed.
HORIZON = 2.0
#: Fraction of steps that begin at the start: from most later states braking is not free either.
FROM_START = 0.5


@kernel
def come_to_rest(problem, rng, steps, n_rows, n_iterations):
    """
    Grow the tree in the table ``steps`` until straight braking from a state is free.

    Returns (number of rows, transitions made, row that is at rest). The last is NONE (-1) if
    ``n_iterations`` steps were not enough.
    """
    if n_rows == 1 and can_brake(problem, steps.states[0], steps.controls.shape[1]):
        n_rows = _braked(problem.system, steps, n_rows, 0)
        return n_rows, 0, n_rows - 1
    for k in range(n_iterations):
        row = 0 if uniform(rng) < FROM_START else math.floor(uniform(rng) * n_rows)
        if not _curve_step(problem, rng, steps, row, n_rows):
            continue
        n_rows += 1
        if can_brake(problem, steps.states[n_rows - 1], steps.controls.shape[1]):
            n_rows = _braked(problem.system, steps, n_rows, n_rows - 1)
            return n_rows, k + 1, n_rows - 1
    return n_rows, n_iterations, NONE


@kernel
def _braked(system, steps, n_rows, row):
    """
    Append the state at rest after straight braking from ``row``; return the number of rows.

    A state that would brake for less than ``SHORTEST_STEP`` counts as at rest: nothing is
    appended.
    """
    state, control, end = steps.states[row], steps.controls[n_rows], steps.states[n_rows]
    duration = brake(system, state, control)
    if duration < SHORTEST_STEP:
        return n_rows
    move(system, state, control, duration, end)
    dim = len(control)
    for i in range(dim, len(end)):
        end[i] = 0.0
    steps.parents[n_rows], steps.durations[n_rows] = row, duration
    return n_rows + 1


@kernel
def _curve_step(problem, rng, steps, row, n_rows):
    """
    Write to row ``n_rows`` a random step from ``row``; return whether it may be kept.

    It may if it lasts at least ``SHORTEST_STEP`` and its end keeps the limit on speed.
    """
    system = problem.system
    state, control, end = steps.states[row], steps.controls[n_rows], steps.states[n_rows]
    dim = len(control)
    uniform_direction(rng, control)
    speed, along = norm(state[dim:]), 0.0
    for i in range(dim):
        control[i] *= system.max_acceleration
        along += control[i] * state[dim + i]
    strongest = system.max_acceleration
    unused = max(system.max_speed**2 - speed * speed, 0.0)
    until_fastest = (math.sqrt(along * along + strongest * strongest * unused) - along) / (
        strongest * strongest
    )
    longest = min(until_fastest, HORIZON * system.max_speed / strongest)
    met = contact(system, problem.geometric.space, state, control, longest)
    duration = uniform(rng) * min(met, longest)
    move(system, state, control, duration, end)
    steps.parents[n_rows], steps.durations[n_rows] = row, duration
    return duration >= SHORTEST_STEP and norm(end[dim:]) <= system.max_speed
