"""Worlds for robots with inertia: coarse grids, so that the checker is quick."""

from test.curve_brute_force import car_faults, double_integrator_faults

from hnr_planner.core import GridSpace, TrajectoryResult
from hnr_planner.core.systems import Car, DoubleIntegrator, System
import numpy as np
from numpy.typing import NDArray

RESOLUTION = 0.25
#: Turned and moved away, so that no test passes in the grid's own frame only.
ORIGIN = (3.0, -1.0, 0.4)

INTEGRATOR = DoubleIntegrator(dim=2, max_acceleration=1.0, max_speed=2.0)
CAR = Car(max_acceleration=1.0, max_speed=2.0, max_curvature=2.0)


def serpentine(width: float, arm: float = 6.0) -> NDArray[np.bool_]:
    """Return blocked cells that leave three parallel arms, joined by two turns."""
    w, length = round(width / RESOLUTION), round(arm / RESOLUTION)
    blocked = np.zeros((3 * w + 2, length), dtype=bool)
    blocked[w, : length - w] = True
    blocked[2 * w + 1, w:] = True
    return blocked


def space_of(blocked: NDArray[np.bool_]) -> GridSpace:
    return GridSpace.from_blocked(blocked, RESOLUTION, ORIGIN)


def in_map(x: float, y: float) -> NDArray[np.float64]:
    """Return a point or vector of the grid's frame [m] in the map's."""
    z = complex(x, y) * np.exp(1j * ORIGIN[2])
    return np.array([z.real + ORIGIN[0], z.imag + ORIGIN[1]])


def state(x: float, y: float, vx: float = 0.0, vy: float = 0.0) -> NDArray[np.float64]:
    """Return a state of the double integrator, given in the grid's frame."""
    return np.append(in_map(x, y), in_map(vx, vy) - in_map(0.0, 0.0))


#: The serpentine that most tests plan in, from end to end.
BLOCKED = serpentine(1.5)
SPACE = space_of(BLOCKED)
START, GOAL = state(0.75, 0.75), in_map(5.25, 4.25)


def faults(
    result: TrajectoryResult, system: System, blocked: NDArray[np.bool_], inelastic: bool = False
) -> list[str]:
    """Return what the checker finds wrong with the trajectory of a result."""
    trajectory = result.trajectory
    assert trajectory is not None, result.message
    motion = trajectory.times, trajectory.states, trajectory.controls
    geometric = {'inelastic': inelastic, 'resolution': RESOLUTION, 'origin': ORIGIN}
    if isinstance(system, Car):
        return car_faults(
            *motion,
            blocked,
            max_acceleration=system.max_acceleration,
            max_speed=system.max_speed,
            max_curvature=system.max_curvature,
            **geometric,
        )
    return double_integrator_faults(
        *motion,
        blocked,
        max_acceleration=INTEGRATOR.max_acceleration,
        max_speed=INTEGRATOR.max_speed,
        **geometric,
    )
