"""
Reducing a long motion of the double integrator: most of its steps are cut out, at little cost.

A chain of Hit-and-Run may wander for hours before it meets the goal, in hundreds of thousands of
steps. Here two of its states, at random, are connected directly, and a connection that is free and
faster replaces all steps between them. A proposal takes the same time however long the motion is.
"""

import math

from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.copies import copy_into
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream, uniform
from hnr_planner.core.lengths import distance
from hnr_planner.core.planning.limits import Budget
from hnr_planner.core.systems.primitives import move
from hnr_planner.core.trajectories.problem import KinodynamicProblem, Motion
from hnr_planner.core.trajectories.shorten import is_free
from hnr_planner.core.trajectories.two_point import connect, empty_connection

#: A motion of more steps is one that no robot would drive.
STEPS_MAX = 10_000
#: Steps at which a motion is short enough to be shortened in time as it is.
STEPS_ENOUGH = 1000
#: Proposals at most, and between two looks at the budget.
PROPOSALS, PROPOSALS_IN_A_BATCH = 20_000, 100


def reduce(problem: KinodynamicProblem, motion: Motion, rng: Stream, budget: Budget) -> Motion:
    """Return a motion with the same ends, with few steps if the proposals and the budget allow."""
    durations, states, controls = (array.copy() for array in motion)
    n = len(durations)
    for _ in range(PROPOSALS // PROPOSALS_IN_A_BATCH):
        n = _reduce(
            problem, durations, states, controls, n, rng, PROPOSALS_IN_A_BATCH, STEPS_ENOUGH
        )
        if n <= STEPS_ENOUGH or budget.stop() is not None:
            break
    return Motion(durations[:n].copy(), states[: n + 1].copy(), controls[:n].copy())


@kernel
def _reduce(problem, durations, states, controls, n, rng, proposals, enough):
    """Apply proposals to the first ``n`` steps of a motion in place; return how many are left."""
    problem, rng = borrowed(problem), borrowed(rng)
    system, dim = problem.system, controls.shape[1]
    room = empty_connection(dim)
    # A connection has fewer steps than every window.
    shortest = len(room.durations) + 1
    to_rest = system.max_speed / system.max_acceleration
    for _ in range(proposals):
        if n <= max(enough, shortest):
            break
        window = shortest + math.floor((n - shortest) * uniform(rng) ** 2)
        i = math.floor((n - window + 1) * uniform(rng))
        j = i + window
        a, b = states[i], states[j]
        longest = 2.0 * distance(a[:dim], b[:dim]) / system.max_speed + 4.0 * to_rest
        duration = connect(system, a, b, longest, room)
        if duration == math.inf or not is_free(problem, a, room):
            continue
        if duration < durations[i:j].sum():
            n = _replace(system, durations, states, controls, n, i, j, room)
    return n


@kernel
def _replace(system, durations, states, controls, n, i, j, connection):
    """Replace steps ``i`` to ``j`` - 1 by a connection of fewer, in place; return the steps."""
    pieces, state_dim, dim = connection.n[0], states.shape[1], controls.shape[1]
    fewer = j - i - pieces
    for k in range(pieces):
        durations[i + k] = connection.durations[k]
        copy_into(controls[i + k], connection.controls[k])
        if k + 1 < pieces:
            move(system, states[i + k], controls[i + k], durations[i + k], states[i + k + 1])
    for k in range(j, n):
        durations[k - fewer] = durations[k]
        for m in range(dim):
            controls[k - fewer, m] = controls[k, m]
    for k in range(j, n + 1):
        for m in range(state_dim):
            states[k - fewer, m] = states[k, m]
    return n - fewer
