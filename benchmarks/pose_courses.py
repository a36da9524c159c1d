"""Courses for a robot that is not round: maps with held-out pairs of poses, doors, bays, slots."""

from __future__ import annotations

import math
from typing import NamedTuple

from benchmarks.problems import Floats, Problem
from hnr_planner.core import GridSpace, PoseSpace
from hnr_planner.maps import building
import numpy as np
from numpy.typing import NDArray

#: The robot [m]: .9 m by .6 m, and the least turning radius of the car.
FOOTPRINT = ((-0.35, -0.3), (0.55, -0.3), (0.55, 0.3), (-0.35, 0.3))
RADIUS = 1.0
#: Robot maps of the other sections that take part, with the least distance of start and goal of a
#: random pair [m]; that distance in generated buildings, and their seeds.
MAPS = {'office': 5.0, 'depot': 5.0, 'intel-lab': 5.0, 'tb3_sandbox': 2.5}
APART, BUILDINGS = 5.0, (3, 4)
#: Widths of doors and bays, and lengths of slots [m].
DOORS, BAYS, SLOTS = (1.0, 0.8, 0.65), (1.0, 0.8, 0.65), (1.6, 1.4, 1.2)
#: Seed of the pairs: one that no setting of a planner was chosen on.
SEED = 20161
RESOLUTION = 0.05


class PoseCourse(NamedTuple):
    """A map, and requests (k, 2, 3): start and goal of each [m, m, rad]."""

    name: str
    grid: GridSpace
    requests: Floats

    def space(self, drive: str) -> PoseSpace:
        """Return the poses of the robot with a drive."""
        radius = RADIUS if drive == 'car' else 0.0
        return PoseSpace(self.grid, FOOTPRINT, drive=drive, min_turning_radius=radius)


def pose_courses(problems: list[Problem], n_pairs: int) -> list[PoseCourse]:
    """Return all courses, with a number of random pairs on each map."""
    grids = {problem.name: problem.space for problem in problems if problem.name in MAPS}
    for seed in BUILDINGS:
        made = building(seed)
        grids[f'building {seed}'] = GridSpace.from_occupancy(made.data, made.resolution)
    return [
        *(
            PoseCourse(name, grid, _pairs(grid, n_pairs, MAPS.get(name, APART)))
            for name, grid in grids.items()
        ),
        *(_door(width) for width in DOORS),
        *(_bay(width) for width in BAYS),
        *(_slot(length) for length in SLOTS),
    ]


def _pairs(grid: GridSpace, n: int, apart: float) -> Floats:
    """
    Return pairs of free poses (n, 2, 3) that the robot's disc joins, at least ``apart`` [m] apart.

    They are uniform among those.
    """
    space, rng = PoseSpace(grid, FOOTPRINT), np.random.default_rng(SEED)
    lower, upper = space.bounds
    found: list[tuple[Floats, Floats]] = []
    while len(found) < n:
        poses = rng.uniform(lower, upper, (2000, 3))
        poses = poses[space.contains(poses)]
        found += [
            (a, b)
            for a, b in zip(poses[::2], poses[1::2], strict=False)
            if math.dist(a[:2], b[:2]) >= apart
            and space.disc.space.connected(space.disc.place(a), space.disc.place(b))
        ]
    return np.array(found[:n])


def _course(name: str, blocked: NDArray[np.bool_], start: Floats, goal: Floats) -> PoseCourse:
    grid = GridSpace.from_blocked(blocked, RESOLUTION)
    return PoseCourse(name, grid, np.array([[start, goal]]))


def _door(width: float) -> PoseCourse:
    """Return two rooms of 4 m by 4 m with a door in the wall between them."""
    blocked = np.zeros((80, 164), dtype=bool)
    blocked[:, 80:84] = True
    first = 40 - round(width / 2.0 / RESOLUTION)
    end = first + round(width / RESOLUTION)
    blocked[first:end, 80:84] = False
    start, goal = np.array([1.0, 0.8, 0.0]), np.array([7.2, 3.2, math.pi / 2.0])
    return _course(f'door {width:g}', blocked, start, goal)


def _bay(width: float) -> PoseCourse:
    """Return a street with a bay at a right angle to it, that the car backs into."""
    blocked = np.zeros((60, 160), dtype=bool)
    blocked[:20] = True
    end = 68 + round(width / RESOLUTION)
    blocked[:20, 68:end] = False
    goal = np.array([3.4 + width / 2.0, 0.45, math.pi / 2.0])
    return _course(f'bay {width:g}', blocked, np.array([1.2, 2.0, 0.0]), goal)


def _slot(length: float) -> PoseCourse:
    """Return a street with a slot along it, .75 m deep."""
    blocked = np.zeros((60, 160), dtype=bool)
    blocked[:15] = True
    end = 68 + round(length / RESOLUTION)
    blocked[:15, 68:end] = False
    goal = np.array([3.3 + length / 2.0, 0.36, 0.0])
    return _course(f'slot {length:g}', blocked, np.array([1.2, 1.5, 0.0]), goal)
