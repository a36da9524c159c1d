"""Questions that stop early, held against the exits and entries that they stand for."""

from collections.abc import Iterator
import math

from hnr_planner.core import BallSpace, BoxSpace, DifferenceSpace, OracleSpace, Space, UnionSpace
from hnr_planner.core.spaces.oracle_data import COARSE
from hnr_planner.core.spaces.primitives import (
    contains,
    exit_beyond,
    first_blocked,
    first_entry,
    first_exit,
    is_visible,
    line_touches,
    longest_ray,
    segment_is_free,
)
import numpy as np
from numpy.typing import NDArray
import pytest

pytestmark = pytest.mark.interpreted

#: Lines drawn in each space.
N_LINES = 60


def _solids() -> DifferenceSpace:
    """Return a box without balls, and without boxes that abut."""
    centres = np.random.default_rng(5).uniform(0.0, 1.0, (6, 3))
    return DifferenceSpace(
        BoxSpace(np.zeros(3), np.ones(3)),
        *(BallSpace(centre, 0.25) for centre in centres),
        BoxSpace((0.4, 0.0, 0.0), (0.5, 0.5, 1.0)),
        BoxSpace((0.4, 0.5, 0.0), (0.5, 1.0, 0.4)),
    )


def _among_balls() -> DifferenceSpace:
    """Return a box without balls, of which some overlap and some lie outside."""
    centres = np.random.default_rng(6).uniform(-0.2, 1.2, (20, 4))
    return DifferenceSpace(
        BoxSpace(np.zeros(4), np.ones(4)), *(BallSpace(centre, 0.35) for centre in centres)
    )


def _is_in_ring(x: NDArray) -> bool:
    return bool(0.3 < np.hypot(x[0], x[1]) < 1.0)


SPACES = {
    'solids': _solids,
    'balls': _among_balls,
    'union': lambda: UnionSpace(BoxSpace((0, 0), (2, 1)), BallSpace((2, 1), 0.7)),
    'oracle': lambda: OracleSpace(_is_in_ring, (-1.1, -1.2), (1.2, 1.1), resolution=0.08),
}


def _lines(space: Space) -> Iterator[tuple[NDArray, NDArray, float]]:
    """Yield free points, directions, and parameters, in the kernel frame."""
    rng = np.random.default_rng(2)
    lower, upper = space.kernel_bounds
    for _ in range(N_LINES):
        x = rng.uniform(lower, upper)
        if contains.interpreted(space.data, x):
            yield x, rng.uniform(lower, upper) - x, rng.uniform(0.0, 1.5)


@pytest.mark.parametrize('name', SPACES)
def test_an_exit_beyond_a_parameter_is_the_exit(name: str) -> None:
    """
    Before it, any value up to the parameter tells that much.

    Where a space looks at few points only, the others tell how far the ray is free.
    """
    space, rng = SPACES[name](), np.random.default_rng(7)
    beyond = rough = 0
    for x, u, t in _lines(space):
        end = first_exit.interpreted(space.data, x, u, 0.0, math.inf)
        found = exit_beyond.interpreted(space.data, x, u, t)
        if isinstance(space, OracleSpace):
            step = space.resolution / np.linalg.norm(u)
            assert found <= t or found > end - COARSE * step
        else:
            assert abs(found - end) * np.linalg.norm(u) <= space.margin if end > t else found <= t
        beyond += end > t
        s = rng.uniform(0.5, 1.0) * found
        y = x + s * u
        if found > t and contains.interpreted(space.data, y):
            blocked = first_blocked.interpreted(space.data, x, y)
            assert (blocked == math.inf) == segment_is_free.interpreted(space.data, x, y)
            assert blocked == math.inf or not contains.interpreted(
                space.data, x + blocked * (y - x)
            )
            assert blocked == math.inf or end - space.margin <= blocked * s <= s
            rough += blocked < math.inf
    assert 5 < beyond < N_LINES - 5
    assert (rough > 0) == isinstance(space, OracleSpace)


@pytest.mark.parametrize('name', ['solids', 'balls', 'union'])
def test_the_longest_ray_is_the_one_with_the_last_exit(name: str) -> None:
    """The rays have directions of different lengths, and their ends are parameters."""
    space, rng = SPACES[name](), np.random.default_rng(8)
    longest = set()
    for x, _, _ in _lines(space):
        directions = rng.normal(size=(5, len(x)))
        ends = [exit_beyond.interpreted(space.data, x, u, 0.0) for u in directions]
        k, end = longest_ray.interpreted(space.data, x, directions)
        assert (k, end) == (int(np.argmax(ends)), max(ends))
        longest.add(k)
    assert len(longest) == 5


@pytest.mark.parametrize('name', SPACES)
def test_a_segment_between_free_points_is_free_where_one_sees_the_other(name: str) -> None:
    """A point sees itself, too."""
    space = SPACES[name]()
    visible = 0
    points = [x for x, _, _ in _lines(space)]
    for a, b in zip(points, points[1:] + points[-1:], strict=True):
        sees = is_visible.interpreted(space.data, a, b)
        assert sees == segment_is_free.interpreted(space.data, a, b)
        visible += sees
    assert 1 < visible < len(points)


@pytest.mark.parametrize('name', SPACES)
def test_a_segment_is_free_where_the_exit_is_beyond_its_end(name: str) -> None:
    """And both of its ends are free."""
    space = SPACES[name]()
    free = 0
    for x, u, _ in _lines(space):
        is_free = segment_is_free.interpreted(space.data, x, x + u)
        end = first_exit.interpreted(space.data, x, u, 0.0, 1.0)
        assert is_free == (contains.interpreted(space.data, x + u) and end > 1.0)
        free += is_free
    assert free > 5


def test_a_search_tests_the_same_points_in_both_directions() -> None:
    """
    A planner may test a step from its end, and the path is free in the other direction, too.

    The tests are so far apart that segments pass between them through the hole of the ring.
    """
    space = OracleSpace(_is_in_ring, (-1.1, -1.2), (1.2, 1.1), resolution=0.4)
    rng = np.random.default_rng(11)
    free = 0
    for _ in range(40 * N_LINES):
        a, b = rng.uniform(*space.kernel_bounds, (2, 2))
        is_free = segment_is_free.interpreted(space.data, a, b)
        assert segment_is_free.interpreted(space.data, b, a) == is_free
        free += is_free
    assert free > N_LINES


def test_a_line_touches_what_it_enters_up_to_the_end() -> None:
    """Balls and boxes that are removed, from within them and from outside."""
    removed = _solids().data.removed
    rng = np.random.default_rng(3)
    touching = 0
    for _ in range(N_LINES):
        x, u, end = rng.uniform(-1.0, 1.0, 3), rng.normal(size=3), rng.uniform(0.0, 2.0)
        entry = first_entry.interpreted(removed, x, u, 0.0)
        assert line_touches.interpreted(removed, x, u, end) == (entry <= end)
        touching += entry <= end
    assert 5 < touching < N_LINES - 5


def test_a_segment_of_one_point_is_free_where_the_point_is() -> None:
    """A ball has no direction to be looked at along."""
    solids = _solids().data
    for x, is_free in ((np.full(3, 0.01), True), (np.array([0.45, 0.2, 0.2]), False)):
        assert contains.interpreted(solids, x) == is_free
        assert segment_is_free.interpreted(solids, x, x.copy()) == is_free
