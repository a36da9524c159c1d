"""
An independent checker of trajectories: slow, and obviously right.

It shares no code with the planner. Every step is a curve whose crossings with straight lines are
solved for; between crossings with the grid's lines it lies in one cell, so that looking at the
middle of each part is exact.
"""

from collections.abc import Sequence
import itertools
import math
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

TOLERANCE = 1e-7
"""How deep, in cells, a curve may lie in a blocked square before it counts as a collision."""
AT_WALL = 1e-4
"""How far from a wall, in cells, an inelastic stop may be."""
SAME = 1e-6
"""How far a state may be from what the one before leads to."""

Floats = NDArray[np.float64]


class Curve(Protocol):
    """A curve by a parameter in [first, last]."""

    first: float
    last: float

    def at(self, s: float) -> complex:
        """Return the point x + iy at a parameter."""

    def crossings(self, normal: complex, offset: float) -> list[float]:
        """Return the parameters at which the line <normal, z> = offset is met."""


class Throw:
    """Position, velocity and acceleration (2,) over a time."""

    def __init__(self, x: ArrayLike, v: ArrayLike, a: ArrayLike, duration: float) -> None:
        self.x, self.v, self.a = (complex(*np.asarray(each)) for each in (x, v, a))
        self.first, self.last = 0.0, float(duration)

    def at(self, s: float) -> complex:
        return self.x + self.v * s + self.a * s**2 / 2

    def crossings(self, normal: complex, offset: float) -> list[float]:
        def along(z: complex) -> float:
            return (z * normal.conjugate()).real

        polynomial = [along(self.a) / 2, along(self.v), along(self.x) - offset]
        roots = np.roots(polynomial) if np.any(polynomial[:2]) else np.empty(0)
        return [float(r.real) for r in roots if abs(r.imag) < 1e-9]


class Bend:
    """An arc from a point and heading, between two signed lengths."""

    def __init__(self, z: complex, heading: float, curvature: float, ends: Sequence[float]):
        self.z, self.way, self.curvature = z, complex(np.exp(1j * heading)), curvature
        self.first, self.last = min(ends), max(ends)

    def at(self, s: float) -> complex:
        if abs(self.curvature * s) < 1e-8:
            return self.z + self.way * (s + 0.5j * self.curvature * s**2)
        return self.z + self.way * (np.exp(1j * self.curvature * s) - 1) / (1j * self.curvature)

    def crossings(self, normal: complex, offset: float) -> list[float]:
        if abs(self.curvature) * max(self.last, -self.first) < 1e-8:
            speed = (self.way * normal.conjugate()).real
            missing = offset - (self.z * normal.conjugate()).real
            return [missing / speed] if speed else []
        # On the circle around c: <n, c + r e^(i f)> = offset.
        centre = self.z + 1j * self.way / self.curvature
        spoke = self.z - centre
        cosine = (offset - (centre * normal.conjugate()).real) / (abs(spoke) * abs(normal))
        if abs(cosine) > 1:
            return []
        base = np.angle(normal) - np.angle(spoke)
        angles = [base + sign * math.acos(cosine) for sign in (1, -1)]
        turns = int(abs(self.curvature) * max(self.last, -self.first) / (2 * np.pi)) + 2
        return [
            (angle + 2 * np.pi * k) / self.curvature
            for angle in angles
            for k in range(-turns, turns + 1)
        ]


