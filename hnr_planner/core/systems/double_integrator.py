"""
The double integrator: a point that accelerates (paper, Section 5, kinematic planning).

Under a constant acceleration it runs along a parabola. Speed is bounded as well, and both bounds
are balls: with the velocities at both ends of a step within the limit, all between them are.
"""

from dataclasses import dataclass
import math
from typing import NamedTuple

from hnr_planner.core.checks import check_count, check_number, check_point, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.lengths import norm
from hnr_planner.core.spaces.curves.curve import first_exit_on_curve, Parabola
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.systems.limits import check_limit
from hnr_planner.core.systems.primitives import (
    brake,
    contact,
    halt,
    move,
    moved,
    steer,
    velocity,
)
from hnr_planner.core.systems.system import ROUNDING, vectors_from_kernel, vectors_to_kernel
import numpy as np
from numpy.typing import ArrayLike

#: Part of a vector that has to be left across another for its direction to be known.
UPRIGHT = 1e-6
#: Nodes and weights on [0, 1] for the length of a piece of a parabola.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)


class DoubleIntegratorData(NamedTuple):
    """A compiled double integrator: its limits."""

    max_acceleration: float
    max_speed: float


@dataclass(frozen=True)
class DoubleIntegrator:
    """
    A point with a velocity, controlled by its acceleration.

    A state is position and velocity (2 dim,) [m, m/s], a control an acceleration (dim,) [m/s^2].

    Attributes
    ----------
    dim : int
        Dimension of the position, at least 1.
    max_acceleration : float
        Length of the longest acceleration [m/s^2], above 0.
    max_speed : float
        Largest speed [m/s], above 0.

    """

    dim: int = 2
    max_acceleration: float = 1.0
    max_speed: float = 1.0

    def __post_init__(self) -> None:
        object.__setattr__(self, 'dim', check_count('dim', self.dim, 1))
        for name in ('max_acceleration', 'max_speed'):
            object.__setattr__(self, name, check_limit(name, getattr(self, name)))

    @property
    def state_dim(self) -> int:
        """Numbers in a state."""
        return 2 * self.dim

    @property
    def control_dim(self) -> int:
        """Numbers in a control."""
        return self.dim

    @property
    def largest_acceleration(self) -> float:
        """Largest change of the velocity (dim,) in a second [m/s^2]."""
        return self.max_acceleration

    @property
    def data(self) -> DoubleIntegratorData:
        """The compiled system in the caller's units."""
        return DoubleIntegratorData(self.max_acceleration, self.max_speed)

    def check_state(self, name: str, state: ArrayLike) -> Floats:
        """Return a state (2 dim,) within the speed limit, or raise RequestError."""
        checked = check_point(name, state, self.state_dim)
        speed = self.speed(checked)
        if speed > self.max_speed * (1.0 + ROUNDING):
            raise RequestError(
                f'{name} must be no faster than max_speed, {self.max_speed:g} m/s, '
                f'got {speed!r} m/s'
            )
        return checked

    def propagate(self, state: ArrayLike, control: ArrayLike, duration: float) -> Floats:
        """Return the state (2 dim,) after ``duration`` [s] under a constant acceleration."""
        start = check_point('state', state, self.state_dim)
        acceleration = check_point('control', control, self.control_dim)
        return moved(self.data, start, acceleration, check_number('duration', duration, 0.0))

    def velocity(self, state: Floats) -> Floats:
        """Return how a state moves: (dim,) [m/s]."""
        _, velocity = np.split(state, 2)
        return velocity

    def speed(self, state: Floats) -> float:
        """Return the speed [m/s] of a state."""
        return math.hypot(*self.velocity(state))

    def lengths(self, states: Floats, controls: Floats, durations: Floats) -> Floats:
        """Return how far steps go: (k,) [m], by 16 nodes of Gauss and Legendre."""
        total, velocities = np.zeros(len(durations)), np.split(states, 2, axis=1)[1]
        for node, weight in zip(_NODES, _WEIGHTS, strict=True):
            times = durations * (node + 1.0) / 2.0
            now = velocities + times[:, np.newaxis] * controls
            total += weight * np.linalg.norm(now, axis=1)
        return durations / 2.0 * total

    def compiled(self, space: Space) -> DoubleIntegratorData:
        """Return the compiled system in the kernel frame of a space."""
        limits = self.max_acceleration / space.scale, self.max_speed / space.scale
        return DoubleIntegratorData(*limits)

    def to_kernel(self, space: Space, states: Floats) -> Floats:
        """Bring states (..., 2 dim) into the kernel frame of a space."""
        positions, velocities = np.split(states, 2, axis=-1)
        inside = space.to_kernel(positions), vectors_to_kernel(space, velocities)
        return np.concatenate(inside, axis=-1)

    def from_kernel(self, space: Space, states: Floats) -> Floats:
        """Bring states (..., 2 dim) out of the kernel frame of a space."""
        positions, velocities = np.split(states, 2, axis=-1)
        outside = space.from_kernel(positions), vectors_from_kernel(space, velocities)
        return np.concatenate(outside, axis=-1)

    def controls_to_kernel(self, space: Space, controls: Floats) -> Floats:
        """Bring accelerations (k, dim) into the kernel frame of a space."""
        return vectors_to_kernel(space, controls)

    def controls_from_kernel(self, space: Space, controls: Floats) -> Floats:
        """Bring accelerations (k, dim) out of the kernel frame of a space."""
        return vectors_from_kernel(space, controls)


