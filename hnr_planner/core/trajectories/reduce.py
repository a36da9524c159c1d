"""
Reduction of a long motion of the double integrator to fewer steps, in little computing time.

A chain of Hit-and-Run may drive for hours before it meets the goal, in hundreds of thousands of
steps. Here two random states of the motion are connected directly, and a connection that is free
and faster replaces all steps between the two states. The time of a proposal does not depend on the
length of the motion.
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

#: Number of steps above which a motion is too long to be driven.
STEPS_MAX = 10_000
#: Number of steps up to which a motion is shortened in time without a reduction.
STEPS_ENOUGH = 1000
#: Largest number of proposals, and number between two checks of the budget.
PROPOSALS, PROPOSALS_IN_A_BATCH = 20_000, 100


def reduce(problem: KinodynamicProblem, motion: Motion, rng: Stream, budget: Budget) -> Motion:
    """
    Return a motion with the same first and last state, and usually with far fewer steps.

    Proposals stop at ``STEPS_ENOUGH`` steps, after ``PROPOSALS``, or when the budget ends; more
    steps than wanted may be left then.
    """
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
    """
    Apply proposals to the first ``n`` steps of a motion in place; return the number of steps left.

    Proposals end early once at most ``enough`` steps are left.
    """
    problem, rng = borrowed(problem), borrowed(rng)
    system, dim = problem.system, controls.shape[1]
    work = empty_connection(dim)
    # A connection has fewer steps than every window.
    shortest = len(work.durations) + 1
    to_rest = system.max_speed / system.max_acceleration
    for _ in range(proposals):
        if n <= max(enough, shortest):
            break
        window = shortest + math.floor((n - shortest) * uniform(rng) ** 2)
        i = math.floor((n - window + 1) * uniform(rng))
        j = i + window
        a, b = states[i], states[j]
        longest = 2.0 * distance(a[:dim], b[:dim]) / system.max_speed + 4.0 * to_rest
        duration = connect(system, a, b, longest, work)
        if duration == math.inf or not is_free(problem, a, work):
            continue
        if duration < durations[i:j].sum():
            n = _replace(system, durations, states, controls, n, i, j, work)
    return n


@kernel
def _replace(system, durations, states, controls, n, i, j, connection):
    """
    Replace steps ``i`` to ``j`` - 1 in place by a connection of fewer steps.

    Returns the number of steps of the whole motion after that.
    """
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
