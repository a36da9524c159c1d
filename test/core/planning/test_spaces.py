"""Planning in spaces of every kind, in 1, 2, 3 and 6 dimensions: every path is checked densely."""

from collections.abc import Callable
from functools import cache
from test.core.planning.searches import plan
from test.dense_check import collisions
from test.sweeps import IN_FULL, sweep
from typing import NamedTuple

from hnr_planner.core import (
    ALGORITHMS,
    BallSpace,
    BoxSpace,
    DifferenceSpace,
    GridSpace,
    OracleSpace,
    PlannerStatus,
    PolygonSpace,
    ProductSpace,
    RequestError,
    Roadmap,
    ShearedSpace,
    simplify,
    Space,
    UnionSpace,
)
from numba import njit
import numpy as np
from numpy.typing import NDArray
import pytest
import shapely

pytestmark = pytest.mark.interpreted

#: Planners of every space; ``polyanya`` plans on grids.
NAMES = [name for name in ALGORITHMS if name not in ('auto', 'polyanya')]
#: Between two points of a path that are looked at, in parts of the space's diagonal.
STEP = 1e-4


def diagonal(space: Space) -> float:
    lower, upper = space.bounds
    return float(np.linalg.norm(upper - lower))


class Scene(NamedTuple):
    """
    A space, who says what is free there, two free points, and one that is not.

    And who says what a path may touch: the same, unless the space itself promises less.
    """

    space: Space
    is_free: Callable[[NDArray], NDArray[np.bool_]]
    start: NDArray
    goal: NDArray
    blocked: NDArray
    may_touch: Callable[[NDArray], NDArray[np.bool_]] | None = None

    def collisions(self, path: NDArray) -> list[str]:
        """Return what a path hits."""
        return collisions(path, self.may_touch or self.is_free, STEP * diagonal(self.space))


def balls(dim: int) -> Scene:
    """Return a box with a large ball in its middle and small ones all around."""
    rng = np.random.default_rng(dim)
    centres = rng.uniform(1.0, 9.0, (30, dim))
    centres[0] = 5.0
    radii = np.full(30, 0.8 if dim < 3 else 1.5)
    radii[0] = 3.0 if dim < 3 else 4.0
    start, goal = np.full(dim, 0.5), np.full(dim, 9.5)
    space = DifferenceSpace(
        BoxSpace(np.zeros(dim), np.full(dim, 10.0)),
        *(BallSpace(centre, radius) for centre, radius in zip(centres, radii, strict=True)),
    )

    def is_free(x: NDArray) -> NDArray[np.bool_]:
        away = np.linalg.norm(x[:, None] - centres, axis=2)
        return ((x > 0.0) & (x < 10.0)).all(axis=1) & (away > radii).all(axis=1)

    return Scene(space, is_free, start, goal, centres[0])


def star() -> Scene:
    """Return long thin rays around a star-shaped hole."""
    angles = np.arange(60) * np.pi / 30.0
    radii = np.where(np.arange(60) % 2 == 0, 1.0, 0.25)
    rim, hole = (
        (r * np.stack([np.cos(angles), np.sin(angles)])).T for r in (radii, 0.2 * radii[::-1])
    )

    def is_in(x: NDArray, ring: NDArray) -> NDArray[np.bool_]:
        (ax, ay), (bx, by) = ring.T, np.roll(ring, -1, axis=0).T
        px, py = x[:, :1], x[:, 1:]
        crossed = ax + (py - ay) / (by - ay) * (bx - ax)
        return np.count_nonzero(((ay > py) != (by > py)) & (crossed > px), axis=1) % 2 == 1

    return Scene(
        PolygonSpace(shapely.Polygon(rim, [hole])),
        lambda x: is_in(x, rim) & ~is_in(x, hole),
        0.9 * rim[0] + 0.003,
        0.9 * rim[28] + 0.003,
        np.zeros(2),
    )


