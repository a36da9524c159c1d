"""
Simulate the survey of a floor plan by a laser scanner.

A scanner stands at many positions in every room, each known up to a small error. Its rays stop
at the first solid object, with noise in range, and almost always at panes of glass. A cell is
occupied when enough of the rays that reached it ended there, free when rays went through it, and
unknown when none reached it. So walls are ragged, the inside of objects and the outdoors stay
unknown, and windows leave streaks of free cells.
"""

from __future__ import annotations

from hnr_planner.maps.floor_plan import AIR, CELL, FloorPlan, GLASS, Rect, SOLID
from hnr_planner.maps.occupancy import FREE, OccupancyMap, OCCUPIED, UNKNOWN
import numpy as np
from numpy.typing import NDArray

#: Rays of a scan, and their range [m].
RAYS = 720
RANGE = 8.0
#: Largest error in range [m].
NOISE = 0.04
#: Largest error in the scanner's estimated pose [m, m, rad].
DRIFT = (0.025, 0.025, 0.004)
#: Fraction of the rays that a pane of glass stops.
SEES_GLASS = 0.97
#: A cell is occupied when more than this fraction of the rays that reached it ended in it.
HIT_SHARE = 0.25
#: Approximate distance between neighbouring positions of the scanner in a room [m].
SPACING = 1.9
#: Half the side of the square around the scanner that has to be air [m].
ROOM_TO_STAND = 0.4


def survey(
    rng: np.random.Generator, plan: FloorPlan, resolution: float, margin: float
) -> OccupancyMap:
    """
    Return the map that a simulated survey of a floor plan gives.

    Its cells have the side ``resolution`` [m], and it reaches ``margin`` [m] beyond the building
    on every side. The building's lower left corner is the map frame's (0, 0).
    """
    sides = np.array(plan.material.shape) * CELL + 2 * margin
    height, width = (round(side / resolution) for side in sides)
    hits = np.zeros(height * width, np.int64)
    passes = np.zeros(height * width, np.int64)

    def cells(points: NDArray[np.floating]) -> NDArray[np.int64]:
        columns, rows = np.floor((points + margin) / resolution).astype(int).T
        inside = (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height)
        return rows[inside] * width + columns[inside]

    for place in _places(rng, plan):
        ends, crossed = _scan(rng, plan.material, place, resolution)
        hits += np.bincount(cells(ends), minlength=hits.size)
        passes += np.bincount(cells(crossed), minlength=hits.size)
    data = np.full(hits.size, UNKNOWN, np.int8)
    data[passes > 0] = FREE
    data[hits > HIT_SHARE * (hits + passes)] = OCCUPIED
    return OccupancyMap(data.reshape(height, width), resolution, (-margin, -margin, 0.0))


def _places(rng: np.random.Generator, plan: FloorPlan) -> list[NDArray[np.floating]]:
    """
    Return the positions (x, y) [m] of the scanner: a perturbed lattice in every room.

    Positions closer than ``ROOM_TO_STAND`` in x and in y to anything but air are left out.
    """
    places: list[NDArray[np.floating]] = []
    for room in plan.rooms:
        left, bottom, right, top = room.rect.grown(-0.6)
        for x in np.linspace(left, right, 1 + round((right - left) / SPACING)):
            for y in np.linspace(bottom, top, 1 + round((top - bottom) / SPACING)):
                place = np.array([x, y]) + rng.uniform(-0.2, 0.2, 2)
                if _is_clear(plan.material, place):
                    places.append(place)
    return places


def _is_clear(material: NDArray[np.uint8], place: NDArray[np.floating]) -> bool:
    around = Rect(*place, *place).grown(ROOM_TO_STAND)
    left, bottom, right, top = (round(edge / CELL) for edge in around)
    return bool((material[bottom:top, left:right] == AIR).all())


def _scan(
    rng: np.random.Generator,
    material: NDArray[np.uint8],
    place: NDArray[np.floating],
    step: float,
) -> tuple[NDArray[np.floating], NDArray[np.floating]]:
    """
    Simulate one scan from ``place`` [m]; return where rays ended (k, 2) and went through (m, 2).

    Both are points [m] as the survey records them: with the errors of the estimated pose, and the
    ends with noise in range. Points that a ray went through are ``step`` [m] apart; a ray that
    nothing stopped within ``RANGE`` has no end.
    """
    angles = (np.arange(RAYS) + rng.random()) * (2 * np.pi / RAYS)
    ranges = (np.arange(round(RANGE / step)) + 0.5) * step
    met = _material_at(material, _along(place, angles, ranges))
    sees_glass = rng.random(RAYS) < SEES_GLASS
    stops = (met == SOLID) | ((met == GLASS) & sees_glass[:, None])
    stopped = stops.any(axis=1)
    first = np.where(stopped, stops.argmax(axis=1), ranges.size)
    *shift, turn = (rng.random(3) - rng.random(3)) * DRIFT
    drawn = _along(place + shift, angles + turn, ranges)
    crossed = drawn[np.arange(ranges.size) < first[:, None]]
    noise = (rng.random(RAYS) - rng.random(RAYS)) * NOISE
    reach = ranges[first[stopped]] + noise[stopped]
    ends = _along(place + shift, angles[stopped] + turn, reach[:, None])[:, 0]
    return ends, crossed


def _along(
    place: NDArray[np.floating], angles: NDArray[np.floating], ranges: NDArray[np.floating]
) -> NDArray[np.floating]:
    """
    Return the points (rays, steps, 2) [m] at the given ranges along rays from a place.

    ``angles`` is (rays,) [rad]. ``ranges`` [m] is (steps,), for all rays, or (rays, steps).
    """
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return place + directions[:, None, :] * ranges[..., None]


def _material_at(material: NDArray[np.uint8], points: NDArray[np.floating]) -> NDArray[np.uint8]:
    """Return the material at points (..., 2) [m]; outside the grid of materials it is AIR."""
    columns, rows = np.moveaxis(np.floor(points / CELL).astype(int), -1, 0)
    height, width = material.shape
    inside = (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height)
    return np.where(inside, material[rows * inside, columns * inside], AIR)