@move.register(DoubleIntegratorData)
@kernel
def _move(system, state, control, duration, end):
    dim = len(control)
    for i in range(dim):
        change = control[i] * duration
        end[i] = state[i] + duration * (state[dim + i] + change / 2.0)
        end[dim + i] = state[dim + i] + change


@contact.register(DoubleIntegratorData)
@kernel
def _contact(system, space, state, control, duration):
    dim = len(control)
    return first_exit_on_curve(space, Parabola(state[:dim], state[dim:], control), duration)


@steer.register(DoubleIntegratorData)
@kernel
def _steer(system, state, position, velocity, weight, duration, control):
    """
    Choose the least |x' - x_d|^2 + weight^2 |v' - v_d|^2 after the duration.

    The cost is isotropic in the acceleration, so that the best one within the limits is the point
    of both balls nearest to the best one without limits.
    """
    dim = len(control)
    half = duration * duration / 2.0
    weighted = weight * weight * duration
    scale = half * half + weighted * duration
    for i in range(dim):
        missing = position[i] - state[i] - duration * state[dim + i]
        control[i] = (half * missing + weighted * (velocity[i] - state[dim + i])) / scale
    limit_acceleration(system, state[dim:], duration, control)


@kernel
def limit_acceleration(system, velocity, duration, control):
    """Move ``control`` to the nearest point of two balls: accelerations, and speeds at the end."""
    dim, radius = len(control), system.max_speed / duration
    if norm(control) <= system.max_acceleration:
        within, beyond = True, _speed_after(velocity, duration, control) > system.max_speed
    else:
        within, beyond = False, False
    if within and not beyond:
        return
    wish = control.copy()
    _scale_to(control, system.max_acceleration)
    if not within and _speed_after(velocity, duration, control) <= system.max_speed:
        return
    offset = velocity / duration
    for i in range(dim):
        control[i] = wish[i] + offset[i]
    _scale_to(control, radius)
    for i in range(dim):
        control[i] -= offset[i]
    if norm(control) <= system.max_acceleration:
        return
    _to_rim(system.max_acceleration, radius, offset, wish, control)


@kernel
def _to_rim(limit, radius, offset, wish, control):
    """Write the point nearest to ``wish`` where |a| = limit meets |a + offset| = radius."""
    apart = norm(offset)
    along = (radius * radius - limit * limit - apart * apart) / (2.0 * apart * apart)
    height = math.sqrt(max(limit * limit - (along * apart) ** 2, 0.0))
    dot = 0.0
    for i in range(len(wish)):
        dot += wish[i] * offset[i]
    across = wish - (dot / (apart * apart)) * offset
    length = norm(across)
    # Where next to nothing is left of it, rounding is: the middle of the rim is as near.
    upright = length > UPRIGHT * norm(wish)
    for i in range(len(wish)):
        sideways = across[i] / length * height if upright else 0.0
        control[i] = along * offset[i] + sideways


@kernel
def _scale_to(vector, length):
    """Shorten ``vector`` to ``length`` where it is longer."""
    before = norm(vector)
    if before > length:
        for i in range(len(vector)):
            vector[i] *= length / before


@kernel
def _speed_after(velocity, duration, control):
    squared = 0.0
    for i in range(len(velocity)):
        squared += (velocity[i] + duration * control[i]) ** 2
    return math.sqrt(squared)


@brake.register(DoubleIntegratorData)
@kernel
def _brake(system, state, control):
    dim = len(control)
    speed = norm(state[dim:])
    for i in range(dim):
        control[i] = -state[dim + i] / speed * system.max_acceleration if speed > 0.0 else 0.0
    return speed / system.max_acceleration


@halt.register(DoubleIntegratorData)
@kernel
def _halt(system, state):
    half = len(state) // 2
    state[half:] = 0.0


@velocity.register(DoubleIntegratorData)
@kernel
def _velocity(system, state, out):
    for i in range(len(out)):
        out[i] = state[len(out) + i]
