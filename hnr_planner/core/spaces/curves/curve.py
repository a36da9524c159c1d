"""
Curves that a robot follows, and their first exit from a space.

Under constant controls a robot moves along a parabola or an arc. Each coordinate of such a curve
is a function of one parameter with closed forms for all that the search for a contact needs: its
value, its turning points (where the derivative is 0), and the parameter at which it reaches a
given value before its next turning point. So the first contact with a boundary is found as a root,
never by small steps. A compiled space that supports curves registers a kernel for
``first_exit_on_curve`` in the module of its space.
"""

import math
from typing import Any, NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.dispatch import dispatched
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.primitives import CompiledSpace, contains

#: Fraction of half a circle within which a turning point of an arc counts as the one just passed.
SAME_TURN = 1e-9


@dispatched
@kernel
def coordinate(curve: Any, i: int) -> Any:
    """Return coordinate ``i`` of a curve, as a function of its parameter."""
    raise NotImplementedError


@dispatched
@kernel
def along(curve: Any, normal: Floats) -> Any:
    """Return the coordinate along a unit vector ``normal`` (dim,), a function of the parameter."""
    raise NotImplementedError


@dispatched
@kernel
def at(f: Any, t: float) -> float:
    """Return the value of a coordinate at ``t``."""
    raise NotImplementedError


@dispatched
@kernel
def turn(f: Any, t: float) -> float:
    """
    Return the first parameter above ``t`` at which a coordinate turns; inf for none.

    It turns where its derivative is 0.
    """
    raise NotImplementedError


@dispatched
@kernel
def reach(f: Any, value: float, t: float) -> float:
    """
    Return a parameter at which a coordinate is ``value``; inf, or one out of range, for none.

    It is the first one from ``t`` on, if there is one up to the next turning point after ``t``.
    """
    raise NotImplementedError


@dispatched
@kernel
def first_exit_on_curve(space: CompiledSpace, curve: Any, end: float) -> float:
    """
    Return the first parameter in [0, ``end``] at which a curve is not free; inf for none.

    ``space`` and ``curve`` are in the same frame.
    """
    raise NotImplementedError


def supports_curves(data: CompiledSpace) -> bool:
    """Return whether a compiled space and all nested ones support ``first_exit_on_curve``."""
    nested = [field for field in data if contains.knows(field)]
    return first_exit_on_curve.knows(data) and all(map(supports_curves, nested))


class Parabola(NamedTuple):
    """The points ``position + velocity t + acceleration t^2 / 2``, all (dim,)."""

    position: Floats
    velocity: Floats
    acceleration: Floats


class Arc(NamedTuple):
    """
    The arc from ``position`` (2,) at ``heading`` [rad], as a function of the length along it.

    ``curvature`` is the inverse of the radius, above 0 for a turn to the left, 0 for a line.
    """

    position: Floats
    heading: float
    curvature: float


class Quadratic(NamedTuple):
    """The function ``start + slope t + change t^2 / 2``: a coordinate of a parabola."""

    start: float
    slope: float
    change: float


class Winding(NamedTuple):
    """
    The function ``start`` + integral of ``cos(angle + curvature s)``: a coordinate of an arc.

    The integral runs from 0 to the parameter, the length along the arc.
    """

    start: float
    angle: float
    curvature: float


class Bend(NamedTuple):
    """
    A coordinate of a piece of an arc, less than half a circle, without an angle in it.

    It is a function of ``m = 2 tan(curvature s / 2) / curvature``, where s is the length along the
    piece; m grows with s. ``cos`` and ``sin`` are those of the angle between the coordinate's axis
    and the direction at the begin of the piece, where the coordinate is ``start``.
    """

    start: float
    cos: float
    sin: float
    curvature: float


@coordinate.register(Parabola)
@kernel
def _parabola_coordinate(curve, i):
    """Return coordinate ``i`` of a parabola, as a quadratic function of its parameter."""
    return Quadratic(curve.position[i], curve.velocity[i], curve.acceleration[i])


@coordinate.register(Arc)
@kernel
def _arc_coordinate(curve, i):
    """Return coordinate ``i`` of an arc: 0 for x, 1 for y, with the heading turned by -pi / 2."""
    return Winding(curve.position[i], curve.heading - i * (math.pi / 2.0), curve.curvature)


