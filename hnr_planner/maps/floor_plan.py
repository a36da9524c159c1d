"""
Generate the geometry of an office floor: rooms, corridors, doors and windows.

Two long corridors and a cross corridor run around a core of inner rooms and end in a hall;
rooms of different sizes line the corridors. Coordinates are in metres: (0, 0) is the building's
lower left (south-west) corner, x grows to the east and y to the north.
"""

from __future__ import annotations

from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

#: Sides of the building, and thickness of its walls [m].
WIDTH, HEIGHT = 40.0, 25.0
OUTER_WALL, INNER_WALL = 0.3, 0.15
#: Side of a cell of the material grid [m]; it is finer than the map that a survey draws of it.
CELL = 0.025
#: Materials.
AIR, SOLID, GLASS = 0, 1, 2
#: Least and largest width of a door [m], and depth of the area that stays free on both sides [m].
DOOR_WIDTHS = (0.9, 1.2)
APRON = 1.1


class Rect(NamedTuple):
    """Rectangle with sides along the x and y axes, by the coordinates of its four sides [m]."""

    left: float
    bottom: float
    right: float
    top: float

    def grown(self, by: float) -> Rect:
        """Return the rectangle with every side moved outwards by ``by`` [m]."""
        return Rect(self.left - by, self.bottom - by, self.right + by, self.top + by)

    def meets(self, other: Rect) -> bool:
        """Return whether the two rectangles have a point in common; their sides belong to them."""
        return (
            self.left <= other.right
            and other.left <= self.right
            and self.bottom <= other.top
            and other.bottom <= self.top
        )


class Room(NamedTuple):
    """
    Room or corridor: its use, and the rectangle between its walls [m].

    ``kind`` is office, meeting, storage, hall or corridor.
    """

    kind: str
    rect: Rect


class FloorPlan(NamedTuple):
    """
    Rooms and corridors, areas that stay free around doorways, and the material of every cell.

    ``material`` is (rows, cols) of AIR, SOLID and GLASS (0, 1, 2), in cells of side ``CELL``:
    row 0 lies along y = 0, and column 0 along x = 0.
    """

    rooms: tuple[Room, ...]
    aprons: tuple[Rect, ...]
    material: NDArray[np.uint8]


def draw_floor_plan(rng: np.random.Generator) -> FloorPlan:
    """Generate a random floor plan without furniture, whose rooms can all be entered."""
    corridors, rooms = _layout(rng)
    material = np.full((round(HEIGHT / CELL), round(WIDTH / CELL)), SOLID, np.uint8)
    for room in corridors + rooms:
        fill(material, room.rect, AIR)
    doorways = _doorways(rng, corridors, rooms)
    for doorway in doorways:
        fill(material, doorway, AIR)
        if rng.random() < 0.6:
            fill(material, _leaf(rng, doorway, corridors), SOLID)
    for window in _windows(rng, rooms):
        fill(material, window, GLASS)
    _cut_corner(material, rooms[0].rect, rng.uniform(3.0, 4.0))
    aprons = tuple(_apron(doorway) for doorway in doorways)
    return FloorPlan(tuple(corridors + rooms), aprons, material)


def fill(material: NDArray[np.uint8], rect: Rect, value: int) -> None:
    """Set the material of a rectangle [m], in place; its sides are rounded to whole cells."""
    left, bottom, right, top = (max(0, round(edge / CELL)) for edge in rect)
    material[bottom:top, left:right] = value


def fill_disc(material: NDArray[np.uint8], x: float, y: float, radius: float, value: int) -> None:
    """
    Set the material of a disc around (x, y) [m], in place.

    It is set in the cells whose centres are at most ``radius`` [m] from (x, y).
    """
    around = Rect(x, y, x, y).grown(radius + CELL)
    left, bottom, right, top = (max(0, round(edge / CELL)) for edge in around)
    window = material[bottom:top, left:right]
    rows, columns = np.ogrid[: window.shape[0], : window.shape[1]]
    across, up = (left + columns + 0.5) * CELL - x, (bottom + rows + 0.5) * CELL - y
    window[across * across + up * up <= radius * radius] = value