def banana() -> Scene:
    """Return a ball in three dimensions, bent until its ends do not see each other."""
    bend = 1.5
    start, goal = np.array([-0.9, 0.0, 0.81 * bend]), np.array([0.9, 0.1, 0.81 * bend])

    def is_free(x: NDArray) -> NDArray[np.bool_]:
        return x[:, 0] ** 2 + x[:, 1] ** 2 + (x[:, 2] - bend * x[:, 0] ** 2) ** 2 < 1.0

    space = ShearedSpace(BallSpace(np.zeros(3), 1.0), bend)
    return Scene(space, is_free, start, goal, np.array([0.0, 0.0, 1.1]))


def lift() -> Scene:
    """Return a wall with a window in the plane, at every height of an interval."""
    ring = shapely.box(0, 0, 4, 3).difference(shapely.box(1.9, 0.2, 2.1, 3))

    def is_free(x: NDArray) -> NDArray[np.bool_]:
        lower, upper = np.array([0.0, 0.0, -1.0]), np.array([4.0, 3.0, 1.0])
        in_wall = (x[:, 0] >= 1.9) & (x[:, 0] <= 2.1) & (x[:, 1] >= 0.2)
        return ((x > lower) & (x < upper)).all(axis=1) & ~in_wall

    space = ProductSpace(PolygonSpace(ring), BoxSpace([-1.0], [1.0]))
    ends = np.array([0.5, 2.5, -0.9]), np.array([3.5, 2.5, 0.9])
    return Scene(space, is_free, *ends, np.array([2.0, 1.0, 0.0]))


def cells() -> Scene:
    """Return cubes that overlap a little: there, aside, back, and up."""
    x, y, z = np.eye(3)
    corners = np.cumsum(np.array([x, x, y, y, -x, -x, z]) * 0.95, axis=0)
    space = UnionSpace(*(BoxSpace(corner, corner + 1.0) for corner in corners))

    def is_free(x: NDArray) -> NDArray[np.bool_]:
        inside = (x[:, None] > corners) & (x[:, None] < corners + 1.0)
        return inside.all(axis=2).any(axis=1)

    hollow = np.array([1.4, 1.4, 0.5])
    return Scene(space, is_free, corners[0] + 0.5, corners[-1] + 0.5, hollow)


@njit
def _is_beside_slit(x):
    return not (abs(x[0]) < 0.1 and abs(x[1] - 0.6) > 0.1)


def slit() -> Scene:
    """
    Return a wall with a slit, of which there is a function only.

    A path may cut its corners, but is nowhere longer in the wall than the resolution: so no point
    of it is deeper in the wall than half of that.
    """
    resolution = 0.02

    def is_free(x: NDArray, depth: float = 0.0) -> NDArray[np.bool_]:
        in_wall = (np.abs(x[:, 0]) < 0.1 - depth) & (np.abs(x[:, 1] - 0.6) > 0.1 + depth)
        return (np.abs(x) < 1.0).all(axis=1) & ~in_wall

    space = OracleSpace(_is_beside_slit, -np.ones(3), np.ones(3), resolution=resolution)
    ends = np.full(3, -0.7), np.full(3, 0.7)
    return Scene(space, is_free, *ends, np.zeros(3), lambda x: is_free(x, resolution / 2.0))


