"""
The primitives of systems: what planners ask of a compiled one.

A compiled system is a NamedTuple of its limits, in the kernel frame of a space. Its states are
arrays, position first. For its type these kernels are registered:

``move(system, state, control, duration, end)``
    Write the state after ``duration`` under a constant control.
``contact(system, space, state, control, duration) -> float``
    The first time in [0, ``duration``] at which the motion is not free; inf for none.
``steer(system, state, position, velocity, weight, duration, control)``
    Write the control that brings the state nearest to a desired position and velocity.
``brake(system, state, control) -> float``
    Write the control that comes to rest soonest, and return how long that takes.
``halt(system, state)``
    Take all motion out of a state: what an inelastic boundary does.
``velocity(system, state, out)``
    Write the velocity (dim,) of a state.

Compiled code calls them by these names for any system, as it does with the primitives of spaces.
"""

from typing import Any, NamedTuple

from hnr_planner.core.borrowed import borrowed
from hnr_planner.core.kernels import interpreted, kernel
from numba.core.dispatcher import Dispatcher
from numba.extending import overload


class SystemPrimitives(NamedTuple):
    """The kernels of one type of compiled system."""

    move: Dispatcher
    contact: Dispatcher
    steer: Dispatcher
    brake: Dispatcher
    halt: Dispatcher
    velocity: Dispatcher


_SYSTEMS: dict[type, SystemPrimitives] = {}


def register_system(data_type: type, primitives: SystemPrimitives) -> None:
    """Let the primitives answer for NamedTuples of ``data_type``."""
    _SYSTEMS[data_type] = primitives


def move(system: Any, state: Any, control: Any, duration: float, end: Any) -> None:
    """Write the ``end`` of ``duration`` under a constant control."""
    interpreted(_SYSTEMS[type(system)].move)(system, state, control, duration, end)


def contact(system: Any, space: Any, state: Any, control: Any, duration: float) -> float:
    """Return the first time in [0, ``duration``] at which the motion is not free, or inf."""
    return interpreted(_SYSTEMS[type(system)].contact)(system, space, state, control, duration)


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
    chosen = interpreted(_SYSTEMS[type(system)].steer)
    chosen(system, state, position, velocity, weight, duration, control)


def brake(system: Any, state: Any, control: Any) -> float:
    """Write the control that comes to rest soonest, and return how long that takes."""
    return interpreted(_SYSTEMS[type(system)].brake)(system, state, control)


def halt(system: Any, state: Any) -> None:
    """Take all motion out of a state."""
    interpreted(_SYSTEMS[type(system)].halt)(system, state)


def velocity(system: Any, state: Any, out: Any) -> None:
    """Write how a state moves: (dim,)."""
    interpreted(_SYSTEMS[type(system)].velocity)(system, state, out)


@overload(move)
def _compiled_move(system, state, control, duration, end):
    compiled = _SYSTEMS[system.instance_class].move
    return lambda system, state, control, duration, end: compiled(
        system, state, control, duration, end
    )


@overload(contact)
def _compiled_contact(system, space, state, control, duration):
    compiled = _SYSTEMS[system.instance_class].contact
    return lambda system, space, state, control, duration: compiled(
        system, space, state, control, duration
    )


@overload(steer)
def _compiled_steer(system, state, position, velocity, weight, duration, control):
    compiled = _SYSTEMS[system.instance_class].steer
    return lambda system, state, position, velocity, weight, duration, control: compiled(
        system, state, position, velocity, weight, duration, control
    )


@overload(brake)
def _compiled_brake(system, state, control):
    compiled = _SYSTEMS[system.instance_class].brake
    return lambda system, state, control: compiled(system, state, control)


@overload(halt)
def _compiled_halt(system, state):
    compiled = _SYSTEMS[system.instance_class].halt
    return lambda system, state: compiled(system, state)


@overload(velocity)
def _compiled_velocity(system, state, out):
    compiled = _SYSTEMS[system.instance_class].velocity
    return lambda system, state, out: compiled(system, state, out)


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