def curve_collisions(curve: Curve, blocked: ArrayLike) -> list[str]:
    """Return what a curve, given in cells, collides with; an empty list for nothing."""
    ringed = np.pad(np.asarray(blocked, dtype=bool), 2, constant_values=True)
    parts = [curve.first, curve.last]
    length = curve.last - curve.first
    reach = np.array([_pair(curve.at(s)) for s in np.linspace(curve.first, curve.last, 33)])
    low = np.floor(reach.min(axis=0) - 0.2 * np.ptp(reach, axis=0)).astype(int) - 1
    high = np.ceil(reach.max(axis=0) + 0.2 * np.ptp(reach, axis=0)).astype(int) + 1
    low, high = np.maximum(low, -1), np.minimum(high, np.array(ringed.shape[::-1]) - 3)
    for normal, first, last in ((1 + 0j, low[0], high[0]), (1j, low[1], high[1])):
        for line in range(first, last + 1):
            for offset in (line - TOLERANCE, line + TOLERANCE):
                parts += curve.crossings(normal, offset)
    times = np.unique(np.clip(parts, curve.first, curve.last))
    found = []
    for a, b in itertools.pairwise(times):
        if b - a > 1e-13 * (1 + length) and _is_blocked(_pair(curve.at((a + b) / 2)), ringed):
            found.append(f'is blocked at {_pair(curve.at((a + b) / 2))}')
    if length == 0.0 and _is_blocked(_pair(curve.at(curve.first)), ringed):
        found.append('stands on a blocked cell')
    return found + _squeezes(curve, ringed, low, high)


def _is_blocked(point: tuple[float, float], ringed: NDArray[np.bool_]) -> bool:
    """Say whether a point lies in a rectangle of up to 2 x 2 blocked cells, shrunk."""
    x, y = point
    rows, columns = ringed.shape
    if not (-1 < x < columns - 3 and -1 < y < rows - 3):
        return True
    for height in (1, 2):
        for width in (1, 2):
            for row in (math.floor(y) + 1 - k for k in range(height)):
                for column in (math.floor(x) + 1 - k for k in range(width)):
                    inside = (
                        column - 1 + TOLERANCE < x < column - 1 + width - TOLERANCE
                        and row - 1 + TOLERANCE < y < row - 1 + height - TOLERANCE
                    )
                    bottom, left = row + 1, column + 1
                    if inside and ringed[bottom:, left:][:height, :width].all():
                        return True
    return False


def _squeezes(curve: Curve, ringed: NDArray[np.bool_], low: NDArray, high: NDArray) -> list[str]:
    found = []
    for row in range(low[1], high[1] + 1):
        for column in range(low[0], high[0] + 1):
            bottom, left = row + 1, column + 1
            around = ringed[bottom:, left:][:2, :2]
            rising = around[0, 0] and around[1, 1] and not around[0, 1] and not around[1, 0]
            falling = around[0, 1] and around[1, 0] and not around[0, 0] and not around[1, 1]
            if not (rising or falling):
                continue
            corner = complex(column, row)
            normal = 1 - 1j if rising else 1 + 1j
            for s in curve.crossings(normal, (corner * normal.conjugate()).real):
                near = abs(curve.at(s) - corner) < 3 * TOLERANCE
                if curve.first <= s <= curve.last and near:
                    found.append(f'squeezes between diagonal cells at ({column}, {row})')
    return found


