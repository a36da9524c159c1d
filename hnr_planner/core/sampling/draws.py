"""
Random draws: a direction, a point of a ball, a point of a chord, a step of Hit-and-Run.

These kernels serve planners, which step from any point: given a compiled space, a free point ``x``
and a random stream, a step writes the next point into ``y``. The step returns the number of
redraws: draws that rounded onto the boundary and were drawn again, so that ``y`` is always a free
point. After ``REDRAWS_MAX`` redraws ``y`` is ``x``. All points are in the kernel frame.
Steps of chains, which start from the point before and reuse its cache, are in module ``walks``.
"""

import math

from hnr_planner.core.kernels.copies import copy_into
from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.kernels.streams import draw_normals, uniform
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
    draw_direction(rng, u)
    return draw_on_chord(space, x, u, rng, y)


@inlined
def draw_direction(rng, u):
    """Write a direction drawn uniformly from the unit sphere into ``u`` (dim,)."""
    squared = 0.0
    while squared == 0.0:
        squared = draw_normals(rng, u)
    scale = 1.0 / math.sqrt(squared)
    for i in range(len(u)):
        u[i] *= scale


@inlined
def draw_in_ball(radius, rng, u):
    """Write a uniform point of the ball of this radius around the origin into ``u`` (dim,)."""
    draw_direction(rng, u)
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
    return draw_between(space, x, u, lower, upper, rng, y)


@kernel
def draw_between(space, x, u, lower, upper, rng, y):
    """
    Write ``x + s u`` into ``y`` (dim,), with s uniform in (lower, upper) and the point free.

    A point that is not free, or s on an end, is drawn again. Return the number of redraws; after
    ``REDRAWS_MAX`` redraws ``y`` is ``x``.
    """
    for redraws in range(REDRAWS_MAX):
        s = lower + (upper - lower) * uniform(rng)
        for i in range(len(x)):
            y[i] = x[i] + s * u[i]
        if lower < s < upper and contains(space, y):
            return redraws
    copy_into(y, x)
    return REDRAWS_MAX
