"""
Shortening of a motion of the double integrator in time; its duration never increases.

A proposal connects two states of the motion directly, or through a random state near a third one
that lies between the two in time. A connection that is free and faster replaces the motion between
the two states (after Hauser and Ng-Thow-Hing, 2010). The end of the motion may move anywhere in
the goal region, at any speed allowed there.
"""

import math

from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.copies import copy_into, copy_rows
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import normal, Stream, uniform
from hnr_planner.core.sampling.draws import draw_in_ball
from hnr_planner.core.systems.primitives import contact, move
from hnr_planner.core.trajectories.problem import (
    is_at_goal,
    KinodynamicProblem,
    Motion,
    SHORTEST_STEP,
)
from hnr_planner.core.trajectories.steps import can_brake
from hnr_planner.core.trajectories.two_point import connect, empty_connection
import numpy as np

#: Fractions of the proposals that replace the end, and that pass through a random state.
TO_END, THROUGH = 0.2, 0.6
#: Least shift of a random state, as a fraction of the largest that acceleration can cause in the
#: time.
LEAST_SHIFT = 1e-3
#: Least gain as a fraction of the duration; smaller ones would soon be rounding errors.
LEAST_GAIN = 1e-6


def shorten(
    problem: KinodynamicProblem, motion: Motion, rng: Stream, proposals: int, brakes: bool
) -> Motion:
    """
    Return a motion from the same start into the same goal region, after some proposals.

    With ``brakes``, if straight braking from the end of ``motion`` to rest is free, it is free
    from the end of the result too.
    """
    return Motion(*_shorten(problem, *motion, rng, proposals, brakes))


@kernel
def _shorten(problem, durations, states, controls, rng, proposals, brakes):
    """Return durations, states and controls of a motion after ``proposals`` proposals."""
    problem, rng = borrowed(problem), borrowed(rng)
    system, dim = problem.system, controls.shape[1]
    first, second = empty_connection(dim), empty_connection(dim)
    a, between, b = np.empty(2 * dim), np.empty(2 * dim), np.empty(2 * dim)
    total = durations.sum()
    for _ in range(proposals):
        window = total * uniform(rng) ** 2
        to_end = uniform(rng) < TO_END
        begin = total - window if to_end else uniform(rng) * (total - window)
        i, after_i = _locate(durations, begin)
        j, after_j = _locate(durations, begin + window)
        if to_end:
            j, after_j = len(durations) - 1, durations[-1]
        longest = window - max(LEAST_GAIN * total, 2.0 * SHORTEST_STEP)
        move(system, states[i], controls[i], after_i, a)
        move(system, states[j], controls[j], after_j, b)
        if to_end:
            _draw_end(problem, rng, states[-1], b, brakes)
        if uniform(rng) < THROUGH:
            k, after_k = _locate(durations, begin + uniform(rng) * window)
            move(system, states[k], controls[k], after_k, between)
            _shift(system, rng, window, between)
            there = connect(system, a, between, longest, first)
            if there == math.inf:
                continue
            onward = connect(system, between, b, longest - there, second)
            if onward == math.inf:
                continue
            if not (is_free(problem, a, first) and is_free(problem, between, second)):
                continue
        else:
            if connect(system, a, b, longest, first) == math.inf:
                continue
            if not is_free(problem, a, first):
                continue
            second.n[0] = 0
        durations, states, controls = _spliced(
            system,
            durations,
            states,
            controls,
            (i, after_i, j, after_j),
            (a, between, b),
            (first, second),
        )
        total = durations.sum()
    return durations, states, controls


@kernel
def _locate(durations, t):
    """
    Return the index of the step at time ``t`` [s] of a motion, and the time since that step began.

    A time within ``SHORTEST_STEP`` of the begin or end of the step is moved to that begin or end.
    """
    last = len(durations) - 1
    for k in range(last):
        if t < durations[k]:
            return k, _snapped(t, durations[k])
        t -= durations[k]
    return last, _snapped(min(t, durations[last]), durations[last])


@kernel
def _snapped(t, duration):
    """Return ``t``, or 0 or ``duration`` if that is within ``SHORTEST_STEP`` of ``t``."""
    if t < SHORTEST_STEP:
        return 0.0
    return t if t <= duration - SHORTEST_STEP else duration


