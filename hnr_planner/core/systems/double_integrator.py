"""
The double integrator: a point that accelerates (paper, Section 5, kinematic planning).

Under a constant acceleration the point moves along a parabola. The vectors of acceleration and
velocity each lie in a ball around 0. The velocity changes along a straight line within a step, so
it keeps the limit on speed during the whole step if it does at both ends of the step.
"""

from dataclasses import dataclass
import math
from typing import NamedTuple

from hnr_planner.core.checks import check_count, Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.lengths import norm
from hnr_planner.core.spaces.curves.curve import first_exit_on_curve, Parabola
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.systems.primitives import brake, contact, halt, move, steer, velocity
from hnr_planner.core.systems.system import (
    check_limit,
    System,
    vectors_from_kernel,
    vectors_to_kernel,
)
import numpy as np

#: Fraction of a vector below which a component across it counts as rounding.
ACROSS = 1e-6
#: Nodes and weights on [-1, 1] of the quadrature for the length of a piece of a parabola.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)


class DoubleIntegratorData(NamedTuple):
    """A compiled double integrator: its limits in the kernel frame of a space."""

    max_acceleration: float
    max_speed: float


@dataclass(frozen=True)
class DoubleIntegrator(System):
    """
    A point with a velocity, controlled by its acceleration.

    A state (2 dim,) is a position [m] followed by a velocity [m/s]; a control is an acceleration
    (dim,) [m/s^2].

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
        """Length of a state: twice ``dim``, for position and velocity."""
        return 2 * self.dim

    @property
    def control_dim(self) -> int:
        """Length of a control: ``dim``, for an acceleration."""
        return self.dim

    @property
    def largest_acceleration(self) -> float:
        """Largest rate of change [m/s^2] of the velocity (dim,): ``max_acceleration``."""
        return self.max_acceleration

    @property
    def data(self) -> DoubleIntegratorData:
        """The limits as ``DoubleIntegratorData``, in the caller's units."""
        return DoubleIntegratorData(self.max_acceleration, self.max_speed)

    def velocity(self, state: Floats) -> Floats:
        """Return the velocity [m/s] of a state (2 dim,) as a vector (dim,)."""
        _, velocity = np.split(state, 2)
        return velocity

    def speed(self, state: Floats) -> float:
        """Return the speed [m/s] of a state (2 dim,)."""
        return math.hypot(*self.velocity(state))

    def lengths(self, states: Floats, controls: Floats, durations: Floats) -> Floats:
        """
        Return how long (k,) [m] the parabolas from states (k, 2 dim) are, by Gauss quadrature.

        Controls (k, dim) are constant for durations (k,) [s].
        """
        lengths: Floats = _lengths(states, controls, durations)
        return lengths

    def compiled(self, space: Space) -> DoubleIntegratorData:
        """Return the limits as ``DoubleIntegratorData`` in the kernel frame of a space."""
        limits = self.max_acceleration / space.scale, self.max_speed / space.scale
        return DoubleIntegratorData(*limits)

    def to_kernel(self, space: Space, states: Floats) -> Floats:
        """Convert states (..., 2 dim) from the caller's frame to the kernel frame of a space."""
        positions, velocities = np.split(states, 2, axis=-1)
        inside = space.to_kernel(positions), vectors_to_kernel(space, velocities)
        return np.concatenate(inside, axis=-1)

    def from_kernel(self, space: Space, states: Floats) -> Floats:
        """Convert states (..., 2 dim) from the kernel frame of a space to the caller's frame."""
        positions, velocities = np.split(states, 2, axis=-1)
        outside = space.from_kernel(positions), vectors_from_kernel(space, velocities)
        return np.concatenate(outside, axis=-1)

    def controls_to_kernel(self, space: Space, controls: Floats) -> Floats:
        """Convert accelerations (k, dim) from the caller's frame to a space's kernel frame."""
        return vectors_to_kernel(space, controls)

    def controls_from_kernel(self, space: Space, controls: Floats) -> Floats:
        """Convert accelerations (k, dim) from a space's kernel frame to the caller's frame."""
        return vectors_from_kernel(space, controls)


@kernel
def _lengths(states, controls, durations):
    """Return the lengths (k,) of steps: integrals of the speed over the durations (k,) [s]."""
    dim, lengths = controls.shape[1], np.empty(len(durations))
    for k in range(len(durations)):
        total = 0.0
        for n in range(len(_NODES)):
            time, squared = durations[k] * (_NODES[n] + 1.0) / 2.0, 0.0
            for i in range(dim):
                squared += (states[k, dim + i] + time * controls[k, i]) ** 2
            total += _WEIGHTS[n] * math.sqrt(squared)
        lengths[k] = durations[k] / 2.0 * total
    return lengths


