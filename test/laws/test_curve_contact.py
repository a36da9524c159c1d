"""Where a parabola or an arc leaves a space, against an independent search."""

import math
from test.curve_brute_force import Bend, Curve, curve_collisions, Throw
from typing import Any

from hnr_planner.core import GridSpace
from hnr_planner.core.kernels.kernel import interpreted
from hnr_planner.core.spaces.curves.curve import Arc, first_exit_on_curve, Parabola
from hnr_planner.core.spaces.grid.curves import first_exit_of_arc
import numpy as np
import pytest

SHAPE = (12, 14)


def draw_parabola(rng: np.random.Generator, x: Any) -> tuple[Parabola, float, Any]:
    """Draw one that often runs along an axis for one coordinate, and how to check a part of it."""
    v, a = 3.0 * rng.normal(size=2), 2.0 * rng.normal(size=2)
    for vector in (v, a):
        if rng.random() < 0.2:
            vector[rng.integers(2)] = 0.0
    return Parabola(x, v, a), rng.uniform(0.1, 4.0), lambda end: Throw(x - 1.0, v, a, end)


def draw_arc(rng: np.random.Generator, x: Any) -> tuple[Arc, float, Any]:
    """Draw one from straight to several turns."""
    heading = rng.uniform(-4.0, 4.0)
    curvature = rng.choice([0.0, 1e-9, 1e-3, 0.3, 1.0, 3.0]) * rng.choice([-1.0, 1.0])
    begin = complex(*(x - 1.0))
    curve = Arc(x, heading, curvature)
    return curve, rng.uniform(0.1, 9.0), lambda end: Bend(begin, heading, curvature, [0.0, end])


@pytest.mark.parametrize('draw', [draw_parabola, draw_arc])
def test_contact_on_a_grid_is_where_brute_force_finds_it(draw: Any) -> None:
    """600 curves: free until a millionth before the contact, not a hundred-thousandth after."""
    rng = np.random.default_rng(3)
    contacts = free = 0
    while contacts + free < 600:
        blocked = rng.random(SHAPE) < rng.choice([0.03, 0.15, 0.3])
        space = GridSpace.from_blocked(blocked)
        x = rng.uniform((0, 0), SHAPE[::-1])
        if not space.contains(x):
            continue
        curve, end, part = draw(rng, space.to_kernel(x))
        left = first_exit_on_curve(space.data, curve, end)
        assert left == interpreted(first_exit_on_curve)(space.data, curve, end)
        if left == math.inf:
            assert not curve_collisions(part(end), blocked)
            free += 1
        else:
            assert not curve_collisions(part(max(left - 1e-6, 0.0)), blocked)
            assert curve_collisions(part(left + 1e-5), blocked)
            contacts += 1
    assert min(contacts, free) > 100


def test_an_arc_followed_without_an_angle_ends_where_brute_force_finds_it() -> None:
    """600 arcs to either side, some of them along an axis at first: as for curves."""
    rng = np.random.default_rng(4)
    contacts = free = 0
    while contacts + free < 600:
        blocked = rng.random(SHAPE) < rng.choice([0.03, 0.15, 0.3])
        space = GridSpace.from_blocked(blocked)
        x = rng.uniform((0, 0), SHAPE[::-1])
        if not space.contains(x):
            continue
        x = space.to_kernel(x)
        (_, heading, curvature), end, _ = draw_arc(rng, x)
        if curvature == 0.0:
            continue
        dx, dy = math.cos(heading), math.sin(heading)
        if rng.random() < 0.2:
            dx, dy = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][rng.integers(4)]
            heading = math.atan2(dy, dx)
        begin = complex(*(x - 1.0))
        of_arc = space.data.free_distance, x[0], x[1], dx, dy, curvature, end
        left = first_exit_of_arc(*of_arc)
        assert left == interpreted(first_exit_of_arc)(*of_arc)
        if left == math.inf:
            assert not curve_collisions(Bend(begin, heading, curvature, [0.0, end]), blocked)
            free += 1
        else:
            before, after = max(left - 1e-6, 0.0), left + 1e-5
            assert not curve_collisions(Bend(begin, heading, curvature, [0.0, before]), blocked)
            assert curve_collisions(Bend(begin, heading, curvature, [0.0, after]), blocked)
            contacts += 1
    assert min(contacts, free) > 100


def on_empty(curve: Any, end: float) -> float:
    """Leave an empty map of 20 x 20 cells, whose corner lies at (1, 1) of the kernel frame."""
    space = GridSpace.from_blocked(np.zeros((20, 20), dtype=bool))
    return first_exit_on_curve(space.data, curve, end)


def test_contact_is_the_root_in_closed_form() -> None:
    x, zero = np.array([11.0, 11.0]), np.zeros(2)
    falling = Parabola(x, np.array([0.0, 3.0]), np.array([0.0, -2.0]))
    assert on_empty(falling, 100.0) == pytest.approx((3.0 + math.sqrt(49.0)) / 2.0, rel=1e-15)
    assert on_empty(falling, 4.9) == math.inf
    straight = Parabola(x, np.array([4.0, 0.0]), zero)
    assert on_empty(straight, 100.0) == 2.5
    circle = Arc(x, 0.0, 1.0 / 5.0)
    assert on_empty(circle, 1e3) == pytest.approx(5.0 * math.pi, rel=1e-9)
    small = Arc(x, 0.0, 1.0 / 4.9)
    assert on_empty(small, 1e3) == math.inf


def test_a_curve_that_stands_still_touches_nothing_where_it_is_free() -> None:
    zero = np.zeros(2)
    assert on_empty(Parabola(np.array([5.0, 5.0]), zero, zero), 1e9) == math.inf
    assert on_empty(Parabola(np.array([1.0, 5.0]), zero, zero), 1.0) == 0.0
    assert on_empty(Arc(np.array([5.0, 5.0]), 1.0, 1.0), 0.0) == math.inf


def test_a_throw_over_a_wall_lands_behind_it() -> None:
    """The chord from end to end is blocked, the parabola is not."""
    blocked = np.zeros((12, 14), dtype=bool)
    blocked[:5, 6:8] = True
    space = GridSpace.from_blocked(blocked)
    x, v, a = np.array([2.0, 1.0]), np.array([2.0, 5.0]), np.array([0.0, -2.0])
    assert not space.is_motion_valid(x, x + 5.0 * v + 12.5 * a)
    kernel = space.to_kernel(x)
    assert first_exit_on_curve(space.data, Parabola(kernel, v, a), 5.0) == math.inf
    low = Parabola(kernel, v * (1.0, 0.5), a)
    contact = first_exit_on_curve(space.data, low, 5.0)
    checked: Curve = Throw(x, v * (1.0, 0.5), a, contact - 1e-9)
    assert contact < 5.0 and not curve_collisions(checked, blocked)
