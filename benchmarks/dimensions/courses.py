"""
Problems in n dimensions: cubes among balls, walls with a hole, an arm in the plane.

Every instance has obstacles of its own and one request, which the straight segment does not solve.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import count, pairwise
import math
from typing import NamedTuple, Protocol

from benchmarks.problems import Floats
from hnr_planner.core import BallSpace, BoxSpace, DifferenceSpace, OracleSpace, Space
from numba import njit
import numpy as np
from numpy.typing import NDArray

Truths = NDArray[np.bool_]

#: Distance between the points at which a path among solids is judged.
SPACING = 1e-3
#: Joints of the arm, and the distance [rad] at which its motions are tested, by everybody.
LINKS, RESOLUTION = 7, 0.05
#: Discs around the arm, their least and largest radius, and their distance from its base.
DISCS, DISC_RADII, DISC_DISTANCES = 6, (0.05, 0.12), (0.35, 0.95)
#: Half of a wall's thickness.
HALF_WALL = 0.05
#: Largest distance by which a point of the arm moves from a tested point of a motion half the way
#: to the next: the joints turn parts of the arm that are up to 1, 2, ... links long.
GRAZE = 0.5 * RESOLUTION * math.sqrt(sum((k / LINKS) ** 2 for k in range(1, LINKS + 1)))
#: Least distance of start and goal, as a fraction of the diagonal of the box.
APART = 0.3


class Course(Protocol):
    """Free space, as ours, as OMPL's program reads it, and as the judge tests it."""

    def space(self) -> Space:
        """Return the space of ours."""

    def words(self) -> str:
        """Return the line that describes the space to OMPL's program."""

    def free(self, points: Floats) -> Truths:
        """Return which of ``points`` (k, dim) are free, (k,) bool."""

    def is_path_free(self, path: Floats) -> bool:
        """Return whether a path (m, dim) is free, from points close together."""

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,) of a box around the free points."""


class Instance(NamedTuple):
    """A course, and the request (2, dim) on it: start and goal."""

    course: Course
    request: Floats


class Solids(NamedTuple):
    """The unit cube without closed boxes (k, 2, dim) and closed balls (k, dim + 1)."""

    dim: int
    boxes: Floats
    balls: Floats

    def space(self) -> Space:
        """Return the space of ours."""
        removed = [*(BoxSpace(*corners) for corners in self.boxes)]
        return DifferenceSpace(
            BoxSpace(*self.bounds),
            *removed,
            *(BallSpace(ball[:-1], ball[-1]) for ball in self.balls),
        )

    def words(self) -> str:
        """Return the line that describes the space to OMPL's program."""
        numbers = [*self.bounds[0], *self.bounds[1], len(self.boxes), *self.boxes.ravel()]
        return in_words('solids', self.dim, *numbers, len(self.balls), *self.balls.ravel())

    def free(self, points: Floats) -> Truths:
        """Return which of ``points`` (k, dim) are free, (k,) bool."""
        free = ((points > 0.0) & (points < 1.0)).all(axis=1)
        for lower, upper in self.boxes:
            free &= ~((points >= lower) & (points <= upper)).all(axis=1)
        for ball in self.balls:
            free &= np.linalg.norm(points - ball[:-1], axis=1) > ball[-1]
        return free

    def is_path_free(self, path: Floats) -> bool:
        """Return whether a path (m, dim) is free, from points close together."""
        return bool(self.free(points_along(path, SPACING)).all())

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,) of the cube."""
        return np.zeros(self.dim), np.ones(self.dim)


class Arm(NamedTuple):
    """An arm of ``LINKS`` links, 1 long, that may not touch discs (k, 3); joints turn freely."""

    discs: Floats

    def space(self) -> Space:
        """Return the space of ours, which tests points only."""
        return OracleSpace(arm_is_free(self.discs), *self.bounds, resolution=RESOLUTION)

    def words(self) -> str:
        """Return the line that describes the space to OMPL's program."""
        return in_words('arm', LINKS, RESOLUTION, len(self.discs), *self.discs.ravel())

    def free(self, points: Floats, graze: float = 0.0) -> Truths:
        """
        Return which of ``points`` (k, LINKS) are free, (k,) bool.

        A disc may be touched up to the depth ``graze``.
        """
        headings = np.cumsum(points, axis=1)
        links = np.stack([np.cos(headings), np.sin(headings)], axis=2) / LINKS
        bases = np.cumsum(links, axis=1) - links
        free = (np.abs(points) < math.pi).all(axis=1)
        for disc in self.discs:
            offsets = disc[:2] - bases
            along = np.clip((offsets * links).sum(axis=2) * LINKS**2, 0.0, 1.0)
            away = np.linalg.norm(offsets - along[..., np.newaxis] * links, axis=2)
            free &= (away > disc[2] - graze).all(axis=1)
        return free

    def is_path_free(self, path: Floats) -> bool:
        """
        Return whether a path (m, LINKS) is free, from points close together.

        Nobody sees discs that are touched less deeply than ``GRAZE`` between two tests.
        """
        return bool(self.free(points_along(path, RESOLUTION), GRAZE).all())

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,) of the joint angles."""
        return np.full(LINKS, -math.pi), np.full(LINKS, math.pi)


def in_words(name: str, *numbers: float) -> str:
    """Return a command of OMPL's program with its numbers."""
    return ' '.join([name, *(f'{number:.17g}' for number in numbers)])