@move.register(DoubleIntegratorData)
@kernel
def _move(system, state, control, duration, end):
    """Write to ``end`` (2 dim,) the state after a duration [s] of motion along a parabola."""
    dim = len(control)
    for i in range(dim):
        change = control[i] * duration
        end[i] = state[i] + duration * (state[dim + i] + change / 2.0)
        end[dim + i] = state[dim + i] + change


@contact.register(DoubleIntegratorData)
@kernel
def _contact(system, space, state, control, duration):
    """Return the time [s] at which the parabola leaves the space within ``duration``, or inf."""
    dim = len(control)
    return first_exit_on_curve(space, Parabola(state[:dim], state[dim:], control), duration)


@steer.register(DoubleIntegratorData)
@kernel
def _steer(system, state, position, velocity, weight, duration, control):
    """
    Write the acceleration (dim,) that minimizes |x' - x_d|^2 + weight^2 |v' - v_d|^2.

    x' and v' are position and velocity after the duration [s]; x_d and v_d are those desired.
    The minimized sum depends only on the distance of the acceleration from its unlimited optimum.
    So the best acceleration within the limits is the one nearest to that optimum.
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
    """
    Replace an acceleration (dim,) in place by the nearest one that keeps both limits.

    The limits are on the acceleration and on the speed after ``duration`` [s], from ``velocity``
    (dim,).
    """
    dim, radius = len(control), system.max_speed / duration
    if norm(control) <= system.max_acceleration:
        within, beyond = True, _speed_after(velocity, duration, control) > system.max_speed
    else:
        within, beyond = False, False
    if within and not beyond:
        return
    wanted = control.copy()
    _scale_to(control, system.max_acceleration)
    if not within and _speed_after(velocity, duration, control) <= system.max_speed:
        return
    offset = velocity / duration
    for i in range(dim):
        control[i] = wanted[i] + offset[i]
    _scale_to(control, radius)
    for i in range(dim):
        control[i] -= offset[i]
    if norm(control) <= system.max_acceleration:
        return
    _nearest_on_both_spheres(system.max_acceleration, radius, offset, wanted, control)


@kernel
def _nearest_on_both_spheres(limit, radius, offset, wanted, control):
    """Write the point ``a`` nearest to ``wanted`` with |a| = limit and |a + offset| = radius."""
    gap = norm(offset)
    along = (radius * radius - limit * limit - gap * gap) / (2.0 * gap * gap)
    height = math.sqrt(max(limit * limit - (along * gap) ** 2, 0.0))
    dot = 0.0
    for i in range(len(wanted)):
        dot += wanted[i] * offset[i]
    across = wanted - (dot / (gap * gap)) * offset
    length = norm(across)
    # A component of rounding errors has no direction: the centre of the circle is as near as any.
    is_known = length > ACROSS * norm(wanted)
    for i in range(len(wanted)):
        sideways = across[i] / length * height if is_known else 0.0
        control[i] = along * offset[i] + sideways


@kernel
def _scale_to(vector, length):
    """Scale a vector (dim,) in place to ``length`` if it is longer than that."""
    before = norm(vector)
    if before > length:
        for i in range(len(vector)):
            vector[i] *= length / before


@kernel
def _speed_after(velocity, duration, control):
    """Return the speed a duration [s] after ``velocity`` (dim,) under an acceleration (dim,)."""
    squared = 0.0
    for i in range(len(velocity)):
        squared += (velocity[i] + duration * control[i]) ** 2
    return math.sqrt(squared)


@brake.register(DoubleIntegratorData)
@kernel
def _brake(system, state, control):
    """Write the full acceleration (dim,) against the velocity; return the time to rest [s]."""
    dim = len(control)
    speed = norm(state[dim:])
    for i in range(dim):
        control[i] = -state[dim + i] / speed * system.max_acceleration if speed > 0.0 else 0.0
    return speed / system.max_acceleration


@halt.register(DoubleIntegratorData)
@kernel
def _halt(system, state):
    """Set the velocity of a state (2 dim,) to 0 in place; the position stays."""
    half = len(state) // 2
    for i in range(half, len(state)):
        state[i] = 0.0


@velocity.register(DoubleIntegratorData)
@kernel
def _velocity(system, state, out):
    """Write to ``out`` (dim,) the velocity of a state (2 dim,)."""
    for i in range(len(out)):
        out[i] = state[len(out) + i]
