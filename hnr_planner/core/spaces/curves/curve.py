"""
Curves that a robot follows, and where they leave a space.

Under constant controls a robot runs along a parabola or an arc. Each coordinate of such a curve is
a function of one parameter for which everything that contact asks is closed form: its value, where
it turns, and where it reaches a value before it turns. So the first contact with a boundary is
found as a root, never by stepping along. Each kind of compiled space that can answer registers a
kernel for ``first_exit_on_curve``.
"""

import math
from typing import Any, NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.dispatch import dispatched
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.primitives import contains

#: A turning point of an arc nearer than this part of half a circle is the one just passed.
SAME_TURN = 1e-9


@dispatched
@kernel
def coordinate(curve: Any, i: int) -> Any:
    """Return coordinate ``i`` of a curve, as a function of its parameter."""
    raise NotImplementedError


@dispatched
@kernel
def along(curve: Any, normal: Any) -> Any:
    """Return the coordinate of a curve along a unit vector ``normal`` (dim,), likewise."""
    raise NotImplementedError


@dispatched
@kernel
def at(f: Any, t: float) -> float:
    """Return the value of a coordinate at ``t``."""
    raise NotImplementedError


@dispatched
@kernel
def turn(f: Any, t: float) -> float:
    """Return the first parameter > ``t`` at which a coordinate turns; inf for none."""
    raise NotImplementedError


@dispatched
@kernel
def reach(f: Any, value: float, t: float) -> float:
    """Return where a coordinate has ``value``, between ``t`` and its next turn; inf for never."""
    raise NotImplementedError


@dispatched
@kernel
def first_exit_on_curve(space: Any, curve: Any, end: float) -> float:
    """Return the first parameter in [0, ``end``] at which a curve is not free; inf for none."""
    raise NotImplementedError


def knows_curves(data: Any) -> bool:
    """Say whether it is known where curves leave a compiled space, and all that it is made of."""
    parts = [part for part in data if contains.knows(part)]
    return first_exit_on_curve.knows(data) and all(map(knows_curves, parts))


class Parabola(NamedTuple):
    """The points ``position + velocity t + acceleration t^2 / 2``, all (dim,)."""

    position: Floats
    velocity: Floats
    acceleration: Floats


class Arc(NamedTuple):
    """The arc from ``position`` (2,), by its length; ``curvature`` > 0 turns to the left."""

    position: Floats
    heading: float
    curvature: float


class Quadratic(NamedTuple):
    """The function ``start + slope t + change t^2 / 2``: a coordinate of a parabola."""

    start: float
    slope: float
    change: float


class Winding(NamedTuple):
    """``start`` and the integral of ``cos(angle + curvature s)``: a coordinate of an arc."""

    start: float
    angle: float
    curvature: float


@coordinate.register(Parabola)
@kernel
def _parabola_coordinate(curve, i):
    return Quadratic(curve.position[i], curve.velocity[i], curve.acceleration[i])


@coordinate.register(Arc)
@kernel
def _arc_coordinate(curve, i):
    return Winding(curve.position[i], curve.heading - i * (math.pi / 2.0), curve.curvature)


@along.register(Parabola)
@kernel
def _parabola_along(curve, normal):
    x, v, a = 0.0, 0.0, 0.0
    for i in range(len(normal)):
        x += normal[i] * curve.position[i]
        v += normal[i] * curve.velocity[i]
        a += normal[i] * curve.acceleration[i]
    return Quadratic(x, v, a)


@along.register(Arc)
@kernel
def _arc_along(curve, normal):
    start = normal[0] * curve.position[0] + normal[1] * curve.position[1]
    return Winding(start, curve.heading - math.atan2(normal[1], normal[0]), curve.curvature)


@at.register(Quadratic)
@kernel
def _quadratic_at(f, t):
    return f.start + t * (f.slope + t * (f.change / 2.0))


@turn.register(Quadratic)
@kernel
def _quadratic_turn(f, t):
    turn = -f.slope / f.change if f.change != 0.0 else math.inf
    return turn if turn > t else math.inf


@reach.register(Quadratic)
@kernel
def _quadratic_reach(f, value, t):
    """Solve for the way from ``t`` on, in the form that subtracts nothing."""
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
    """Go along the chord: its length is that of the arc times sin(h) / h, its angle the mean."""
    half = f.curvature * s / 2.0
    shrink = math.sin(half) / half if half != 0.0 else 1.0
    return f.start + s * shrink * math.cos(f.angle + half)


@turn.register(Winding)
@kernel
def _winding_turn(f, s):
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
    """Solve for tan(h), where h is half the angle turned from ``s`` on: a quadratic as above."""
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


@kernel
def point_at(curve, t, x):
    """Write the point of a curve at ``t``."""
    for i in range(len(x)):
        x[i] = at(coordinate(curve, i), t)
