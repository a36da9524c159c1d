"""What a system is: its states and controls, and the motion under a constant control."""

from typing import Any, Protocol

from hnr_planner.core.checks import Floats
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import ArrayLike

#: Limits may be exceeded by this part of them, which is rounding.
ROUNDING = 1e-11


class System(Protocol):
    """
    A robot with inertia, in the caller's units: metres, radians, seconds.

    A state is an array whose first ``dim`` numbers are the position. A control is constant for
    some duration, in which everything is closed form.
    """

    @property
    def dim(self) -> int:
        """Dimension of positions."""

    @property
    def state_dim(self) -> int:
        """Numbers in a state."""

    @property
    def control_dim(self) -> int:
        """Numbers in a control."""

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
        """Return a state (state_dim,) within the limits, or raise RequestError."""

    def propagate(self, state: ArrayLike, control: ArrayLike, duration: float) -> Floats:
        """Return the state (state_dim,) after ``duration`` [s] under a constant control."""

    def velocity(self, state: Floats) -> Floats:
        """Return how a state moves: (dim,) [m/s]."""

    def speed(self, state: Floats) -> float:
        """Return the speed [m/s] of a state."""

    def lengths(self, states: Floats, controls: Floats, durations: Floats) -> Floats:
        """Return how far states (k, state_dim) go in durations (k,) under controls: (k,) [m]."""

    def compiled(self, space: Space) -> Any:
        """Return the compiled system in the kernel frame of a space."""

    def to_kernel(self, space: Space, states: Floats) -> Floats:
        """Bring states (..., state_dim) into the kernel frame of a space."""

    def from_kernel(self, space: Space, states: Floats) -> Floats:
        """Bring states (..., state_dim) out of the kernel frame of a space."""

    def controls_to_kernel(self, space: Space, controls: Floats) -> Floats:
        """Bring controls (k, control_dim) into the kernel frame of a space."""

    def controls_from_kernel(self, space: Space, controls: Floats) -> Floats:
        """Bring controls (k, control_dim) out of the kernel frame of a space."""


def vectors_to_kernel(space: Space, vectors: Floats) -> Floats:
    """Turn and scale vectors (..., dim) into the kernel frame of a space."""
    return vectors @ _axes(space) / space.scale


def vectors_from_kernel(space: Space, vectors: Floats) -> Floats:
    """Turn and scale vectors (..., dim) out of the kernel frame of a space."""
    return vectors @ _axes(space).T * space.scale


def _axes(space: Space) -> Floats:
    """Axes (dim, dim) of the caller's frame, each a row, in the kernel frame."""
    return space.turn_to_kernel(np.eye(space.dim))
