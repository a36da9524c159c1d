"""
Draws: a direction, a point of a ball, a point of a chord, and so a step of Hit-and-Run.

Planners step from any point that they have: from the compiled space, a free point ``x`` and a
stream a step writes the next point into ``y``. It returns how many draws it threw away because
they rounded onto the boundary: points of the space stay points of the space. Walks, which go on
from where the last step led, are in ``walks``.
"""

import math

from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.kernels.streams import draw_normals, uniform
from hnr_planner.core.spaces.primitives import chord, contains
import numpy as np

#: After so many draws in a row on the boundary the chord holds no other number: the walk stays.
REDRAWS_MAX = 100


@kernel
def hit_and_run_step(space, x, rng, y):
    """Take a step of Hit-and-Run: uniform direction, uniform point of its chord (paper, 1)."""
    u = np.empty(len(x))
    draw_direction(rng, u)
    return draw_on_chord(space, x, u, rng, y)


@inlined
def draw_direction(rng, u):
    """Draw ``u`` uniformly from the unit sphere."""
    squared = 0.0
    while squared == 0.0:
        squared = draw_normals(rng, u)
    scale = 1.0 / math.sqrt(squared)
    for i in range(len(u)):
        u[i] *= scale


@inlined
def draw_in_ball(radius, rng, u):
    """Draw ``u`` uniformly from the ball around the origin."""
    draw_direction(rng, u)
    length = radius * uniform(rng) ** (1.0 / len(u))
    for i in range(len(u)):
        u[i] *= length


@kernel
def draw_on_chord(space, x, u, rng, y):
    """Draw ``y`` uniformly from the chord of ``x`` along ``u``; return the draws thrown away."""
    lower, upper = chord(space, x, u, -u)
    return draw_between(space, x, u, lower, upper, rng, y)


@kernel
def draw_between(space, x, u, lower, upper, rng, y):
    """Draw ``y = x + s u`` with ``s`` uniform in a part (lower, upper) of the chord; likewise."""
    for redraws in range(REDRAWS_MAX):
        s = lower + (upper - lower) * uniform(rng)
        for i in range(len(x)):
            y[i] = x[i] + s * u[i]
        if lower < s < upper and contains(space, y):
            return redraws
    y[:] = x
    return REDRAWS_MAX
