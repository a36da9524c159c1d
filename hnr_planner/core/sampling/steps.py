"""
Steps of random walks: the kernels that move a chain by one step.

The type of a walk's compiled settings selects the kernel of its step::

    take_step(walk, space, cache, u, rng, counts) -> moved

The kernel may change the chain's position in ``cache``, and returns whether the chain moved. The
result depends on the arguments only; module ``chains`` calls the kernel in a loop, and counts
steps and moves.
"""

import math
from typing import Any, NamedTuple

from hnr_planner.core.kernels.dispatch import dispatched
from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.kernels.streams import uniform
from hnr_planner.core.sampling.draws import draw_in_ball, REDRAWS_MAX
from hnr_planner.core.spaces.chain_cache import (
    chord_cached,
    clear_axis,
    count_axes,
    move_along,
    move_if_free,
    NO_AXIS,
    refresh,
    set_axis,
)
from hnr_planner.core.spaces.lines import draw_direction
from hnr_planner.core.spaces.primitives import first_exit

#: Counters of a chain, by column: steps taken; steps that moved it; chords shorter than the
#: space's zero length; draws rejected because they rounded onto the boundary; steps since the last
#: move.
STEPS, MOVES, ZERO_CHORDS, REDRAWS, STILL = range(5)
N_COUNTS = 5
#: Share of the steps of an overrelaxed walk that move to the mirror image of the chain's point.
MIRRORED = 0.8


class HitAndRunStep(NamedTuple):
    """Hit-and-Run for kernels: chords shorter than ``zero_length`` count as zero chords."""

    zero_length: float


class CoordinateHitAndRunStep(NamedTuple):
    """Coordinate Hit-and-Run for kernels: shorter chords than ``zero_length`` are zero chords."""

    zero_length: float


class OverrelaxedStep(NamedTuple):
    """Overrelaxed sweeps for kernels: shorter chords than ``zero_length`` are zero chords."""

    zero_length: float


class BallStep(NamedTuple):
    """Ball walk for kernels: radius in the kernel frame, and whether segments must be free."""

    radius: float
    segment_visible: bool


@dispatched
@inlined
def take_step(walk: Any, space: Any, cache: Any, u: Any, rng: Any, counts: Any) -> bool:
    """
    Take one step of a walk, and return whether the chain moved.

    Parameters
    ----------
    walk : NamedTuple
        Compiled settings, whose type selects the kernel.
    space : NamedTuple
        Compiled space.
    cache : ChainCache or the space's own
        Position of the chain in the kernel frame, and what the space caches for it. The step
        changes both when the chain moves.
    u : (dim,)
        Work array for the direction; zero before and after steps of coordinate walks.
    rng : (4,) uint64
        Random stream of the chain.
    counts : (N_COUNTS,) int64
        Counters; the step adds to ``ZERO_CHORDS`` and ``REDRAWS`` only.

    """
    raise NotImplementedError


@take_step.register(HitAndRunStep)
@inlined
def _hit_and_run(walk, space, cache, u, rng, counts):
    """Move to a uniform point of the chord in a uniform direction; return whether it moved."""
    draw_direction(space, rng, u)
    return _move_on_chord(walk.zero_length, space, cache, u, NO_AXIS, rng, counts)


@take_step.register(CoordinateHitAndRunStep)
@inlined
def _coordinate_hit_and_run(walk, space, cache, u, rng, counts):
    """Move to a uniform point of the chord along a uniform axis; return whether it moved."""
    axis = math.floor(uniform(rng) * count_axes(space, len(u)))
    set_axis(space, u, axis)
    moved = _move_on_chord(walk.zero_length, space, cache, u, axis, rng, counts)
    clear_axis(space, u, axis)
    return moved


@take_step.register(OverrelaxedStep)
@inlined
def _overrelaxed(walk, space, cache, u, rng, counts):
    """
    Move along the next axis in turn, mostly to the mirror image on the chord.

    The mirror image of a point in the middle of its chord preserves lengths on the chord, so that
    both moves keep the uniform distribution. Return whether the chain moved.
    """
    axis = (counts[STEPS] - 1) % count_axes(space, len(u))
    set_axis(space, u, axis)
    lower, upper = chord_cached(space, cache, u, axis)
    if upper - lower < walk.zero_length:
        moved = _move_on_zero_chord(space, cache, u, axis, lower, upper, rng, counts)
    elif uniform(rng) < MIRRORED and move_along(space, cache, u, axis, lower + upper):
        moved = True
    else:
        moved = _move_between(space, cache, u, axis, lower, upper, rng, counts)
    clear_axis(space, u, axis)
    return moved


@take_step.register(BallStep)
@inlined
def _ball_walk(walk, space, cache, u, rng, counts):
    """
    Move to a uniform point of the ball if it is free; return whether the chain moved.

    With ``walk.segment_visible`` the segment to the point must be free too.
    """
    draw_in_ball(walk.radius, rng, u)
    for i in range(len(u)):
        cache.y[i] = cache.x[i] + u[i]
    if walk.segment_visible and not first_exit(space, cache.x, u, 0.0, 1.0) > 1.0:
        return False
    if not move_if_free(space, cache):
        return False
    refresh(space, cache)
    return True


@inlined
def _move_on_chord(zero_length, space, cache, u, axis, rng, counts):
    """Move to a uniform point of the chord along ``u``; return whether the chain moved."""
    lower, upper = chord_cached(space, cache, u, axis)
    if upper - lower >= zero_length:
        return _move_between(space, cache, u, axis, lower, upper, rng, counts)
    return _move_on_zero_chord(space, cache, u, axis, lower, upper, rng, counts)


@inlined
def _move_between(space, cache, u, axis, lower, upper, rng, counts):
    """
    Move by ``s u``, with s uniform in (lower, upper); return whether the chain moved.

    A draw on an end, or whose point is not free, counts as a redraw and is repeated; after
    ``REDRAWS_MAX`` redraws the chain stays.
    """
    for _ in range(REDRAWS_MAX):
        s = lower + (upper - lower) * uniform(rng)
        if lower < s < upper and move_along(space, cache, u, axis, s):
            return True
        counts[REDRAWS] += 1
    return False


@kernel
def _move_on_zero_chord(space, cache, u, axis, lower, upper, rng, counts):
    """
    Move on a chord shorter than the zero length; return whether the position changed.

    Such a chord has few floating-point numbers, so that the point drawn may equal the old one.
    """
    counts[ZERO_CHORDS] += 1
    before = cache.x.copy()
    _move_between(space, cache, u, axis, lower, upper, rng, counts)
    for i in range(len(before)):
        if cache.x[i] != before[i]:
            return True
    return False