def _layout(rng: np.random.Generator) -> tuple[list[Room], list[Room]]:
    """Draw a random layout; return the three corridors, and the other rooms, the hall first."""
    aisle = rng.uniform(2.0, 2.4)
    south = OUTER_WALL + rng.uniform(4.8, 5.8)  # where the rooms of the south front end
    north = HEIGHT - OUTER_WALL - rng.uniform(4.8, 5.8)
    west = OUTER_WALL + rng.uniform(4.2, 5.0)
    east = WIDTH - OUTER_WALL - rng.uniform(8.5, 10.0)  # where the hall begins
    lower, upper = south + INNER_WALL, north - INNER_WALL  # outer edges of the long corridors
    cross = west + INNER_WALL  # outer edge of the cross corridor
    end = east - INNER_WALL
    corridors = [
        Room('corridor', Rect(cross, lower, end, lower + aisle)),
        Room('corridor', Rect(cross, upper - aisle, end, upper)),
        Room('corridor', Rect(cross, lower, cross + aisle, upper)),
    ]
    rooms = [Room('hall', Rect(east, OUTER_WALL, WIDTH - OUTER_WALL, HEIGHT - OUTER_WALL))]
    fronts = ((OUTER_WALL, south), (north, HEIGHT - OUTER_WALL))
    for bottom, top in fronts:
        corner = cross + rng.uniform(1.6, 2.4)  # reaches past the corner, for a door
        rooms.append(Room('office', Rect(OUTER_WALL, bottom, corner, top)))
        for left, right in _split(rng, corner + INNER_WALL, end, 2.7, 6.0):
            kind = 'meeting' if right - left > 4.8 else 'office'
            rooms.append(Room(kind, Rect(left, bottom, right, top)))
    for bottom, top in _split(rng, lower, upper, 2.8, 4.5):
        rooms.append(Room('office', Rect(OUTER_WALL, bottom, west, top)))
    rooms += _core(rng, Rect(cross + aisle, lower + aisle, east, upper - aisle))
    return corridors, rooms


def _core(rng: np.random.Generator, walls: Rect) -> list[Room]:
    """
    Return the inner rooms: two rows, back to back.

    ``walls`` [m] is the outer edge of the walls around both rows. One place in each row, not
    the first or the last, has no room: it stays solid, like a shaft.
    """
    inside = walls.grown(-INNER_WALL)
    middle = (inside.bottom + inside.top) / 2 + rng.uniform(-0.8, 0.8)
    rows = ((inside.bottom, middle - INNER_WALL / 2), (middle + INNER_WALL / 2, inside.top))
    rooms = []
    for bottom, top in rows:
        columns = _split(rng, inside.left, inside.right, 2.6, 6.5)
        columns.pop(rng.integers(1, len(columns) - 1))
        for left, right in columns:
            kind = 'storage' if right - left < 4.0 else 'meeting'
            rooms.append(Room(kind, Rect(left, bottom, right, top)))
    return rooms


def _split(
    rng: np.random.Generator, start: float, stop: float, least: float, most: float
) -> list[tuple[float, float]]:
    """
    Cut an interval [m] into rooms with inner walls between them; return their (start, end).

    Widths are from ``least`` to ``most``; only a rest that is too short for two rooms of width
    ``least`` and a wall may be wider.
    """
    pieces = []
    while stop - start > max(most, 2 * least + INNER_WALL):
        longest = min(most, stop - start - INNER_WALL - least)
        end = start + rng.uniform(least, longest)
        pieces.append((start, end))
        start = end + INNER_WALL
    return [*pieces, (start, stop)]