def arm_is_free(discs: Floats) -> Callable[[Floats], bool]:
    """Return the function of the joint angles (LINKS,) of an arm among ``discs`` (k, 3)."""
    length = 1.0 / LINKS

    @njit(nogil=True)
    def is_free(angles):
        x, y, heading = 0.0, 0.0, 0.0
        for i in range(len(angles)):
            heading += angles[i]
            ux, uy = length * math.cos(heading), length * math.sin(heading)
            for k in range(len(discs)):
                dx, dy = discs[k, 0] - x, discs[k, 1] - y
                along = min(1.0, max(0.0, (dx * ux + dy * uy) / (length * length)))
                ox, oy = dx - along * ux, dy - along * uy
                if ox * ox + oy * oy <= discs[k, 2] * discs[k, 2]:
                    return False
            x += ux
            y += uy
        return True

    return is_free  # type: ignore[no-any-return]


def cube_among_balls(n_balls: int, radius: float, rng: np.random.Generator) -> Solids:
    """Return the 6-D cube without balls of one radius at uniform centres."""
    centres = rng.random((n_balls, 6))
    balls = np.column_stack([centres, np.full(n_balls, radius)])
    return Solids(6, np.empty((0, 2, 6)), balls)


def wall_with_hole(dim: int, hole: float, n_narrow: int, rng: np.random.Generator) -> Solids:
    """
    Return a cube halved by a wall with a hole, ``hole`` wide in ``n_narrow`` coordinates.

    The wall is made of two boxes for each of these coordinates, on both sides of the hole.
    """
    corner = rng.uniform(0.1, 0.9 - hole, n_narrow)
    walls = []
    for axis in range(1, n_narrow + 1):
        for below in (True, False):
            lower, upper = np.full(dim, -1.0), np.full(dim, 2.0)
            lower[0], upper[0] = 0.5 - HALF_WALL, 0.5 + HALF_WALL
            if below:
                upper[axis] = corner[axis - 1]
            else:
                lower[axis] = corner[axis - 1] + hole
            walls.append((lower, upper))
    return Solids(dim, np.array(walls), np.empty((0, dim + 1)))


def arm_among_discs(rng: np.random.Generator) -> Arm:
    """Return the arm among discs, none of which reaches its base."""
    distances, angles = rng.uniform(*DISC_DISTANCES, DISCS), rng.uniform(-np.pi, np.pi, DISCS)
    centres = distances[:, np.newaxis] * np.column_stack([np.cos(angles), np.sin(angles)])
    return Arm(np.column_stack([centres, rng.uniform(*DISC_RADII, DISCS)]))


#: The problems by name: each makes a course from random numbers.
PROBLEMS: dict[str, Callable[[np.random.Generator], Course]] = {
    '6-D, 30 balls': partial(cube_among_balls, 30, 0.75),
    '6-D, 150 balls': partial(cube_among_balls, 150, 0.5),
    '3-D, hole of .3': partial(wall_with_hole, 3, 0.3, 2),
    '3-D, hole of .1': partial(wall_with_hole, 3, 0.1, 2),
    '6-D, hole of .3': partial(wall_with_hole, 6, 0.3, 5),
    '6-D, hole of .1': partial(wall_with_hole, 6, 0.1, 2),
    'arm of 7 links': arm_among_discs,
}


def instances(name: str, first_seed: int) -> Iterator[Instance]:
    """Yield instances of a problem, with the seeds from ``first_seed`` on."""
    for seed in count(first_seed):
        rng = np.random.default_rng([seed, *name.encode()])
        course = PROBLEMS[name](rng)
        request = _request(course, rng)
        if request is not None:
            yield Instance(course, request)


def _request(course: Course, rng: np.random.Generator) -> Floats | None:
    """Return start and goal (2, dim) that the straight segment does not join; None if unlucky."""
    lower, upper = course.bounds
    pair = rng.uniform(lower, upper, (2, len(lower)))
    far = np.linalg.norm(pair[1] - pair[0]) > APART * np.linalg.norm(upper - lower)
    if isinstance(course, Solids) and len(course.boxes):
        far = bool(far and pair[0, 0] < 0.5 < pair[1, 0])
    if not far or not course.free(pair).all() or course.is_path_free(pair):
        return None
    return pair


def points_along(path: Floats, spacing: float) -> Floats:
    """Return points (k, dim) of a path (m, dim): its vertices, and some at most this far apart."""
    rows = [path[:1]]
    for a, b in pairwise(path):
        n = max(1, math.ceil(np.linalg.norm(b - a) / spacing))
        rows.append(a + np.linspace(0.0, 1.0, n + 1)[1:, np.newaxis] * (b - a))
    return np.concatenate(rows)