def tables() -> Scene:
    """Return a map in metres, turned by a quarter, without two tables."""
    blocked = np.zeros((20, 30), dtype=bool)
    blocked[:14, 10], blocked[6:, 20] = True, True
    hall = GridSpace.from_blocked(blocked, 0.5, (0.0, 0.0, np.pi / 2))
    boxes = np.array([[-8.0, 6.0, -7.0, 9.0], [-3.0, 11.0, -1.0, 12.0]])
    space = DifferenceSpace(hall, PolygonSpace(shapely.MultiPolygon(shapely.box(*boxes.T))))

    def is_free(x: NDArray) -> NDArray[np.bool_]:
        # The map's x runs up the page, its y to the left.
        columns, rows = np.floor(x[:, 1] / 0.5).astype(int), np.floor(-x[:, 0] / 0.5).astype(int)
        inside = (columns >= 0) & (columns < 30) & (rows >= 0) & (rows < 20)
        free = inside & ~blocked[np.clip(rows, 0, 19), np.clip(columns, 0, 29)]
        on_table = (x[:, None] >= boxes[:, :2]) & (x[:, None] <= boxes[:, 2:])
        return free & ~on_table.all(axis=2).any(axis=1)

    return Scene(space, is_free, *np.array([[-1.0, 1.0], [-9.0, 14.0], [-7.5, 7.0]]))


SCENES = {
    'balls, 2-D': cache(lambda: balls(2)),
    'balls, 3-D': cache(lambda: balls(3)),
    'balls, 6-D': cache(lambda: balls(6)),
    'star': cache(star),
    'banana': cache(banana),
    'lift': cache(lift),
    'cells': cache(cells),
    'slit': cache(slit),
    'tables': cache(tables),
}
#: Seeds of the searches; interpreted, one of them takes less time than the kernels to compile.
SEEDS = range(3) if IN_FULL else range(1)
EVERY_PLANNER = ('balls, 2-D', 'balls, 3-D', 'balls, 6-D', 'star')
#: Of these, what every planner does is a sweep.
FURTHER = ('balls, 2-D', 'balls, 6-D', 'star')


@pytest.mark.parametrize('name', SCENES)
def test_scenes_are_what_they_are_said_to_be(name: str):
    """Who judges the paths agrees with the space on many points, and on none by accident."""
    space, is_free, start, goal, blocked, _ = SCENES[name]()
    lower, upper = space.bounds
    points = np.random.default_rng(1).uniform(lower, upper, (4_000, space.dim))
    free = is_free(points)
    assert space.contains(points).tolist() == free.tolist()
    assert free.any() and not free.all()
    assert is_free(np.array([start, goal, blocked])).tolist() == [True, True, False]
    assert not space.is_motion_valid(start, goal)


@pytest.mark.parametrize('seed', range(6))
def test_a_path_that_the_search_tested_is_free_in_both_directions(seed: int):
    """It is not tested again at the end, where points are all that a space can test."""
    space, _, start, goal, _, _ = slit()
    path = plan(space, start, goal, seed=seed, simplify=False).path
    assert len(path) > 2
    assert space.is_path_free(path) and space.is_path_free(path[::-1])


@pytest.mark.parametrize(
    ('name', 'algorithm'),
    [
        sweep(name, algorithm) if algorithm != 'auto' and name in FURTHER else (name, algorithm)
        for name in SCENES
        for algorithm in ('auto', *(NAMES if name in EVERY_PLANNER else ()))
    ],
)
def test_paths_are_free_and_end_where_they_should(name: str, algorithm: str):
    scene = SCENES[name]()
    space, start, goal = scene.space, scene.start, scene.goal
    for seed in SEEDS:
        for is_simplified in (False, True):
            result = plan(
                space,
                start,
                goal,
                algorithm=algorithm,
                seed=seed,
                simplify=is_simplified,
            )
            assert result.status is PlannerStatus.SOLVED, result.message
            assert scene.collisions(result.path) == []
            np.testing.assert_array_equal(result.path[[0, -1]], [start, goal])
            lengths = np.linalg.norm(np.diff(result.path, axis=0), axis=1)
            assert result.length == pytest.approx(lengths.sum(), rel=1e-12)
    assert result.length >= np.linalg.norm(goal - start)


