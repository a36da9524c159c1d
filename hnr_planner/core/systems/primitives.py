"""
The primitives of systems: the functions of a compiled system that planners call.

A compiled system is a NamedTuple of limits in the kernel frame of a space. The type of the
NamedTuple selects the kernel that runs: every system registers one kernel for each primitive. A
state is an array (state_dim,) that begins with the position (dim,); a control is an array
(control_dim,) that is constant for a duration [s].
"""

from typing import Any

from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.dispatch import dispatched
from hnr_planner.core.kernels.kernel import kernel
import numpy as np


@dispatched
@kernel
def move(system: Any, state: Any, control: Any, duration: float, end: Any) -> None:
    """Write to ``end`` (state_dim,) the state after ``duration`` [s] under a constant control."""
    raise NotImplementedError


@dispatched
@kernel
def contact(system: Any, space: Any, state: Any, control: Any, duration: float) -> float:
    """Return the first time [s] in [0, ``duration``] when the motion is not free; inf for none."""
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
    """
    Write to ``control`` the control within the limits that drives towards a target.

    The target is a desired position (dim,) and velocity (dim,) after ``duration`` [s]. ``weight``
    [s] scales a difference in velocity so that it compares with one in position; a system may
    ignore the weight.
    """
    raise NotImplementedError


@dispatched
@kernel
def brake(system: Any, state: Any, control: Any) -> float:
    """Write to ``control`` the control of straight, full braking; return the time to rest [s]."""
    raise NotImplementedError


@dispatched
@kernel
def halt(system: Any, state: Any) -> None:
    """Set the velocity of a state to 0 in place; the position stays."""
    raise NotImplementedError


@dispatched
@kernel
def velocity(system: Any, state: Any, out: Any) -> None:
    """Write to ``out`` (dim,) the velocity of a state (state_dim,)."""
    raise NotImplementedError


@kernel
def propagated(system, states, controls, durations):
    """
    Return the states (k, state_dim) that separate motions from ``states`` end in.

    Motion ``k`` has the constant control ``controls[k]`` (control_dim,) for ``durations[k]`` [s].
    """
    ends = np.empty_like(states)
    for k in range(len(durations)):
        move(system, states[k], controls[k], durations[k], ends[k])
    return ends


@kernel
def first_blocked_step(system, space, states, controls, durations):
    """Return the index into ``durations`` of the first step that is not free; -1 if all are."""
    system, space = borrowed(system), borrowed(space)
    for k in range(len(durations)):
        if contact(system, space, states[k], controls[k], durations[k]) <= durations[k]:
            return k
    return -1
