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

    A state is an array whose first ``dim`` numbers are the position. A control is constant for a
    duration, and the motion under a constant control has a closed form. A class that inherits
    from this one and defines the other members gets ``check_state`` and ``propagate``.
    """

    @property
    def dim(self) -> int:
        """Length of a position."""

    @property
    def state_dim(self) -> int:
        """Length of a state."""

    @property
    def control_dim(self) -> int:
        """Length of a control."""

    @property
    def max_speed(self) -> float:
        """Largest speed [m/s]."""

    @property
    def largest_acceleration(self) -> float:
        """Largest rate of change [m/s^2] of the velocity (dim,), in any direction."""

    @property
    def data(self) -> Any:
        """The compiled system, a NamedTuple of limits, in the caller's units."""

    def check_state(self, name: str, state: ArrayLike) -> Floats:
        """
        Return a state as an array (state_dim,), or raise RequestError that begins with ``name``.

        The speed may exceed ``max_speed`` by rounding only.
        """
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
        """Return the speed [m/s] of a state (state_dim,), at least 0."""

    def lengths(self, states: Floats, controls: Floats, durations: Floats) -> Floats:
        """
        Return how long (k,) [m] the curves of motions from states (k, state_dim) are.

        Controls (k, control_dim) are constant for durations (k,) [s].
        """

    def compiled(self, space: Space) -> Any:
        """Return the compiled system, a NamedTuple of limits, in the kernel frame of a space."""

    def to_kernel(self, space: Space, states: Floats) -> Floats:
        """Convert states (..., state_dim) from the caller's frame to a space's kernel frame."""

    def from_kernel(self, space: Space, states: Floats) -> Floats:
        """Convert states (..., state_dim) from a space's kernel frame to the caller's frame."""

    def controls_to_kernel(self, space: Space, controls: Floats) -> Floats:
        """Convert controls (k, control_dim) from the caller's frame to a space's kernel frame."""

    def controls_from_kernel(self, space: Space, controls: Floats) -> Floats:
        """Convert controls (k, control_dim) from a space's kernel frame to the caller's frame."""


def check_limit(name: str, value: Any) -> float:
    """Return a limit as a finite float above 0, or raise RequestError."""
    limit = check_positive(name, value)
    if limit == math.inf:
        raise RequestError(f'{name} must be finite, got inf')
    return limit


def vectors_to_kernel(space: Space, vectors: Floats) -> Floats:
    """Rotate and scale vectors (..., dim) from the caller's frame to a space's kernel frame."""
    return vectors @ _axes(space) / space.scale


def vectors_from_kernel(space: Space, vectors: Floats) -> Floats:
    """Rotate and scale vectors (..., dim) from a space's kernel frame to the caller's frame."""
    return vectors @ _axes(space).T * space.scale


def _axes(space: Space) -> Floats:
    """Return the caller's axes as unit vectors (dim, dim) of the kernel frame, one in each row."""
    return space.turn_to_kernel(np.eye(space.dim))
