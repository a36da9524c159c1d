"""
Lines of a space: how a direction is drawn, and where a line leads.

In most spaces a line is ``x + s u`` and its direction is uniform on the sphere. A space of poses
has orbits of twists in their place, and registers its own kernels for both functions.
"""

import math
from typing import Any

from hnr_planner.core.checks import Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.dispatch import dispatched
from hnr_planner.core.kernels.kernel import inlined
from hnr_planner.core.kernels.streams import draw_normals, Stream
from hnr_planner.core.spaces.primitives import CompiledSpace


@dispatched
@inlined
def draw_direction(space: CompiledSpace, rng: Stream, u: Floats) -> None:
    """
    Write the direction of a step of Hit-and-Run into ``u`` (dim,).

    Its law must not depend on the point that the step begins at: then the uniform distribution is
    stationary. The default is uniform on the unit sphere.
    """
    uniform_direction(rng, u)


@dispatched
@inlined
def point_on_line(space: CompiledSpace, x: Floats, u: Floats, s: float, y: Floats) -> None:
    """Write the point at parameter ``s`` of the line through ``x`` along ``u`` into ``y``."""
    for i in range(len(x)):
        y[i] = x[i] + s * u[i]


@inlined
def uniform_direction(rng, u):
    """Write a direction drawn uniformly from the unit sphere into ``u`` (dim,)."""
    squared = 0.0
    while squared == 0.0:
        squared = draw_normals(rng, u)
    scale = 1.0 / math.sqrt(squared)
    for i in range(len(u)):
        u[i] *= scale


def check_straight_lines(space: Any, needed_by: str) -> None:
    """Raise RequestError for a space whose lines are orbits; ``needed_by`` names what fails."""
    if not space.has_straight_lines:
        raise RequestError(
            f'{needed_by} needs a space with straight lines, and a {type(space).__name__} has '
            f'orbits of twists'
        )
