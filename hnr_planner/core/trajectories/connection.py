"""
Two-point connections of the double integrator: from one state to another within a given time.

Along an axis, from speed ``v0`` to ``v1`` over a way ``d`` in the time ``T``, the least bound on
the acceleration has it at that bound all the time, one way and then the other:

    T^2 a^2 + 2 (T (v0 + v1) - 2 d) a - (v1 - v0)^2 = 0.

One root fits into the time, so that every axis has one answer, and all are in step. One axis is
laid along the way: there the speed may have to be cut off at what the others leave of the limit,
and the robot cruises. The connection is feasible when the vectors of all axes keep within both
balls; the shortest time is found by halving (Hauser and Ng-Thow-Hing, "Fast smoothing of
manipulator trajectories using optimal bounded-acceleration shortcuts", 2010, take limits for each
axis by itself, and a longer way to this formula).
"""

import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
import numpy as np

#: Halvings between a time that is feasible and one that is not.
HALVINGS = 14
#: Part of the limit on acceleration that connections leave alone, and part of the limit on speed
#: by which they may seem to exceed it: both are rounding.
SPARE, EXCESS = 1e-12, 1e-10

WAY, BEFORE, AFTER, PULL, FIRST, LAST = range(6)


class Connection(NamedTuple):
    """
    Room to work in, and the connection that was found: its first ``n`` pieces.

    Attributes
    ----------
    axes : (6, dim)
        Along each axis: way, speeds before and after, acceleration, and when it ends and begins
        again with the other sign.
    mirror : (dim,)
        Normal of the mirror that lays the first axis along the way; zero for none.
    cuts : (2 dim + 2,)
        Where pieces end.
    durations, controls : (2 dim + 1,), (2 dim + 1, dim)
        The pieces.
    n : (1,) int64
        How many there are.

    """

    axes: Floats
    mirror: Floats
    cuts: Floats
    durations: Floats
    controls: Floats
    n: np.ndarray


@kernel
def empty_connection(dim):
    """Return room for a connection."""
    return Connection(
        np.zeros((6, dim)),
        np.zeros(dim),
        np.zeros(2 * dim + 2),
        np.zeros(2 * dim + 1),
        np.zeros((2 * dim + 1, dim)),
        np.zeros(1, dtype=np.int64),
    )


@kernel
def connect(system, a, b, longest, room):
    """
    Find a fast connection from state ``a`` to ``b``, in ``room``: its duration, inf for none.

    It takes at most ``longest``. A shorter one may exist beyond times that are not feasible.
    """
    too_short, enough = _prepare(system, a, b, room), longest
    if too_short > enough or not _fits(system, enough, room):
        return math.inf
    for _ in range(HALVINGS):
        middle = (too_short + enough) / 2.0
        if _fits(system, middle, room):
            enough = middle
        else:
            too_short = middle
    if not _fits(system, enough, room):
        return math.inf
    _write_pieces(enough, room)
    return enough


@kernel
def _prepare(system, a, b, room):
    """Lay the axes: return a time below which there is no connection."""
    axes, mirror = room.axes, room.mirror
    dim = len(mirror)
    way, change = 0.0, 0.0
    for i in range(dim):
        way += (b[i] - a[i]) ** 2
        change += (b[dim + i] - a[dim + i]) ** 2
    way = math.sqrt(way)
    squared = 0.0
    for i in range(dim):
        mirror[i] = (b[i] - a[i]) / way - (1.0 if i == 0 else 0.0) if way > 0.0 else 0.0
        squared += mirror[i] * mirror[i]
    for i in range(dim):
        mirror[i] = mirror[i] / math.sqrt(squared) if squared > 1e-24 else 0.0
        axes[WAY, i] = b[i] - a[i]
        axes[BEFORE, i], axes[AFTER, i] = a[dim + i], b[dim + i]
    for k in (WAY, BEFORE, AFTER):
        _reflect(mirror, axes[k])
    return max(way / system.max_speed, math.sqrt(change) / system.max_acceleration)


