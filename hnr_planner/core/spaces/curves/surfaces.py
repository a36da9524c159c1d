"""
Where a curve leaves a space that planes and spheres bound, in any dimension.

Whether a point is free changes only where the curve crosses one of those surfaces. So all these
parameters are found, as roots, and put in order: between two of them the middle stands for all.
What is composed of such spaces has the surfaces of all its parts. A curve that touches a surface
and stays on its side is not held up by it.
"""

import math
from typing import Any

from hnr_planner.core.kernels.dispatch import dispatched
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.ball import BallData
from hnr_planner.core.spaces.box import BoxData
from hnr_planner.core.spaces.curves.curve import (
    along,
    Arc,
    coordinate,
    first_exit_on_curve,
    Parabola,
    point_at,
    reach,
    turn,
)
from hnr_planner.core.spaces.curves.polynomials import next_change
from hnr_planner.core.spaces.difference import DifferenceData
from hnr_planner.core.spaces.polygon.edges import PolygonData
from hnr_planner.core.spaces.polytope.polytope_space import PolytopeData
from hnr_planner.core.spaces.primitives import contains
from hnr_planner.core.spaces.union import UnionData
import numpy as np

#: Room for marks at first.
ROOM = 64


@dispatched
@kernel
def mark(space: Any, curve: Any, end: float, marks: Any, n: int) -> int:
    """
    Write the parameters in [0, ``end``] at which the curve meets a surface of ``space``.

    They go to ``marks`` from index ``n`` on, as far as there is room; returns how many there are
    with those before.
    """
    raise NotImplementedError


@dispatched
@kernel
def slack(space: Any) -> float:
    """Return what may lie between two parts of ``space`` for a curve to pass."""
    return 0.0


@kernel
def _leave_curve(space, curve, end):
    marks = np.empty(ROOM)
    n = mark(space, curve, end, marks, 0)
    if n > len(marks):
        marks = np.empty(n)
        mark(space, curve, end, marks, 0)
    marks = np.sort(marks[:n])
    dim = len(curve.position)
    x, y = np.empty(dim), np.empty(dim)
    point_at(curve, 0.0, x)
    if not contains(space, x):
        return 0.0
    before = 0.0
    for k in range(n + 1):
        after = marks[k] if k < n else end
        point_at(curve, after, y)
        point_at(curve, (before + after) / 2.0, x)
        if not contains(space, x) and not _is_small(curve, before, y, x, slack(space)):
            return before
        before = after
    return math.inf if contains(space, y) else end


@kernel
def _is_small(curve, before, end, middle, gap):
    """Say whether a part of a curve, on its way through ``middle``, is no longer than a gap."""
    squared, rounding = 0.0, gap
    for i in range(len(end)):
        squared += (end[i] - middle[i]) ** 2
        rounding = max(rounding, 1e-15 * abs(end[i]))
    return 2.0 * math.sqrt(squared) <= rounding


@kernel
def _mark_value(f, value, end, marks, n):
    """Write where a coordinate has a value; likewise."""
    t = 0.0
    while t < end:
        piece_end = min(end, turn(f, t))
        met = reach(f, value, t)
        if t <= met <= piece_end:
            if n < len(marks):
                marks[n] = met
            n += 1
        t = piece_end
    return n


@dispatched
@kernel
def mark_sphere(curve: Any, centre: Any, radius: float, end: float, marks: Any, n: int) -> int:
    """Write where a curve meets a sphere; likewise."""
    raise NotImplementedError


@mark_sphere.register(Parabola)
@kernel
def _mark_sphere_on_parabola(curve, centre, radius, end, marks, n):
    """Find the changes of |x + v t + a t^2 / 2 - c|^2 - r^2, of order four."""
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
        if n < len(marks):
            marks[n] = t
        n += 1
        t = next_change(c, t, end, False, 0.0)
    return n


@mark_sphere.register(Arc)
@kernel
def _mark_sphere_on_arc(curve, centre, radius, end, marks, n):
    """
    Take the sphere for the line on which it meets the circle of the arc.

    With m the middle of that circle and R its radius, |x - c|^2 = R^2 + |m - c|^2 + 2 (x - m)
    (m - c): constant along lines across m - c.
    """
    if curve.curvature == 0.0:
        direction = np.array([math.cos(curve.heading), math.sin(curve.heading)])
        line = Parabola(curve.position, direction, np.zeros(2))
        return _mark_sphere_on_parabola(line, centre, radius, end, marks, n)
    own = 1.0 / curve.curvature
    m = np.array(
        [
            curve.position[0] - own * math.sin(curve.heading),
            curve.position[1] + own * math.cos(curve.heading),
        ]
    )
    normal = m - centre
    apart = math.hypot(normal[0], normal[1])
    if apart == 0.0:
        return n
    normal /= apart
    value = normal[0] * m[0] + normal[1] * m[1]
    value += (radius * radius - own * own - apart * apart) / (2.0 * apart)
    return _mark_value(along(curve, normal), value, end, marks, n)


@mark.register(BoxData)
@kernel
def _mark_boxes(boxes, curve, end, marks, n):
    for k in range(len(boxes.lower)):
        for i in range(boxes.lower.shape[1]):
            f = coordinate(curve, i)
            n = _mark_value(f, boxes.lower[k, i], end, marks, n)
            n = _mark_value(f, boxes.upper[k, i], end, marks, n)
    return n


@mark.register(PolytopeData)
@kernel
def _mark_polytope(polytope, curve, end, marks, n):
    for k in range(len(polytope.offsets)):
        f = along(curve, polytope.normals[k])
        n = _mark_value(f, polytope.offsets[k], end, marks, n)
    return n


@mark.register(PolygonData)
@kernel
def _mark_edges(polygon, curve, end, marks, n):
    """Take the whole line of each edge: marks that are none do no harm."""
    normal = np.empty(2)
    for k in range(len(polygon.edges)):
        ax, ay, bx, by = polygon.edges[k]
        length = math.hypot(bx - ax, by - ay)
        normal[0], normal[1] = (by - ay) / length, (ax - bx) / length
        value = normal[0] * ax + normal[1] * ay
        n = _mark_value(along(curve, normal), value, end, marks, n)
    return n


@mark.register(BallData)
@kernel
def _mark_balls(balls, curve, end, marks, n):
    for k in range(len(balls.radii)):
        n = mark_sphere(curve, balls.centres[k], balls.radii[k], end, marks, n)
    return n


@mark.register(UnionData)
@kernel
def _mark_union(union, curve, end, marks, n):
    n = mark(union.one, curve, end, marks, n)
    return mark(union.other, curve, end, marks, n)


@mark.register(DifferenceData)
@kernel
def _mark_difference(difference, curve, end, marks, n):
    n = mark(difference.base, curve, end, marks, n)
    return mark(difference.removed, curve, end, marks, n)


@slack.register(BoxData)
@slack.register(BallData)
@kernel
def _own_gap(space):
    return space.max_gap


@slack.register(UnionData)
@kernel
def _gap_of_union(union):
    return max(union.max_gap, max(slack(union.one), slack(union.other)))


@slack.register(DifferenceData)
@kernel
def _gap_of_base(difference):
    return slack(difference.base)


for data_type in (BoxData, BallData, PolytopeData, PolygonData, UnionData, DifferenceData):
    first_exit_on_curve.register(data_type)(_leave_curve)