def double_integrator_faults(
    times: ArrayLike,
    states: ArrayLike,
    controls: ArrayLike,
    blocked: ArrayLike,
    *,
    max_acceleration: float,
    max_speed: float,
    inelastic: bool = False,
    resolution: float = 1.0,
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> list[str]:
    """Return everything that is wrong with a trajectory of a planar double integrator."""
    times, states, controls = (np.asarray(each, dtype=float) for each in (times, states, controls))
    found = _shape_faults(times, states, controls, 4)
    if found:
        return found
    for k, (acceleration, duration) in enumerate(zip(controls, np.diff(times), strict=True)):
        x, v = states[k, :2], states[k, 2:]
        end = x + duration * v + duration**2 / 2 * acceleration
        after = v + duration * acceleration
        where = f'step {k}'
        if np.hypot(*acceleration) > max_acceleration * (1 + 1e-9):
            found.append(f'{where} accelerates by {np.hypot(*acceleration)}')
        if max(np.hypot(*v), np.hypot(*after)) > max_speed * (1 + 1e-9):
            found.append(f'{where} is as fast as {max(np.hypot(*v), np.hypot(*after))}')
        if np.abs(end - states[k + 1, :2]).max() > SAME:
            found.append(f'{where} ends at {end}, not at {states[k + 1, :2]}')
        corners = [_in_cells(z, resolution, origin) for z in (x, x + v, x + acceleration)]
        base = corners[0]
        curve = Throw(base, corners[1] - base, corners[2] - base, duration)
        if np.abs(after - states[k + 1, 2:]).max() > SAME:
            stops = not states[k + 1, 2:].any()
            if not (inelastic and stops and _at_wall(curve.at(duration), blocked)):
                found.append(f'{where} has velocity {after}, not {states[k + 1, 2:]}')
        found += [f'{where} {what}' for what in curve_collisions(curve, blocked)]
    return found


def car_faults(
    times: ArrayLike,
    states: ArrayLike,
    controls: ArrayLike,
    blocked: ArrayLike,
    *,
    max_acceleration: float,
    max_speed: float,
    max_curvature: float,
    inelastic: bool = False,
    resolution: float = 1.0,
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> list[str]:
    """Return everything that is wrong with a trajectory of a car."""
    times, states, controls = (np.asarray(each, dtype=float) for each in (times, states, controls))
    found = _shape_faults(times, states, controls, 4)
    if found:
        return found
    for k, ((pull, curvature), duration) in enumerate(zip(controls, np.diff(times), strict=True)):
        x, y, heading, speed = states[k]
        where, after = f'step {k}', speed + pull * duration
        ways = [0.0, speed * duration + pull * duration**2 / 2]
        if speed * after < 0:
            ways.append(-(speed**2) / (2 * pull))
        end = Bend(complex(x, y), heading, curvature, ways).at(ways[1])
        if abs(pull) > max_acceleration * (1 + 1e-9):
            found.append(f'{where} accelerates by {pull}')
        if abs(curvature) > max_curvature * (1 + 1e-9):
            found.append(f'{where} turns by {curvature}')
        if max(abs(speed), abs(after)) > max_speed * (1 + 1e-9):
            found.append(f'{where} is as fast as {max(abs(speed), abs(after))}')
        expected = np.array([end.real, end.imag, heading + curvature * ways[1]])
        if np.abs(expected - states[k + 1, :3]).max() > SAME:
            found.append(f'{where} ends at {expected}, not at {states[k + 1, :3]}')
        in_cells = complex(*_in_cells(np.array([x, y]), resolution, origin))
        curve = Bend(
            in_cells, heading - origin[2], curvature * resolution, np.array(ways) / resolution
        )
        if abs(after - states[k + 1, 3]) > SAME:
            there = curve.at(ways[1] / resolution)
            if not (inelastic and states[k + 1, 3] == 0 and _at_wall(there, blocked)):
                found.append(f'{where} has speed {after}, not {states[k + 1, 3]}')
        found += [f'{where} {what}' for what in curve_collisions(curve, blocked)]
    return found


def _shape_faults(times: Floats, states: Floats, controls: Floats, width: int) -> list[str]:
    if not (len(times) == len(states) == len(controls) + 1 >= 2 and states.shape[1] == width):
        return [f'shapes {times.shape}, {states.shape}, {controls.shape} make no trajectory']
    if not all(np.isfinite(each).all() for each in (times, states, controls)):
        return ['is not finite']
    if times[0] != 0 or (np.diff(times) < 0).any():
        return [f'times do not go up from 0: {times}']
    return []


def _at_wall(point: complex, blocked: ArrayLike) -> bool:
    """Say whether a point in cells lies right beside a blocked cell."""
    ringed = np.pad(np.asarray(blocked, dtype=bool), 1, constant_values=True)
    return any(
        ringed[
            min(max(math.floor(point.imag + dy) + 1, 0), ringed.shape[0] - 1),
            min(max(math.floor(point.real + dx) + 1, 0), ringed.shape[1] - 1),
        ]
        for dx in (-AT_WALL, AT_WALL)
        for dy in (-AT_WALL, AT_WALL)
    )


def _in_cells(
    point: NDArray, resolution: float, origin: tuple[float, float, float]
) -> NDArray[np.float64]:
    x, y, yaw = origin
    z = (complex(*point) - complex(x, y)) * np.exp(-1j * yaw) / resolution
    return np.array([z.real, z.imag])


def _pair(z: complex) -> tuple[float, float]:
    return float(z.real), float(z.imag)