@kernel
def _reflect(mirror, vector):
    """Turn a vector into the frame of the axes, or back: the same."""
    dot = 0.0
    for i in range(len(mirror)):
        dot += mirror[i] * vector[i]
    for i in range(len(mirror)):
        vector[i] -= 2.0 * dot * mirror[i]


@kernel
def _fits(system, duration, room):
    """Find the acceleration of each axis for a duration, and say whether all keep the limits."""
    axes = room.axes
    dim = axes.shape[1]
    most = system.max_acceleration * (1.0 - SPARE)
    fastest = system.max_speed
    pulled, aside = 0.0, 0.0
    for i in range(dim - 1, -1, -1):
        peak = _fit_axis(axes[:, i], duration)
        if i == 0:
            _cut_off(axes[:, 0], peak, math.sqrt(max(fastest * fastest - aside, 0.0)), duration)
        else:
            peak = max(abs(peak), max(abs(axes[BEFORE, i]), abs(axes[AFTER, i])))
            aside += peak * peak
        pulled += axes[PULL, i] ** 2
    if not pulled <= most * most:
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
    """Solve for one axis without a limit on speed; return its speed when the sign changes."""
    change = axis[AFTER] - axis[BEFORE]
    half = duration * (axis[BEFORE] + axis[AFTER]) - 2.0 * axis[WAY]
    root = math.sqrt(half * half + duration * duration * change * change)
    # Of both roots the larger: with the smaller one the sign would have to change too late.
    pull = -math.copysign(abs(half) + root, half) / (duration * duration)
    axis[PULL] = pull
    switch = (duration + change / pull) / 2.0 if pull != 0.0 else duration / 2.0
    switch = min(max(switch, 0.0), duration)
    axis[FIRST], axis[LAST] = switch, switch
    return axis[BEFORE] + pull * switch


@kernel
def _cut_off(axis, peak, fastest, duration):
    """Cruise at ``fastest`` along an axis that would be faster, where that is possible."""
    before, after = axis[BEFORE], axis[AFTER]
    ends = max(abs(before), abs(after))
    if abs(peak) <= fastest or ends > fastest * (1.0 + EXCESS):
        return
    fastest = max(fastest, ends)
    cruise = math.copysign(fastest, peak)
    spare = abs(cruise * duration - axis[WAY])
    if (cruise * duration - axis[WAY]) * cruise <= 0.0:
        axis[PULL] = math.inf
        return
    pull = ((cruise - before) ** 2 + (cruise - after) ** 2) / (2.0 * spare)
    if pull == 0.0:
        return
    axis[PULL] = math.copysign(pull, cruise)
    axis[FIRST] = abs(cruise - before) / pull
    axis[LAST] = duration - abs(cruise - after) / pull
    if axis[FIRST] > axis[LAST]:
        axis[PULL] = math.inf


@kernel
def _speed_at(axis, t, duration):
    """Speed along an axis at a time."""
    speed = axis[BEFORE] + axis[PULL] * min(t, axis[FIRST])
    return speed - axis[PULL] * max(t - axis[LAST], 0.0)


@kernel
def _write_pieces(duration, room):
    """Cut the time where an axis changes its acceleration, and write the pieces."""
    axes, cuts = room.axes, room.cuts
    dim, n = axes.shape[1], 0
    cuts[0], cuts[1] = 0.0, duration
    for i in range(dim):
        cuts[2 + 2 * i], cuts[3 + 2 * i] = axes[FIRST, i], axes[LAST, i]
    cuts.sort()
    for k in range(len(cuts) - 1):
        length = cuts[k + 1] - cuts[k]
        if length <= 1e-14 * duration:
            continue
        middle = (cuts[k] + cuts[k + 1]) / 2.0
        for i in range(dim):
            pull = axes[PULL, i]
            if middle > axes[LAST, i]:
                room.controls[n, i] = -pull
            else:
                room.controls[n, i] = pull if middle < axes[FIRST, i] else 0.0
        _reflect(room.mirror, room.controls[n])
        room.durations[n] = length
        n += 1
    room.n[0] = n
