"""
A planar base with bounded speed, acceleration and curvature: a car, or a unicycle.

Under a constant control the base moves along a circular arc, a straight line at curvature 0. The
speed changes only when a point of the arc is reached, so the first contact with a boundary is
found on the arc and converted to a time.
"""

from dataclasses import dataclass
import math
from typing import ClassVar, NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.curves.curve import Arc, at, coordinate, first_exit_on_curve
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.systems.primitives import brake, contact, halt, move, steer, velocity
from hnr_planner.core.systems.system import check_limit, System, vectors_to_kernel
import numpy as np

X, Y, HEADING, SPEED = range(4)


class CarData(NamedTuple):
    """A compiled car: its limits in the kernel frame of a space (its unit of length, seconds)."""

    max_acceleration: float
    max_speed: float
    max_curvature: float


@dataclass(frozen=True)
class Car(System):
    """
    A planar base that moves along its heading, forwards and backwards.

    A state is (x, y, heading, speed) [m, m, rad, m/s]; a speed below 0 goes backwards. A control
    is (acceleration, curvature) [m/s^2, 1/m]; a curvature above 0 turns left. Curvature may jump
    from one step to the next: a real base that steers slowly stops at the jump, or follows the
    trajectory with a small error.

    Attributes
    ----------
    max_acceleration : float
        Largest change of speed in a second [m/s^2], above 0.
    max_speed : float
        Largest speed, forwards and backwards [m/s], above 0.
    max_curvature : float
        Inverse of the smallest turning radius [1/m], above 0.

    """

    max_acceleration: float = 1.0
    max_speed: float = 1.0
    max_curvature: float = 1.0

    dim: ClassVar[int] = 2
    state_dim: ClassVar[int] = 4
    control_dim: ClassVar[int] = 2

    def __post_init__(self) -> None:
        for name in ('max_acceleration', 'max_speed', 'max_curvature'):
            object.__setattr__(self, name, check_limit(name, getattr(self, name)))

    @property
    def largest_acceleration(self) -> float:
        """Largest rate of change [m/s^2] of the velocity (2,), by braking and turning together."""
        return math.hypot(self.max_acceleration, self.max_curvature * self.max_speed**2)

    @property
    def data(self) -> CarData:
        """The limits of the car as ``CarData``, in the caller's units."""
        return CarData(self.max_acceleration, self.max_speed, self.max_curvature)

    def velocity(self, state: Floats) -> Floats:
        """Return the velocity [m/s] of a state (4,) as a vector (2,)."""
        heading, speed = state[HEADING], state[SPEED]
        return speed * np.array([math.cos(heading), math.sin(heading)])

    def speed(self, state: Floats) -> float:
        """Return the magnitude [m/s], at least 0, of the signed speed of a state (4,)."""
        return abs(float(state[SPEED]))

    def lengths(self, states: Floats, controls: Floats, durations: Floats) -> Floats:
        """
        Return how far (k,) [m] the base drives from states (k, 4) in durations (k,) [s].

        Controls (k, 2) are constant for their durations. Where the speed changes its sign, the
        ways forwards and backwards are added.
        """
        before, pull = states[:, SPEED], controls[:, 0]
        after = before + pull * durations
        turns = before * after < 0.0
        there_and_back = (before**2 + after**2) / (2.0 * np.abs(np.where(turns, pull, 1.0)))
        return np.where(turns, there_and_back, np.abs(before + after) / 2.0 * durations)

    def compiled(self, space: Space) -> CarData:
        """Return the limits of the car as ``CarData`` in the kernel frame of a space."""
        scale = space.scale
        return CarData(
            self.max_acceleration / scale, self.max_speed / scale, self.max_curvature * scale
        )

    def to_kernel(self, space: Space, states: Floats) -> Floats:
        """Convert states (..., 4) from the caller's frame to the kernel frame of a space."""
        inside = np.empty_like(states)
        inside[..., :HEADING] = space.to_kernel(states[..., :HEADING])
        inside[..., HEADING] = states[..., HEADING] + _yaw(space)
        inside[..., SPEED] = states[..., SPEED] / space.scale
        return inside

    def from_kernel(self, space: Space, states: Floats) -> Floats:
        """Convert states (..., 4) from the kernel frame of a space to the caller's frame."""
        outside = np.empty_like(states)
        outside[..., :HEADING] = space.from_kernel(states[..., :HEADING])
        outside[..., HEADING] = states[..., HEADING] - _yaw(space)
        outside[..., SPEED] = states[..., SPEED] * space.scale
        return outside

    def controls_to_kernel(self, space: Space, controls: Floats) -> Floats:
        """Convert controls (k, 2) from the caller's units to the kernel frame of a space."""
        return controls * (1.0 / space.scale, space.scale)

    def controls_from_kernel(self, space: Space, controls: Floats) -> Floats:
        """Convert controls (k, 2) from the kernel frame of a space to the caller's units."""
        return controls * (space.scale, 1.0 / space.scale)