@kernel
def _shift(system, rng, window, state):
    """
    Shift position and velocity of a state at random, in place.

    The shifts are normal. Their scale is a random fraction, ``LEAST_SHIFT`` to 1, of the change
    that full acceleration can cause in ``window`` [s]; the speed is clipped to the limit.
    """
    dim = len(state) // 2
    fraction = LEAST_SHIFT ** uniform(rng)
    change = fraction * system.max_acceleration * window
    squared = 0.0
    for i in range(dim):
        state[i] += 0.125 * change * window * normal(rng)
        state[dim + i] += 0.5 * change * normal(rng)
        squared += state[dim + i] ** 2
    if squared > system.max_speed**2:
        for i in range(dim):
            state[dim + i] *= system.max_speed / math.sqrt(squared)


@kernel
def _draw_end(problem, rng, last, end, brakes):
    """
    Write to ``end`` a random state in the goal region, at a speed allowed there.

    In half of the calls it is uniform, in the others near the state ``last``. It is ``last`` if
    the draw is not at the goal, or if ``brakes`` and straight braking from it is not free.
    """
    geometric, dim = problem.geometric, len(problem.geometric.goal)
    fraction = LEAST_SHIFT ** uniform(rng) if uniform(rng) < 0.5 else 1.0
    copy_into(end, last)
    offset = np.empty(dim)
    if geometric.goal_radius > 0.0:
        draw_in_ball(geometric.goal_radius, rng, offset)
        for i in range(dim):
            end[i] += fraction * (geometric.goal[i] + offset[i] - end[i])
    fastest = min(problem.goal_speed, problem.system.max_speed)
    if fastest > 0.0:
        draw_in_ball(fastest, rng, offset)
        for i in range(dim):
            end[dim + i] += fraction * (offset[i] - end[dim + i])
    if not is_at_goal(problem, end) or (brakes and not can_brake(problem, end, dim)):
        copy_into(end, last)


@kernel
def is_free(problem, state, connection):
    """Return whether the pieces of a connection, driven from ``state``, meet no boundary."""
    at, end = state.copy(), np.empty(len(state))
    for k in range(connection.n[0]):
        duration, control = connection.durations[k], connection.controls[k]
        if contact(problem.system, problem.geometric.space, at, control, duration) <= duration:
            return False
        move(problem.system, at, control, duration, end)
        copy_into(at, end)
    return True


@kernel
def _spliced(system, durations, states, controls, window, ends, connections):
    """
    Return the motion with a window of time replaced by one or two connections.

    ``window`` is (step, time since its begin) of both ends of the window, ``ends`` the states
    before, between and after the connections. A second connection without pieces is left out.
    """
    i, after_i, j, after_j = window
    a, between, b = ends
    rest = durations[j] - after_j
    keeps = rest > 0.0 and j < len(durations)
    rows = i + 1 + connections[0].n[0] + connections[1].n[0] + 1 + len(durations) - 1 - j
    new_durations = np.empty(rows)
    new_states, new_controls = np.empty((rows + 1, len(a))), np.empty((rows, controls.shape[1]))
    n = i
    copy_into(new_durations[:n], durations)
    copy_rows(new_states[:n], states)
    copy_rows(new_controls[:n], controls)
    if after_i > 0.0:
        new_durations[n] = after_i
        copy_into(new_states[n], states[i])
        copy_into(new_controls[n], controls[i])
        n += 1
    for c in range(2):
        connection = connections[c]
        if connection.n[0] > 0:
            copy_into(new_states[n], a if c == 0 else between)
        for k in range(connection.n[0]):
            new_durations[n] = connection.durations[k]
            copy_into(new_controls[n], connection.controls[k])
            move(system, new_states[n], new_controls[n], new_durations[n], new_states[n + 1])
            n += 1
    copy_into(new_states[n], b)
    if keeps:
        new_durations[n] = rest
        copy_into(new_controls[n], controls[j])
        n += 1
    for k in range(j + 1, len(durations)):
        new_durations[n] = durations[k]
        copy_into(new_states[n], states[k])
        copy_into(new_controls[n], controls[k])
        n += 1
    if keeps or j + 1 < len(durations):
        copy_into(new_states[n], states[-1])
    return new_durations[:n], new_states[: n + 1], new_controls[:n]
