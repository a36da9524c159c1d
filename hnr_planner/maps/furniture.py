"""
Furnish a floor plan: desks, chairs, shelves, tables, columns and clutter.

No two groups of furniture are closer than ``GAP``, a group is at a wall or at least ``GAP`` from
it, and the areas around doors stay free: so no room is ever cut in two.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from hnr_planner.maps.floor_plan import (
    CELL,
    fill,
    fill_disc,
    FloorPlan,
    Rect,
    Room,
    SOLID,
)
import numpy as np

#: Least distance between groups [m], and from the free area around a door [m].
GAP = 0.7
DOOR_GAP = 0.3
#: Radius of a leg [m].
LEG = 0.035


class Disc(NamedTuple):
    """Round object: its centre (x, y) and its radius [m]."""

    x: float
    y: float
    radius: float


class Group(NamedTuple):
    """Objects that stand together, and the rectangle around all of them [m]."""

    outline: Rect
    things: tuple[Rect | Disc, ...]


#: Function that makes a group with its back along y = 0.
Maker = Callable[[np.random.Generator], Group]
#: Function from a point to a point.
Placer = Callable[[float, float], tuple[float, float]]


def furnish(rng: np.random.Generator, plan: FloorPlan) -> None:
    """
    Put random furniture into every room and corridor, by making cells of the material solid.

    The plan's material is changed in place. A group that does not fit is left out.
    """
    placed = [apron.grown(DOOR_GAP - GAP) for apron in plan.aprons]
    for room in plan.rooms:
        for group in _proposals(rng, room):
            if _fits(group.outline, room.rect, placed):
                placed.append(group.outline)
                _draw(plan, group)


def _fits(outline: Rect, room: Rect, placed: list[Rect]) -> bool:
    gaps = (
        outline.left - room.left,
        outline.bottom - room.bottom,
        room.right - outline.right,
        room.top - outline.top,
    )
    # Opposite walls must leave a way past: a group that reaches both would be a partition.
    leaves_way = max(gaps[0], gaps[2]) >= GAP and max(gaps[1], gaps[3]) >= GAP
    at_wall_or_away = all(abs(gap) < 2 * CELL or gap >= GAP for gap in gaps)
    crowded = any(outline.grown(GAP).meets(other) for other in placed)
    return leaves_way and at_wall_or_away and not crowded


def _draw(plan: FloorPlan, group: Group) -> None:
    for thing in group.things:
        if isinstance(thing, Disc):
            fill_disc(plan.material, *thing, SOLID)
        else:
            fill(plan.material, thing, SOLID)


def _proposals(rng: np.random.Generator, room: Room) -> list[Group]:
    """
    Return random furniture for a room, already placed, in the order in which to try it.

    The groups may overlap each other: which of them fit is decided later.
    """
    left, bottom, right, top = room.rect
    area = (right - left) * (top - bottom)
    if room.kind == 'corridor':
        return [_at_wall(rng, room.rect, _cabinet) for _ in range(round(area / 6))]
    groups = [_at_wall(rng, room.rect, _pillar) for _ in range(2)]
    if room.kind == 'hall':
        groups += _columns(room.rect)
        groups += [_inside(rng, room.rect, _island) for _ in range(150)]
        groups += [_at_wall(rng, room.rect, _shelf) for _ in range(15)]
    elif room.kind == 'meeting':
        groups.append(_conference(room.rect))
        groups += [_inside(rng, room.rect, _small_table) for _ in range(12)]
        groups += [_at_wall(rng, room.rect, _shelf) for _ in range(4)]
    elif room.kind == 'storage':
        groups += [_at_wall(rng, room.rect, _shelf) for _ in range(40)]
    else:
        groups += [_at_wall(rng, room.rect, _desk) for _ in range(16)]
        groups += [_at_wall(rng, room.rect, _shelf) for _ in range(10)]
    groups += [_inside(rng, room.rect, _clutter) for _ in range(round(area / 4))]
    return groups


def _desk(rng: np.random.Generator) -> Group:
    """Return a desk along the x axis with its back at y = 0, and a chair on its other side."""
    length, depth = rng.uniform(1.3, 1.8), rng.uniform(0.7, 0.8)
    seat = rng.uniform(0.4, length - 0.4), depth + rng.uniform(0.1, 0.25)
    outline = Rect(0, 0, length, seat[1] + 0.25)
    if rng.random() < 0.5:
        return Group(outline, (Rect(0, 0, length, depth), *_chair(*seat)))
    drawers, panel = Rect(0, 0, 0.45, depth), Rect(0, 0, length, 0.05)
    leg = Disc(length - 0.1, depth - 0.1, LEG)
    return Group(outline, (drawers, panel, leg, *_chair(*seat)))


def _chair(x: float, y: float) -> tuple[Disc, ...]:
    """Return the parts of an office chair that a laser sees: a post and four castors."""
    castors = ((-0.2, 0.0), (0.2, 0.0), (0.0, -0.2), (0.0, 0.2))
    return (Disc(x, y, LEG), *(Disc(x + dx, y + dy, LEG) for dx, dy in castors))


def _shelf(rng: np.random.Generator) -> Group:
    shelf = Rect(0, 0, rng.uniform(0.8, 2.4), rng.uniform(0.35, 0.5))
    return Group(shelf, (shelf,))


def _pillar(rng: np.random.Generator) -> Group:
    pillar = Rect(0, 0, rng.uniform(0.3, 0.5), rng.uniform(0.15, 0.3))
    return Group(pillar, (pillar,))


def _cabinet(rng: np.random.Generator) -> Group:
    cabinet = Rect(0, 0, rng.uniform(0.6, 1.2), rng.uniform(0.3, 0.45))
    return Group(cabinet, (cabinet,))


def _island(rng: np.random.Generator) -> Group:
    """
    Return a block of two rows of desks back to back, with chairs on its two long sides.

    A row has one or two desks along the x axis, or with probability 0.5 along the y axis.
    """
    length, depth = rng.integers(1, 3) * 1.6, 1.5
    seats = np.arange(0.8, length, 1.6)
    chairs = [
        part
        for x in seats
        for y in (0.25, depth + 0.55)
        for part in _chair(x + rng.uniform(-0.2, 0.2), y)
    ]
    desks = Rect(0, 0.4, length, 0.4 + depth)
    outline = Rect(0, 0, length, depth + 0.8)
    group = Group(outline, (desks, *chairs))
    return _turned(group) if rng.random() < 0.5 else group


def _clutter(rng: np.random.Generator) -> Group:
    """Return one small disc of random radius: a plant, a bin or a stool."""
    radius = 0.03 + 0.2 * rng.random() ** 3
    return Group(Rect(0, 0, 2 * radius, 2 * radius), (Disc(radius, radius, radius),))


def _conference(room: Rect) -> Group:
    """Return a table with chairs in the middle of a room, along its longer side."""
    left, bottom, right, top = room
    group = _table(max(right - left, top - bottom) - 2 * (GAP + 0.5), 1.2)
    group = _turned(group) if top - bottom > right - left else group
    width, height = group.outline.right, group.outline.top
    return _moved(group, (left + right - width) / 2, (bottom + top - height) / 2)


def _small_table(rng: np.random.Generator) -> Group:
    group = _table(rng.uniform(1.4, 2.2), 0.8)
    return _turned(group) if rng.random() < 0.5 else group


def _table(length: float, depth: float) -> Group:
    """Return the legs of a table along the x axis, and chairs on its two long sides."""
    legs = [Disc(x, y, 0.06) for x in (0.2, length / 2, length - 0.2) for y in (0.6, depth + 0.3)]
    chairs = [
        part
        for x in np.arange(0.5, length - 0.3, 0.8)
        for y in (0.25, depth + 0.65)
        for part in _chair(x, y)
    ]
    return Group(Rect(0, 0, length, depth + 0.9), (*legs, *chairs))


def _columns(room: Rect) -> list[Group]:
    """Return the eight round columns that carry the roof of a hall."""
    left, bottom, right, top = room
    middles = [
        (left + across * (right - left), bottom + up * (top - bottom))
        for across in (0.3, 0.75)
        for up in (0.12, 0.37, 0.63, 0.88)
    ]
    radius = 0.3
    return [Group(Rect(x, y, x, y).grown(radius), (Disc(x, y, radius),)) for x, y in middles]


def _at_wall(rng: np.random.Generator, room: Rect, make: Maker) -> Group:
    """Return a new group with its back to a random wall of the room, at a random place there."""
    group = make(rng)
    wall = rng.integers(4)
    if wall % 2:
        group = _turned(group)
    if wall >= 2:
        group = _mirrored(group)
    left, bottom, right, top = room
    width, height = group.outline.right, group.outline.top
    x = left + _slide(rng, right - left - width)
    y = bottom + _slide(rng, top - bottom - height)
    if wall % 2:
        x = left if wall == 1 else right - width
    else:
        y = bottom if wall == 0 else top - height
    return _moved(group, x, y)


def _slide(rng: np.random.Generator, space: float) -> float:
    """
    Return a random position [m] along a wall, from 0 to ``space``.

    A position closer than ``GAP`` to either end becomes that end, so that no gap is left.
    """
    place = rng.random() * space
    if place < GAP:
        return 0.0
    return space if space - place < GAP else place


def _inside(rng: np.random.Generator, room: Rect, make: Maker) -> Group:
    """Return a new group at a random place in a room."""
    group = make(rng)
    left, bottom, right, top = room
    x = left + rng.random() * (right - left - group.outline.right)
    y = bottom + rng.random() * (top - bottom - group.outline.top)
    return _moved(group, x, y)


def _moved(group: Group, x: float, y: float) -> Group:
    return _mapped(group, lambda px, py: (px + x, py + y))


def _turned(group: Group) -> Group:
    """Return the group with x and y swapped, so that its back is at x = 0 instead of y = 0."""
    return _mapped(group, lambda px, py: (py, px))


def _mirrored(group: Group) -> Group:
    """Return the group after half a turn in its outline: its back is on the opposite side."""
    right, top = group.outline.right, group.outline.top
    return _mapped(group, lambda px, py: (right - px, top - py))


def _mapped(group: Group, place: Placer) -> Group:
    def mapped(thing: Rect) -> Rect:
        (x0, y0), (x1, y1) = place(thing.left, thing.bottom), place(thing.right, thing.top)
        return Rect(min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1))

    things = tuple(
        Disc(*place(thing.x, thing.y), thing.radius) if isinstance(thing, Disc) else mapped(thing)
        for thing in group.things
    )
    return Group(mapped(group.outline), things)