@pytest.mark.parametrize('name', SCENES)
def test_regions_are_reached_and_ends_that_are_not_free_refused(name: str):
    scene = SCENES[name]()
    space, start, goal, blocked = scene.space, scene.start, scene.goal, scene.blocked
    radius = 0.05 * diagonal(space)
    result = plan(space, start, goal, goal_radius=radius, seed=5)
    assert result.status is PlannerStatus.SOLVED
    assert np.linalg.norm(result.path[-1] - goal) <= radius
    assert scene.collisions(result.path) == []
    reason = space.why_not_free(blocked)
    for ends, status in (
        ((blocked, goal), PlannerStatus.INVALID_START),
        ((start, blocked), PlannerStatus.INVALID_GOAL),
    ):
        result = plan(space, *ends, seed=0)
        assert result.status is status
        assert reason in result.message


def test_a_path_is_shortened_in_any_dimension():
    scene = SCENES['balls, 6-D']()
    space, start, goal = scene.space, scene.start, scene.goal
    rough = plan(space, start, goal, algorithm='hit_and_run', simplify=False, seed=1)
    short = simplify(space, rough.path, seed=0)
    assert scene.collisions(short) == []
    lengths = [np.linalg.norm(np.diff(path, axis=0), axis=1).sum() for path in (rough.path, short)]
    assert np.linalg.norm(goal - start) <= lengths[1] < 0.5 * lengths[0]


def test_the_checker_detects_collisions():
    _, is_free, start, goal, *_ = SCENES['balls, 3-D']()
    assert len(collisions([start, goal], is_free, 0.01)) == 1
    assert collisions([start], is_free, 0.01) == []
    assert collisions([start, [np.nan] * 3], is_free, 0.01)
    assert collisions([start, [-0.1] * 3], is_free, 0.01)


@pytest.mark.parametrize('algorithm', NAMES)
def test_a_line_with_a_gap_is_searched_and_given_up(algorithm: str):
    space = DifferenceSpace(BoxSpace([0.0], [1.0]), BallSpace([0.5], 0.1))
    result = plan(space, [0.1], [0.9], algorithm=algorithm, max_iterations=200, seed=0)
    assert result.status is PlannerStatus.ITERATION_LIMIT
    assert (result.samples < 0.4).sum() + (result.samples > 0.6).sum() == len(result.samples)


def test_components_are_distinguished_without_a_search():
    two = PolygonSpace(shapely.MultiPolygon([shapely.box(0, 0, 1, 1), shapely.box(1, 1, 2, 2)]))
    lifted = ProductSpace(two, BoxSpace([0.0], [1.0]))
    drilled = DifferenceSpace(two, BallSpace((0.5, 0.5), 0.1))
    for space, rest in ((two, []), (lifted, [0.5]), (drilled, [])):
        result = plan(space, [0.2, 0.2, *rest], [1.8, 1.8, *rest], seed=0)
        assert result.status is PlannerStatus.UNREACHABLE
        assert result.iterations == 0
        assert plan(space, [0.2, 0.2, *rest], [0.8, 0.8, *rest], seed=0).path.shape[0] >= 2


def test_further_paths_pass_holes_of_a_polygon_on_other_sides():
    hall = shapely.box(0, 0, 10, 6).difference(shapely.box(4, 2, 6, 4))
    space = PolygonSpace(hall)
    result = plan(space, (1.0, 3.2), (9.0, 3.2), alternatives=3, seed=0, time_limit=60.0)
    assert len(result.paths) == 2
    below = [path[:, 1].min() < 2.0 for path in result.paths]
    assert sorted(below) == [False, True]
    for path in result.paths:
        assert hall.contains_properly(shapely.LineString(path))


def test_what_a_space_cannot_tell_is_refused():
    space, _, start, goal, *_ = SCENES['balls, 3-D']()
    with pytest.raises(RequestError, match='alternatives must be 1 in a DifferenceSpace'):
        plan(space, start, goal, alternatives=2)
    with pytest.raises(RequestError, match='clearance must be 0 in a DifferenceSpace'):
        plan(space, start, goal, clearance=0.1)
    with pytest.raises(RequestError, match='must have dimension 2, this DifferenceSpace has 3'):
        Roadmap.build(space)
