"""
The primitives of systems: what planners ask of a compiled one.

A compiled system is a NamedTuple of its limits, in the kernel frame of a space, and registers a
kernel of its own for each primitive. Its states are arrays, position first.
"""

from typing import Any

from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.dispatch import dispatched
from hnr_planner.core.kernels.kernel import kernel


@dispatched
@kernel
def move(system: Any, state: Any, control: Any, duration: float, end: Any) -> None:
    """Write the ``end`` of ``duration`` under a constant control."""
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
    """Write the control that brings the state nearest to a desired position and velocity."""
    raise NotImplementedError


@dispatched
@kernel
def brake(system: Any, state: Any, control: Any) -> float:
    """Write the control that comes to rest soonest, and return how long that takes."""
    raise NotImplementedError


@dispatched
@kernel
def halt(system: Any, state: Any) -> None:
    """Take all motion out of a state."""
    raise NotImplementedError


@dispatched
@kernel
def velocity(system: Any, state: Any, out: Any) -> None:
    """Write how a state moves: (dim,)."""
    raise NotImplementedError


@kernel
def moved(system, state, control, duration):
    """Return the state after ``duration`` under a constant control: ``move`` for Python."""
    end = state.copy()
    move(system, state, control, duration, end)
    return end


@kernel
def first_blocked_step(system, space, states, controls, durations):
    """Index of the first step of a motion that meets the boundary; -1 when none does."""
    system, space = borrowed(system), borrowed(space)
    for k in range(len(durations)):
        if contact(system, space, states[k], controls[k], durations[k]) <= durations[k]:
            return k
    return -1


@kernel
def first_contact(system, space, state, control, duration):
    """Return what ``contact`` does, for Python."""
    return contact(system, space, state, control, duration)