@along.register(Parabola)
@kernel
def _parabola_along(curve, normal):
    """Return the coordinate of a parabola along ``normal`` (dim,), a quadratic function."""
    x, v, a = 0.0, 0.0, 0.0
    for i in range(len(normal)):
        x += normal[i] * curve.position[i]
        v += normal[i] * curve.velocity[i]
        a += normal[i] * curve.acceleration[i]
    return Quadratic(x, v, a)


@along.register(Arc)
@kernel
def _arc_along(curve, normal):
    """Return the coordinate of an arc whose heading is measured from ``normal``."""
    start = normal[0] * curve.position[0] + normal[1] * curve.position[1]
    return Winding(start, curve.heading - math.atan2(normal[1], normal[0]), curve.curvature)


@at.register(Quadratic)
@kernel
def _quadratic_at(f, t):
    """Evaluate a quadratic at ``t``."""
    return f.start + t * (f.slope + t * (f.change / 2.0))


@turn.register(Quadratic)
@kernel
def _quadratic_turn(f, t):
    """Return the parameter of the extremum of a quadratic if it lies after ``t``; else inf."""
    turn = -f.slope / f.change if f.change != 0.0 else math.inf
    return turn if turn > t else math.inf


@reach.register(Quadratic)
@kernel
def _quadratic_reach(f, value, t):
    """Return the root of the quadratic equation ahead of ``t``, computed without cancellation."""
    slope, away = f.slope + f.change * t, value - _quadratic_at(f, t)
    if away == 0.0:
        return t
    squared = slope * slope + 2.0 * f.change * away
    if squared < 0.0:
        return math.inf
    return t + 2.0 * away / (slope + math.copysign(math.sqrt(squared), away))


@at.register(Winding)
@kernel
def _winding_at(f, s):
    """
    Return the value at ``s``, from the straight chord of the arc.

    With h half of the angle turned up to ``s``, the chord is ``s sin(h) / h`` long, at the mean
    angle.
    """
    half = f.curvature * s / 2.0
    shrink = math.sin(half) / half if half != 0.0 else 1.0
    return f.start + s * shrink * math.cos(f.angle + half)


@turn.register(Winding)
@kernel
def _winding_turn(f, s):
    """Return the next parameter after ``s`` at which the slope of an arc's coordinate is 0."""
    if f.curvature == 0.0:
        return math.inf
    turns = (f.angle + f.curvature * s) / math.pi - 0.5
    k = math.floor(turns) + 1.0 if f.curvature > 0.0 else math.ceil(turns) - 1.0
    turn = (math.pi * (k + 0.5) - f.angle) / f.curvature
    half_circle = math.pi / abs(f.curvature)
    return turn if turn > s + SAME_TURN * half_circle else turn + half_circle


@reach.register(Winding)
@kernel
def _winding_reach(f, value, s):
    """
    Return where an arc's coordinate is ``value``, ahead of ``s``; inf for nowhere.

    A quadratic equation is solved for tan(h), where h is half of the angle turned from ``s`` on.
    """
    angle, away = f.angle + f.curvature * s, value - _winding_at(f, s)
    if away == 0.0:
        return s
    bend = f.curvature * away
    slope = math.cos(angle)
    squared = slope * slope - bend * (bend + 2.0 * math.sin(angle))
    if squared < 0.0:
        return math.inf
    tangent = away / (slope + math.copysign(math.sqrt(squared), away))
    if f.curvature == 0.0:
        return s + 2.0 * tangent
    return s + 2.0 * math.atan(f.curvature * tangent) / f.curvature


@at.register(Bend)
@kernel
def _bend_at(f, m):
    """Return the value of a quotient of two quadratics."""
    half = f.curvature * m / 2.0
    return f.start + m * (f.cos - f.sin * half) / (1.0 + half * half)


@reach.register(Bend)
@kernel
def _bend_reach(f, value, m):
    """Return the first root of a quadratic equation that is above 0, whatever ``m`` is."""
    away = value - f.start
    bend = f.curvature * away
    squared = f.cos * f.cos - bend * (bend + 2.0 * f.sin)
    if squared < 0.0:
        return math.inf
    return 2.0 * away / (f.cos + math.copysign(math.sqrt(squared), away))


@kernel
def point_at(curve, t, x):
    """Write the point of a curve at ``t`` to ``x`` (dim,)."""
    for i in range(len(x)):
        x[i] = at(coordinate(curve, i), t)
