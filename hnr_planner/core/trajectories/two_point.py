"""
Two-point connections of the double integrator: from one state to another within a given time.

Along an axis, from speed ``v0`` to ``v1`` over a displacement ``d`` in the time ``T``, the motion
of least acceleration has a constant magnitude ``a`` with one change of sign. That acceleration
solves

    T^2 a^2 + 2 (T (v0 + v1) - 2 d) a - (v1 - v0)^2 = 0.

One of the two roots puts the change of sign within ``T``, so every axis has one solution, and all
axes take the same time. The first axis is laid along the displacement. If its speed would exceed
the part of the limit that the other axes leave, it cruises at that speed. The connection is
feasible when acceleration and velocity, as vectors over all axes, keep their limits. A short time
is found by bisection. (Hauser and Ng-Thow-Hing, "Fast smoothing of manipulator trajectories using
optimal bounded-acceleration shortcuts", 2010, have separate limits for each axis.)
"""

import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.trajectories.problem import SHORTEST_STEP
import numpy as np

#: Bisections between a time that is feasible and one that is not.
BISECTIONS = 14
#: Fraction of the limit on acceleration that connections leave unused, and fraction of the limit
#: on speed by which they may exceed it: both are rounding.
SPARE, EXCESS = 1e-12, 1e-10

#: Rows of ``Connection.axes``.
DISPLACEMENT, BEFORE, AFTER, ACCELERATION, FIRST, LAST = range(6)


class Connection(NamedTuple):
    """
    Work arrays, and the connection that was found: the first ``n[0]`` pieces.

    Attributes
    ----------
    axes : (6, dim)
        For each axis: displacement, speeds at the begin and the end, acceleration, time [s] at
        which the acceleration ends, and time at which it begins again with the other sign.
    mirror : (dim,)
        Normal of the reflection that lays the first axis along the displacement; 0 for none.
    cuts : (2 dim + 2,)
        Times from the begin of the connection at which pieces may end [s], in order.
    durations, controls : (2 dim + 1,), (2 dim + 1, dim)
        Duration [s] and acceleration of each piece.
    n : (1,) int64
        Number of pieces in use.

    """

    axes: Floats
    mirror: Floats
    cuts: Floats
    durations: Floats
    controls: Floats
    n: np.ndarray


@kernel
def empty_connection(dim):
    """Return new work arrays for connections of positions in ``dim`` dimensions."""
    return Connection(
        np.zeros((6, dim)),
        np.zeros(dim),
        np.zeros(2 * dim + 2),
        np.zeros(2 * dim + 1),
        np.zeros((2 * dim + 1, dim)),
        np.zeros(1, dtype=np.int64),
    )


@kernel
def connect(system, a, b, longest, work):
    """
    Write to ``work`` a fast connection from state ``a`` to ``b``; return its duration [s].

    The connection takes at most ``longest`` [s]. The result is inf if no connection takes exactly
    ``longest``. Feasible times need not be an interval, so a shorter connection may exist.
    """
    too_short, enough = _prepare(system, a, b, work), longest
    if enough < SHORTEST_STEP or too_short > enough or not _fits(system, enough, work):
        return math.inf
    for _ in range(BISECTIONS):
        middle = (too_short + enough) / 2.0
        if _fits(system, middle, work):
            enough = middle
        else:
            too_short = middle
    enough = max(enough, SHORTEST_STEP)
    if not _fits(system, enough, work):
        return math.inf
    _write_pieces(enough, work)
    return enough


@kernel
def _prepare(system, a, b, work):
    """Compute the axes of ``work``; return a time [s] below which no connection is feasible."""
    axes, mirror = work.axes, work.mirror
    dim = len(mirror)
    displacement, change = 0.0, 0.0
    for i in range(dim):
        displacement += (b[i] - a[i]) ** 2
        change += (b[dim + i] - a[dim + i]) ** 2
    displacement = math.sqrt(displacement)
    squared = 0.0
    for i in range(dim):
        along = (b[i] - a[i]) / displacement if displacement > 0.0 else 0.0
        mirror[i] = along - 1.0 if i == 0 and displacement > 0.0 else along
        squared += mirror[i] * mirror[i]
    for i in range(dim):
        mirror[i] = mirror[i] / math.sqrt(squared) if squared > 1e-24 else 0.0
        axes[DISPLACEMENT, i] = b[i] - a[i]
        axes[BEFORE, i], axes[AFTER, i] = a[dim + i], b[dim + i]
    for k in (DISPLACEMENT, BEFORE, AFTER):
        _reflect(mirror, axes[k])
    return max(displacement / system.max_speed, math.sqrt(change) / system.max_acceleration)


@kernel
def _reflect(mirror, vector):
    """Convert a vector (dim,) to the frame of the axes or back: a reflection does both."""
    dot = 0.0
    for i in range(len(mirror)):
        dot += mirror[i] * vector[i]
    for i in range(len(mirror)):
        vector[i] -= 2.0 * dot * mirror[i]


