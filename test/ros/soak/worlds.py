"""Maps and requests of the load: rooms whose doors move, a cell without one, bad requests."""

from __future__ import annotations

from collections.abc import Iterator
import math
from test.ros.harness import maze, pose
from test.ros.soak.judge import World

from nav_msgs.srv import GetPlan
import numpy as np

RESOLUTION = 0.1

#: Cells along a side: 8 m.
SIDE = 80

#: Part of the requests that cannot be answered with a path.
BAD = 0.1


def rooms(door: int = 0) -> World:
    """Return four rooms; their doors are at one of ten places. In a corner, a cell has none."""
    data = np.zeros((SIDE, SIDE), dtype=np.int8)
    middle = SIDE // 2
    data[middle, :] = data[:, middle] = 100
    for first in (0, middle + 1):
        cells = first + 4 + 3 * (door % 10) + np.arange(3)
        data[middle, cells] = data[cells, middle] = 0
    data[4:12, 4:12] = 100
    data[5:11, 5:11] = 0
    return World(data, RESOLUTION)


def hall(moment: int = 0) -> World:
    """
    Return a hall with an island, and one cell without a door in a corner.

    The ways around the island grow narrow in turns, so that the shorter one changes with each
    moment; and somebody walks along its far side.
    """
    data = np.zeros((SIDE, SIDE), dtype=np.int8)
    data[30:50, 30:50] = 100
    wider = slice(50, 52) if moment % 2 == 0 else slice(28, 30)
    data[wider, 30:50] = 100
    person = 20 + moment % 40
    data[70:74, person:][:, :4] = 100
    data[4:12, 4:12] = 100
    data[5:11, 5:11] = 0
    return World(data, RESOLUTION)


def across(number: int) -> GetPlan.Request:
    """Return the request of a client from the left of the island in the hall to the right."""
    y = SIDE * RESOLUTION / 2.0 + 0.01 * number
    return plan_request((1.5, y), (6.5, y))


def plan_request(
    start: tuple[float, float],
    goal: tuple[float, float],
    *,
    yaw: float = 0.0,
    tolerance: float = 0.0,
    frame: str = 'map',
) -> GetPlan.Request:
    """Return a request."""
    ends = pose(*start, frame), pose(*goal, frame, yaw)
    return GetPlan.Request(start=ends[0], goal=ends[1], tolerance=float(tolerance))


def requests(rng: np.random.Generator, count: int) -> Iterator[GetPlan.Request]:
    """Yield random requests in the rooms; one in ten of them is bad, each in one of five ways."""
    for _ in range(count):
        start, goal = (
            tuple(rng.uniform(1.3, 3.9, 2) + 4.1 * rng.integers(2, size=2)) for _ in 'sg'
        )
        if rng.random() >= BAD:
            yield plan_request(start, goal, yaw=rng.uniform(-4.0, 4.0))
            continue
        yield (
            plan_request((math.nan, 1.0), goal),
            plan_request(start, goal, tolerance=-1.0),
            plan_request(start, goal, frame='nowhere'),
            plan_request(start, (-1.0, 9.0)),
            plan_request(start, (0.75, 0.75)),
        )[rng.integers(5)]


#: A map on which no search gets from START to END in the time of a test.
LONG = maze()

START, END = (0.025, 0.025), (20.025, 20.025)