def _doorways(rng: np.random.Generator, corridors: list[Room], rooms: list[Room]) -> list[Rect]:
    """
    Return doorways from rooms to corridors, and a few from room to room.

    A room gets a doorway to the first corridor with which it shares a long enough wall, a hall one
    to each such corridor. Two rooms that share such a wall get a doorway with probability 0.15.
    """
    doorways = []
    for room in rooms:
        found = [_doorway(rng, room.rect, corridor.rect) for corridor in corridors]
        openings = [opening for opening in found if opening]
        keep = len(openings) if room.kind == 'hall' else 1
        doorways += openings[:keep]
    for room, other in combinations(rooms, 2):
        if rng.random() < 0.15 and (opening := _doorway(rng, room.rect, other.rect)):
            doorways.append(opening)
    return doorways


def _doorway(rng: np.random.Generator, room: Rect, other: Rect) -> Rect | None:
    """
    Return an opening of random width and place in the wall that two rooms share.

    It is None where they share no wall, or one that is too short for the opening.
    """
    width = rng.uniform(*DOOR_WIDTHS)
    margin = 0.25
    left, right = max(room.left, other.left), min(room.right, other.right)
    bottom, top = max(room.bottom, other.bottom), min(room.top, other.top)
    need = width + 2 * margin
    if 0 < bottom - top < 2 * INNER_WALL and right - left > need:
        x = rng.uniform(left + margin, right - margin - width)
        return Rect(x, top, x + width, bottom)
    if 0 < left - right < 2 * INNER_WALL and top - bottom > need:
        y = rng.uniform(bottom + margin, top - margin - width)
        return Rect(right, y, left, y + width)
    return None


def _apron(doorway: Rect) -> Rect:
    """
    Return the rectangle around a doorway that furniture leaves free.

    It reaches ``APRON`` from the wall on both sides, and 0.1 m beyond the doorway along the wall.
    """
    left, bottom, right, top = doorway
    if right - left > top - bottom:
        return Rect(left - 0.1, bottom - APRON, right + 0.1, top + APRON)
    return Rect(left - APRON, bottom - 0.1, right + APRON, top + 0.1)


def _leaf(rng: np.random.Generator, doorway: Rect, corridors: list[Room]) -> Rect:
    """
    Return the rectangle of a door's leaf that stands open at a right angle to the wall.

    It stands above or to the right of the wall, or on the other side where it would meet a
    corridor.
    """
    left, bottom, right, top = doorway
    thick = 0.05
    if right - left > top - bottom:
        hinge = left - thick if rng.random() < 0.5 else right
        leaf = Rect(hinge, top, hinge + thick, top + right - left)
        other = Rect(hinge, bottom - (right - left), hinge + thick, bottom)
    else:
        hinge = bottom - thick if rng.random() < 0.5 else top
        leaf = Rect(right, hinge, right + top - bottom, hinge + thick)
        other = Rect(left - (top - bottom), hinge, left, hinge + thick)
    return other if any(leaf.meets(corridor.rect) for corridor in corridors) else leaf


def _cut_corner(material: NDArray[np.uint8], room: Rect, length: float) -> None:
    """
    Make the upper right corner of a room solid, in place, so that a slanting wall cuts it off.

    The wall meets both sides of the room at ``length`` [m] from the corner.
    """
    rows, columns = np.ogrid[: material.shape[0], : material.shape[1]]
    missing = room.right + room.top - (rows + columns + 1) * CELL
    material[(missing < length) & (columns * CELL > room.left)] = SOLID


def _windows(rng: np.random.Generator, rooms: list[Room]) -> list[Rect]:
    """
    Return panes of glass in the outer walls in the south and north.

    A room has at most one in each of the two walls that it touches, each with probability 0.5.
    """
    panes = []
    for room in rooms:
        left, bottom, right, top = room.rect
        outer = ((bottom <= OUTER_WALL, 0.0), (top >= HEIGHT - OUTER_WALL, HEIGHT - OUTER_WALL))
        for is_front, wall in outer:
            if is_front and rng.random() < 0.5:
                pane = rng.uniform(0.8, 1.4)
                x = rng.uniform(left + 0.3, right - 0.3 - pane)
                panes.append(Rect(x, wall, x + pane, wall + OUTER_WALL))
    return panes