@kernel
def _fits(system, duration, work):
    """Solve every axis for a duration [s]; return whether both limits of the system are kept."""
    axes = work.axes
    dim = axes.shape[1]
    most = system.max_acceleration * (1.0 - SPARE)
    fastest = system.max_speed
    accelerated, aside = 0.0, 0.0
    for i in range(dim - 1, -1, -1):
        peak = _fit_axis(axes[:, i], duration)
        if i == 0:
            _cut_off(axes[:, 0], peak, math.sqrt(max(fastest * fastest - aside, 0.0)), duration)
        else:
            peak = max(abs(peak), max(abs(axes[BEFORE, i]), abs(axes[AFTER, i])))
            aside += peak * peak
        accelerated += axes[ACCELERATION, i] ** 2
    if not accelerated <= most * most:
        return False
    for i in range(dim):
        for k in (FIRST, LAST):
            squared = 0.0
            for j in range(dim):
                squared += _speed_at(axes[:, j], axes[k, i], duration) ** 2
            if not squared <= fastest * fastest * (1.0 + EXCESS):
                return False
    return True


@kernel
def _fit_axis(axis, duration):
    """Solve one axis (6,) without a limit on speed; return the speed at the change of sign."""
    change = axis[AFTER] - axis[BEFORE]
    half = duration * (axis[BEFORE] + axis[AFTER]) - 2.0 * axis[DISPLACEMENT]
    root = math.sqrt(half * half + duration * duration * change * change)
    # The root of larger magnitude: with the other one the sign would change too late.
    acceleration = -math.copysign(abs(half) + root, half) / (duration * duration)
    axis[ACCELERATION] = acceleration
    switch = (duration + change / acceleration) / 2.0 if acceleration != 0.0 else duration / 2.0
    switch = min(max(switch, 0.0), duration)
    axis[FIRST], axis[LAST] = switch, switch
    return axis[BEFORE] + acceleration * switch


@kernel
def _cut_off(axis, peak, fastest, duration):
    """
    Limit the speed of an axis (6,) to ``fastest`` by a cruise, in place.

    ``peak`` is the speed of the axis at the change of sign. An axis that is slow enough, or that
    begins or ends too fast, stays as it is; the acceleration becomes inf where no cruise fits.
    """
    before, after = axis[BEFORE], axis[AFTER]
    ends = max(abs(before), abs(after))
    if abs(peak) <= fastest or ends > fastest * (1.0 + EXCESS):
        return
    fastest = max(fastest, ends)
    cruise = math.copysign(fastest, peak)
    spare = abs(cruise * duration - axis[DISPLACEMENT])
    if (cruise * duration - axis[DISPLACEMENT]) * cruise <= 0.0:
        axis[ACCELERATION] = math.inf
        return
    acceleration = ((cruise - before) ** 2 + (cruise - after) ** 2) / (2.0 * spare)
    if acceleration == 0.0:
        return
    axis[ACCELERATION] = math.copysign(acceleration, cruise)
    axis[FIRST] = abs(cruise - before) / acceleration
    axis[LAST] = duration - abs(cruise - after) / acceleration
    if axis[FIRST] > axis[LAST]:
        axis[ACCELERATION] = math.inf


@kernel
def _speed_at(axis, t, duration):
    """Return the speed along an axis (6,) at time ``t`` [s] from the begin of the connection."""
    speed = axis[BEFORE] + axis[ACCELERATION] * min(t, axis[FIRST])
    return speed - axis[ACCELERATION] * max(t - axis[LAST], 0.0)


@kernel
def _write_pieces(duration, work):
    """
    Divide ``duration`` where an axis changes its acceleration; write the pieces to ``work``.

    A piece shorter than ``SHORTEST_STEP`` is joined to the next piece, and a last one to the piece
    before: that changes a velocity by rounding only.
    """
    axes, cuts = work.axes, work.cuts
    dim, n = axes.shape[1], 0
    cuts[0], cuts[1] = 0.0, duration
    for i in range(dim):
        cuts[2 + 2 * i], cuts[3 + 2 * i] = axes[FIRST, i], axes[LAST, i]
    _sort(cuts)
    begin = 0.0
    for end in cuts:
        if end - begin < SHORTEST_STEP:
            continue
        middle = (begin + end) / 2.0
        for i in range(dim):
            acceleration = axes[ACCELERATION, i]
            if middle > axes[LAST, i]:
                work.controls[n, i] = -acceleration
            else:
                work.controls[n, i] = acceleration if middle < axes[FIRST, i] else 0.0
        _reflect(work.mirror, work.controls[n])
        work.durations[n] = end - begin
        begin = end
        n += 1
    work.durations[n - 1] += duration - begin
    work.n[0] = n


@kernel
def _sort(values):
    """Sort a few values (n,) in place; numba's own sort would take a second to compile."""
    for i in range(1, len(values)):
        value, k = values[i], i
        while k > 0 and value < values[k - 1]:
            values[k] = values[k - 1]
            k -= 1
        values[k] = value