def _yaw(space: Space) -> float:
    """Return the angle [rad] by which a conversion to the kernel frame turns directions."""
    x, y = vectors_to_kernel(space, np.array([1.0, 0.0]))
    return math.atan2(y, x)


@move.register(CarData)
@kernel
def _move(system, state, control, duration, end):
    """Write to ``end`` (4,) the state after a duration [s] of motion along an arc."""
    arc_length = duration * (state[SPEED] + duration * control[0] / 2.0)
    arc = Arc(state[:HEADING], state[HEADING], control[1])
    x, y = at(coordinate(arc, 0), arc_length), at(coordinate(arc, 1), arc_length)
    end[HEADING] = state[HEADING] + control[1] * arc_length
    end[SPEED] = state[SPEED] + control[0] * duration
    end[X], end[Y] = x, y


@contact.register(CarData)
@kernel
def _contact(system, space, state, control, duration):
    """
    Return the time [s] from the state to the first contact with the boundary; inf for none.

    A motion whose speed changes its sign is searched in two parts, before and after that moment.
    """
    speed, acceleration = state[SPEED], control[0]
    rest = -speed / acceleration if acceleration != 0.0 else math.inf
    if not 0.0 < rest < duration:
        return _one_way(space, state, control, duration)
    first = _one_way(space, state, control, rest)
    if first <= rest:
        return first
    turned = state.copy()
    _move(system, state, control, rest, turned)
    turned[SPEED] = 0.0
    return rest + _one_way(space, turned, control, duration - rest)


@kernel
def _one_way(space, state, control, duration):
    """
    Return the time [s] of the first contact of a motion whose speed keeps its sign; inf for none.

    The time is computed from the arc length at which the arc leaves the space.
    """
    arc_length = duration * (state[SPEED] + duration * control[0] / 2.0)
    heading = state[HEADING] if arc_length >= 0.0 else state[HEADING] + math.pi
    curvature = math.copysign(control[1], control[1] * arc_length)
    left = first_exit_on_curve(space, Arc(state[:HEADING], heading, curvature), abs(arc_length))
    if left > abs(arc_length):
        return math.inf
    speed, acceleration = abs(state[SPEED]), math.copysign(control[0], control[0] * arc_length)
    if left == 0.0:
        return 0.0
    squared = max(speed * speed + 2.0 * acceleration * left, 0.0)
    return min(2.0 * left / (speed + math.sqrt(squared)), duration)


@steer.register(CarData)
@kernel
def _steer(system, state, position, velocity, weight, duration, control):
    """
    Write the control (2,) that drives on the arc to the desired position at the desired speed.

    The arc to a point at distance ``d`` and at angle ``b`` to the heading has curvature
    2 sin(b) / d. The base goes backwards where the position lies behind the base. The desired
    speed is lowered to the straight distance over the duration and to ``max_speed``; then
    curvature and acceleration are clipped to the limits. ``weight`` is not used.
    """
    dx, dy = position[0] - state[X], position[1] - state[Y]
    ahead = dx * math.cos(state[HEADING]) + dy * math.sin(state[HEADING])
    aside = dy * math.cos(state[HEADING]) - dx * math.sin(state[HEADING])
    squared = dx * dx + dy * dy
    curvature = 2.0 * aside / squared if squared > 0.0 else 0.0
    control[1] = min(max(curvature, -system.max_curvature), system.max_curvature)
    wanted = min(math.hypot(velocity[0], velocity[1]), math.sqrt(squared) / duration)
    wanted = min(wanted, system.max_speed)
    change = (math.copysign(wanted, ahead) - state[SPEED]) / duration
    control[0] = min(max(change, -system.max_acceleration), system.max_acceleration)


@brake.register(CarData)
@kernel
def _brake(system, state, control):
    """Write the control (2,) of straight braking at full strength; return the time to rest [s]."""
    control[0] = -math.copysign(system.max_acceleration, state[SPEED])
    control[1] = 0.0
    return abs(state[SPEED]) / system.max_acceleration


@halt.register(CarData)
@kernel
def _halt(system, state):
    """Set the speed of a state (4,) to 0 in place; position and heading stay."""
    state[SPEED] = 0.0


@velocity.register(CarData)
@kernel
def _velocity(system, state, out):
    """Write to ``out`` (2,) the velocity of a state (4,): the speed along the heading."""
    out[0] = state[SPEED] * math.cos(state[HEADING])
    out[1] = state[SPEED] * math.sin(state[HEADING])
