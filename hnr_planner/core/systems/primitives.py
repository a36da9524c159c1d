"""
The primitives of systems: the functions of a compiled system that planners call.

A compiled system is a NamedTuple of its limits, in the kernel frame of a space, and registers its
own kernel for each primitive. A state is an array (state_dim,) that begins with the position
(dim,); a control is an array (control_dim,) that is constant for a duration [s].
"""

from typing import Any

from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.dispatch import dispatched
from hnr_planner.core.kernels.kernel import kernel
import numpy as np


@dispatched
@kernel
def move(system: Any, state: Any, control: Any, duration: float, end: Any) -> None:
    """Write to ``end`` the state after ``duration`` under a constant control."""
    raise NotImplementedError


@dispatched
@kernel
def contact(system: Any, space: Any, state: Any, control: Any, duration: float) -> float:
    """Return the first time in [0, ``duration``] at which the motion is not free, or inf."""
    raise NotImplementedError


@dispatched
@kernel
def steer(
    system: Any,
    state: Any,
    position: Any,
    velocity: Any,
    weight: float,
    duration: float,
    control: Any,
) -> None:
    """Write the control that leads nearest to a desired position and velocity in a duration."""
    raise NotImplementedError


@dispatched
@kernel
def brake(system: Any, state: Any, control: Any) -> float:
    """Write the control that brakes along the heading to rest; return the time to rest [s]."""
    raise NotImplementedError


@dispatched
@kernel
def halt(system: Any, state: Any) -> None:
    """Set the velocity of a state to 0."""
    raise NotImplementedError


@dispatched
@kernel
def velocity(system: Any, state: Any, out: Any) -> None:
    """Write the velocity of a state to a vector (dim,)."""
    raise NotImplementedError


@kernel
def propagated(system, states, controls, durations):
    """Return the states (k, state_dim) after durations (k,) under controls (k, control_dim)."""
    ends = np.empty_like(states)
    for k in range(len(durations)):
        move(system, states[k], controls[k], durations[k], ends[k])
    return ends


@kernel
def first_blocked_step(system, space, states, controls, durations):
    """Return the index of the first step of a motion that is not free; -1 when all are."""
    system, space = borrowed(system), borrowed(space)
    for k in range(len(durations)):
        if contact(system, space, states[k], controls[k], durations[k]) <= durations[k]:
            return k
    return -1
