"""
Random draws: a point of a ball, a point of a chord, a step of Hit-and-Run.

These kernels serve planners, which step from any point: given a compiled space, a free point ``x``
and a random stream, a step writes the next point into ``y``. The step returns the number of
redraws: draws that rounded onto the boundary and were drawn again, so that ``y`` is always a free
point. After ``REDRAWS_MAX`` redraws ``y`` is ``x``. All points are in the kernel frame.
Steps of chains, which start from the point before and reuse its cache, are in module ``walks``.
"""

import math

from hnr_planner.core.kernels.copies import copy_into
from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.kernels.streams import uniform
from hnr_planner.core.spaces.lines import draw_direction, point_on_line, uniform_direction
from hnr_planner.core.spaces.primitives import chord, contains
import numpy as np

#: Number of redraws after which a chord has no other number, and the step does not move.
REDRAWS_MAX = 100


@kernel
def hit_and_run_step(space, x, rng, y):
    """
    Write the end of a step of Hit-and-Run from ``x`` (dim,) into ``y`` (dim,).

    Return the number of redraws; if that is ``REDRAWS_MAX``, ``y`` is ``x``.
    """
    u = np.empty(len(x))
    draw_direction(space, rng, u)
    return draw_on_chord(space, x, u, rng, y)


@inlined
def draw_in_ball(radius, rng, u):
    """Write a uniform point of the ball of this radius around the origin into ``u`` (dim,)."""
    uniform_direction(rng, u)
    length = radius * uniform(rng) ** (1.0 / len(u))
    for i in range(len(u)):
        u[i] *= length


@kernel
def draw_on_chord(space, x, u, rng, y):
    """
    Write a uniform point of the chord through ``x`` (dim,) along ``u`` (dim,) into ``y`` (dim,).

    Return the number of redraws; if that is ``REDRAWS_MAX``, ``y`` is ``x``.
    """
    lower, upper = chord(space, x, u, -u)
    for redraws in range(REDRAWS_MAX):
        if not math.isnan(try_between(space, x, u, lower, upper, rng, y)):
            return redraws
    copy_into(y, x)
    return REDRAWS_MAX


@inlined
def try_between(space, x, u, lower, upper, rng, y):
    """
    Write the point at s of a line into ``y`` (dim,), s uniform in (lower, upper), and return s.

    Return nan where s rounds onto an end or the point is not free: then it is to be drawn again.
    """
    s = lower + (upper - lower) * uniform(rng)
    point_on_line(space, x, u, s, y)
    return s if lower < s < upper and contains(space, y) else math.nan
