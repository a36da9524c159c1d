"""
First exit of a curve from a space bounded by planes and spheres, in any dimension.

Whether a point is free changes only where the curve crosses one of those surfaces. So the
crossings are computed as roots and sorted, and between two of them one point in the middle is
tested. A space composed of such spaces has the surfaces of all its members. A curve that only
touches a surface, without crossing it, is not stopped by it.

A compiled space registers its kernel for ``add_crossings``, one for ``max_gap_of`` if it counts
short gaps between its members as free, and ``first_exit_between_surfaces`` for
``first_exit_on_curve``.
"""

import math
from typing import Any

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.dispatch import dispatched
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.curves.curve import along, Arc, Parabola, point_at, reach, turn
from hnr_planner.core.spaces.curves.polynomials import next_change
from hnr_planner.core.spaces.primitives import CompiledSpace, contains
import numpy as np

#: Number of crossings that fit in the array at first.
INITIAL_CAPACITY = 64
#: Sections of a curve shorter than this fraction of its coordinates are rounding errors.
ROUNDING = 1e-15


@dispatched
@kernel
def add_crossings(space: CompiledSpace, curve: Any, end: float, crossings: Floats, n: int) -> int:
    """
    Write the parameters in [0, ``end``] at which the curve meets a surface of ``space``.

    They are written to ``crossings`` from index ``n`` on, as many as fit. Returns ``n`` plus their
    number, also of those that do not fit.
    """
    raise NotImplementedError


@dispatched
@kernel
def max_gap_of(space: CompiledSpace) -> float:
    """
    Return the length up to which gaps between two members of ``space`` count as free.

    It is 0 for a space that closes no gaps.
    """
    return 0.0


@kernel
def first_exit_between_surfaces(space, curve, end):
    """
    Return the first crossing after which the curve is not free, as ``first_exit_on_curve``.

    It is 0 where the curve starts outside, and inf where it is free up to ``end``.
    """
    crossings = np.empty(INITIAL_CAPACITY)
    n = add_crossings(space, curve, end, crossings, 0)
    if n > len(crossings):
        crossings = np.empty(n)
        add_crossings(space, curve, end, crossings, 0)
    crossings = np.sort(crossings[:n])
    dim = len(curve.position)
    x, y = np.empty(dim), np.empty(dim)
    point_at(curve, 0.0, x)
    if not contains(space, x):
        return 0.0
    before = 0.0
    for k in range(n + 1):
        after = crossings[k] if k < n else end
        point_at(curve, after, y)
        point_at(curve, (before + after) / 2.0, x)
        if not contains(space, x) and not _is_in_gap(curve, before, y, x, max_gap_of(space)):
            return before
        before = after
    return math.inf if contains(space, y) else end


@kernel
def _is_in_gap(curve, before, end, middle, max_gap):
    """Return whether the curve from ``middle`` to ``end`` is at most half of ``max_gap`` long."""
    squared, longest = 0.0, max_gap
    for i in range(len(end)):
        squared += (end[i] - middle[i]) ** 2
        longest = max(longest, ROUNDING * abs(end[i]))
    return 2.0 * math.sqrt(squared) <= longest


@kernel
def add_level_crossings(f, level, end, crossings, n):
    """
    Append to ``crossings``, from index ``n``, parameters in [0, ``end``] where ``f`` is ``level``.

    Return ``n`` plus their number, also of those that do not fit.
    """
    t = 0.0
    while t < end:
        piece_end = min(end, turn(f, t))
        met = reach(f, level, t)
        if t <= met <= piece_end:
            if n < len(crossings):
                crossings[n] = met
            n += 1
        t = piece_end
    return n


@dispatched
@kernel
def add_sphere_crossings(
    curve: Any, centre: Floats, radius: float, end: float, crossings: Floats, n: int
) -> int:
    """
    Append to ``crossings``, from index ``n``, where in [0, ``end``] a curve crosses a sphere.

    Return ``n`` plus the number of these parameters, also of those that do not fit.
    """
    raise NotImplementedError


@add_sphere_crossings.register(Parabola)
@kernel
def _add_sphere_crossings_of_parabola(curve, centre, radius, end, crossings, n):
    """Append the sign changes of the quartic |x + v t + a t^2 / 2 - c|^2 - r^2."""
    c = np.zeros(5)
    c[0] = -radius * radius
    for i in range(len(centre)):
        x, v, a = curve.position[i] - centre[i], curve.velocity[i], curve.acceleration[i]
        c[0] += x * x
        c[1] += 2.0 * x * v
        c[2] += v * v + x * a
        c[3] += v * a
        c[4] += a * a / 4.0
    t = next_change(c, 0.0, end, False, 0.0)
    while t < math.inf:
        if n < len(crossings):
            crossings[n] = t
        n += 1
        t = next_change(c, t, end, False, 0.0)
    return n


@add_sphere_crossings.register(Arc)
@kernel
def _add_sphere_crossings_of_arc(curve, centre, radius, end, crossings, n):
    """
    Append where the arc meets the line through the points in which its circle meets the sphere.

    With c the centre of the sphere, m the centre of that circle and R its radius, |x - c|^2 = R^2
    + |m - c|^2 + 2 (x - m) (m - c): constant along lines across m - c.
    """
    if curve.curvature == 0.0:
        direction = np.array([math.cos(curve.heading), math.sin(curve.heading)])
        line = Parabola(curve.position, direction, np.zeros(2))
        return _add_sphere_crossings_of_parabola(line, centre, radius, end, crossings, n)
    own = 1.0 / curve.curvature
    m = np.array(
        [
            curve.position[0] - own * math.sin(curve.heading),
            curve.position[1] + own * math.cos(curve.heading),
        ]
    )
    normal = m - centre
    distance = math.hypot(normal[0], normal[1])
    if distance == 0.0:
        return n
    normal /= distance
    level = normal[0] * m[0] + normal[1] * m[1]
    level += (radius * radius - own * own - distance * distance) / (2.0 * distance)
    return add_level_crossings(along(curve, normal), level, end, crossings, n)


@kernel
def own_max_gap(space):
    """Return the field ``max_gap`` of a compiled space: its kernel for ``max_gap_of``."""
    return space.max_gap
