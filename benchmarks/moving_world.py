"""
Generate floors whose doors open and close while people walk about.

The office has rows of rooms with double doors between most of them. The store has rows of shelves
with aisles between them, some of which a gate can close: so there are several ways to every place,
of nearly the same length. A door stays open or closed for a random time, and is open while
somebody walks through it. People walk from place to place and stand in between.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise, product
from typing import NamedTuple

from hnr_planner.maps import FREE, OCCUPIED
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

#: Side of a cell, and sides of a floor [m].
RESOLUTION, WIDTH, HEIGHT = 0.05, 24.0, 16.0
#: Thickness of walls, width of doors, and least distance of a door from a corner of a room [m].
WALL, DOOR, CORNER = 0.15, 1.6, 0.4
#: Rooms side by side, rows of rooms, and the fraction of the walls between two with a door.
ROOMS, ROWS, WITH_DOOR = 4, 3, 0.85
#: Shelves side by side, rows of shelves, width of aisles [m], and the fraction of the aisles
#: between two shelves of a row that have a gate.
SHELVES, SHELF_ROWS, AISLE, WITH_GATE = 5, 4, 1.9, 0.25
#: Mean times [s] for which a door stays open and closed.
OPEN, CLOSED = 60.0, 30.0
#: Number of people, their radius [m], speed [m/s], and longest time [s] that one stands.
PEOPLE, PERSON, SPEED, STANDING = 12, 0.25, 1.0, 10.0
#: A person opens a door from this distance [m].
REACH = 0.8
#: Maps a second.
RATE = 1.0


class Rect(NamedTuple):
    """Rectangle, by the coordinates of its four sides [m]."""

    left: float
    bottom: float
    right: float
    top: float

    @property
    def middle(self) -> Floats:
        """The point (2,) in the middle [m]."""
        return np.array([self.left + self.right, self.bottom + self.top]) / 2.0

    def cells(self) -> tuple[slice, slice]:
        """Return the rows and the columns of the map that it covers."""
        left, bottom, right, top = (round(side / RESOLUTION) for side in self)
        return slice(bottom, top), slice(left, right)


class Floor(NamedTuple):
    """
    A floor without people.

    Attributes
    ----------
    walls : (rows, cols) bool
        Cells that are always occupied; all doors are open.
    doors : list of Rect
        Doors, open or closed.
    places : list of Rect
        Where people stand, and robots have their goals.
    ways : list of (int, int, list of (2,))
        Pairs of places, and points on the way from the first to the second [m].

    """

    walls: Bools
    doors: list[Rect]
    places: list[Rect]
    ways: list[tuple[int, int, list[Floats]]]


def office(rng: np.random.Generator) -> Floor:
    """Generate rows of rooms of random sizes."""
    rooms, doors, ways = [], [], []
    for bottom, top in pairwise(_cuts(rng, HEIGHT - WALL, ROWS)):
        for left, right in pairwise(_cuts(rng, WIDTH - WALL, ROOMS)):
            rooms.append(Rect(left + WALL, bottom + WALL, right, top))
    for (a, room), (b, other) in product(enumerate(rooms), enumerate(rooms)):
        door = _door(rng, room, other)
        if door is not None and rng.uniform() < WITH_DOOR:
            doors.append(door)
            ways.append((a, b, [door.middle]))
    walls = _solid()
    for rect in (*rooms, *doors):
        walls[rect.cells()] = False
    return Floor(walls, doors, [_inside(room, 2.0 * PERSON) for room in rooms], ways)


def store(rng: np.random.Generator) -> Floor:
    """Generate rows of shelves; a place is where two aisles cross."""
    walls = _solid()
    walls[Rect(WALL, WALL, WIDTH - WALL, HEIGHT - WALL).cells()] = False
    width = (WIDTH - 2.0 * WALL - (SHELVES + 1) * AISLE) / SHELVES
    height = (HEIGHT - 2.0 * WALL - (SHELF_ROWS + 1) * AISLE) / SHELF_ROWS
    lefts = WALL + (width + AISLE) * np.arange(SHELVES + 1)
    bottoms = WALL + (height + AISLE) * np.arange(SHELF_ROWS + 1)
    places, ways, doors = [], [], []
    for row, column in product(range(SHELF_ROWS + 1), range(SHELVES + 1)):
        left, bottom = float(lefts[column]), float(bottoms[row])
        place = len(places)
        places.append(_inside(Rect(left, bottom, left + AISLE, bottom + AISLE), PERSON))
        if column < SHELVES:
            ways.append((place, place + 1, []))
        if row < SHELF_ROWS:
            ways.append((place, place + SHELVES + 1, []))
            low = bottom + AISLE + rng.uniform(0.2, 0.8) * height
            if rng.uniform() < WITH_GATE:
                doors.append(Rect(left, low, left + AISLE, low + WALL))
        if column < SHELVES and row < SHELF_ROWS:
            shelf = Rect(
                left + AISLE, bottom + AISLE, left + AISLE + width, bottom + AISLE + height
            )
            walls[_inside(shelf, rng.uniform(0.0, 0.2)).cells()] = True
    return Floor(walls, doors, places, ways)


@dataclass(frozen=True)
class MovingWorld:
    """
    A floor over a time, as a map for each moment.

    Attributes
    ----------
    floor : Floor
        The floor without people.
    is_open : (n, d) bool
        Whether each door is open at each moment.
    people : (n, p, 2)
        Where everybody is at each moment [m].

    """

    floor: Floor
    is_open: Bools
    people: Floats

    def data(self, moment: int) -> NDArray[np.int8]:
        """Return the occupancy (rows, cols) of the map at a moment."""
        occupied = self.floor.walls.copy()
        for door, is_open in zip(self.floor.doors, self.is_open[moment], strict=True):
            if not is_open:
                occupied[door.cells()] = True
        x, y = self._centres
        for person in self.people[moment]:
            occupied |= (x - person[0]) ** 2 + (y - person[1]) ** 2 <= PERSON**2
        return np.where(occupied, OCCUPIED, FREE).astype(np.int8)

    @cached_property
    def _centres(self) -> tuple[Floats, Floats]:
        """Coordinates x (1, cols) and y (rows, 1) of the centres of the cells [m]."""
        rows, columns = self.floor.walls.shape
        return (
            (np.arange(columns)[np.newaxis] + 0.5) * RESOLUTION,
            (np.arange(rows)[:, np.newaxis] + 0.5) * RESOLUTION,
        )


def moving_world(
    make_floor: Callable[[np.random.Generator], Floor], seed: int, n_moments: int
) -> MovingWorld:
    """Generate a floor, and ``n_moments`` maps of it at ``RATE``."""
    rng = np.random.default_rng(seed)
    floor = make_floor(rng)
    people = np.stack([_walk(rng, floor, n_moments) for _ in range(PEOPLE)], axis=1)
    is_open = np.stack([_openings(rng, n_moments) for _ in floor.doors], axis=1)
    middles = np.array([door.middle for door in floor.doors])
    away = np.linalg.norm(people[:, :, np.newaxis] - middles, axis=3).min(axis=1)
    return MovingWorld(floor, is_open | (away < REACH), people)


def place_in(rng: np.random.Generator, rect: Rect) -> Floats:
    """Return a random point (2,) of a rectangle [m]."""
    point: Floats = rng.uniform((rect.left, rect.bottom), (rect.right, rect.top))
    return point


def _solid() -> Bools:
    return np.ones((round(HEIGHT / RESOLUTION), round(WIDTH / RESOLUTION)), dtype=bool)


def _inside(rect: Rect, by: float) -> Rect:
    """Return the rectangle with every side moved inwards by ``by`` [m]."""
    return Rect(rect.left + by, rect.bottom + by, rect.right - by, rect.top - by)


def _cuts(rng: np.random.Generator, length: float, n_pieces: int) -> list[float]:
    """Return where pieces of about the same length begin, and where the last one ends [m]."""
    inner = np.arange(1, n_pieces) + rng.uniform(-0.2, 0.2, n_pieces - 1)
    cuts = [0.0, *(length * inner / n_pieces).tolist(), length]
    return [round(cut / RESOLUTION) * RESOLUTION for cut in cuts]


def _door(rng: np.random.Generator, room: Rect, other: Rect) -> Rect | None:
    """Return a door at a random place in the wall to the room on the right or above, if any."""
    beside = abs(other.left - room.right - WALL) < RESOLUTION
    above = abs(other.bottom - room.top - WALL) < RESOLUTION
    if not (beside or above):
        return None
    first, last = (room.bottom, room.top) if beside else (room.left, room.right)
    other_first, other_last = (other.bottom, other.top) if beside else (other.left, other.right)
    low, high = max(first, other_first) + CORNER, min(last, other_last) - CORNER - DOOR
    if low > high:
        return None
    at = rng.uniform(low, high)
    if beside:
        return Rect(room.right, at, other.left, at + DOOR)
    return Rect(at, room.top, at + DOOR, other.bottom)


def _openings(rng: np.random.Generator, n_moments: int) -> Bools:
    """Return at which moments (n,) a door is open by itself."""
    is_open = np.empty(n_moments, dtype=bool)
    state, moment = bool(rng.uniform() < OPEN / (OPEN + CLOSED)), 0
    while moment < n_moments:
        end = moment + 1 + int(RATE * rng.exponential(OPEN if state else CLOSED))
        is_open[moment:end] = state
        state, moment = not state, end
    return is_open


def _walk(rng: np.random.Generator, floor: Floor, n_moments: int) -> Floats:
    """Return where a person is at each moment (n, 2) [m]."""
    place = int(rng.integers(len(floor.places)))
    track = [place_in(rng, floor.places[place])]
    while len(track) < n_moments:
        ways = [way for way in floor.ways if place in way[:2]]
        if ways:
            first, last, between = ways[rng.integers(len(ways))]
            for point in between:
                _go(track, point)
            place = last if place == first else first
        _go(track, place_in(rng, floor.places[place]))
        track += [track[-1]] * int(RATE * rng.uniform(0.0, STANDING))
    return np.array(track[:n_moments])


def _go(track: list[Floats], to: Floats) -> None:
    """Add the way to a point, straight from where a track ends."""
    begin = track[-1]
    n_steps = 1 + int(np.linalg.norm(to - begin) * RATE / SPEED)
    track += [begin + (to - begin) * step / n_steps for step in range(1, n_steps + 1)]
