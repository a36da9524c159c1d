"""The protocol of systems: their states and controls, and motion under a constant control."""

import math
from typing import Any, Protocol

from hnr_planner.core.checks import check_number, check_point, check_positive, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.systems.primitives import propagated
import numpy as np
from numpy.typing import ArrayLike

#: Fraction of a limit by which rounding may exceed it.
ROUNDING = 1e-11


class System(Protocol):
    """
    A robot with inertia, in the caller's units: metres, radians, seconds.

    A state is an array whose first ``dim`` numbers are the position. A control is constant for
    some duration, for which the motion has a closed form. Classes that inherit from this one get
    ``check_state`` and ``propagate`` from the rest.
    """

    @property
    def dim(self) -> int:
        """Dimension of positions."""

    @property
    def state_dim(self) -> int:
        """Dimension of states."""

    @property
    def control_dim(self) -> int:
        """Dimension of controls."""

    @property
    def max_speed(self) -> float:
        """Largest speed [m/s]."""

    @property
    def largest_acceleration(self) -> float:
        """Largest change of the velocity (dim,) in a second [m/s^2]."""

    @property
    def data(self) -> Any:
        """The compiled system in the caller's units."""

    def check_state(self, name: str, state: ArrayLike) -> Floats:
        """Return a state (state_dim,) within the speed limit, or raise RequestError."""
        checked = check_point(name, state, self.state_dim)
        speed = self.speed(checked)
        if speed > self.max_speed * (1.0 + ROUNDING):
            raise RequestError(
                f'{name} must be no faster than max_speed, {self.max_speed:g} m/s, '
                f'got {speed!r} m/s in {checked.tolist()}'
            )
        return checked

    def propagate(self, state: ArrayLike, control: ArrayLike, duration: float) -> Floats:
        """Return the state (state_dim,) after ``duration`` [s] under a constant control."""
        start = check_point('state', state, self.state_dim)
        constant = check_point('control', control, self.control_dim)
        time = check_number('duration', duration, 0.0)
        step = start[np.newaxis], constant[np.newaxis], np.array([time])
        end: Floats = propagated(self.data, *step)[0]
        return end

    def velocity(self, state: Floats) -> Floats:
        """Return the velocity [m/s] of a state (state_dim,) as a vector (dim,)."""

    def speed(self, state: Floats) -> float:
        """Return the speed [m/s] of a state (state_dim,)."""

    def lengths(self, states: Floats, controls: Floats, durations: Floats) -> Floats:
        """Return (k,) lengths [m] of motions of states (k, state_dim) in durations (k,) [s]."""

    def compiled(self, space: Space) -> Any:
        """Return the compiled system in the kernel frame of a space."""

    def to_kernel(self, space: Space, states: Floats) -> Floats:
        """Convert states (..., state_dim) to the kernel frame of a space."""

    def from_kernel(self, space: Space, states: Floats) -> Floats:
        """Convert states (..., state_dim) from the kernel frame of a space."""

    def controls_to_kernel(self, space: Space, controls: Floats) -> Floats:
        """Convert controls (k, control_dim) to the kernel frame of a space."""

    def controls_from_kernel(self, space: Space, controls: Floats) -> Floats:
        """Convert controls (k, control_dim) from the kernel frame of a space."""


def check_limit(name: str, value: Any) -> float:
    """Return a limit as a finite float above 0, or raise RequestError."""
    limit = check_positive(name, value)
    if limit == math.inf:
        raise RequestError(f'{name} must be finite, got inf')
    return limit


def vectors_to_kernel(space: Space, vectors: Floats) -> Floats:
    """Rotate and scale vectors (..., dim) to the kernel frame of a space."""
    return vectors @ _axes(space) / space.scale


def vectors_from_kernel(space: Space, vectors: Floats) -> Floats:
    """Rotate and scale vectors (..., dim) from the kernel frame of a space."""
    return vectors @ _axes(space).T * space.scale


def _axes(space: Space) -> Floats:
    """Return the axes (dim, dim) of the caller's frame, one in each row, in the kernel frame."""
    return space.turn_to_kernel(np.eye(space.dim))
