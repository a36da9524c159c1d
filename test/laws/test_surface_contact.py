"""First exits of curves from spaces bounded by planes and spheres, against dense tests."""

import math
from test.sweeps import sweep
from typing import Any

from hnr_planner.core import (
    BallSpace,
    BoxSpace,
    DifferenceSpace,
    PolygonSpace,
    PolytopeSpace,
    Space,
    UnionSpace,
)
from hnr_planner.core.kernels.modes import Mode, mode_of_thread
from hnr_planner.core.spaces.curves.curve import (
    Arc,
    first_exit_on_curve,
    Parabola,
    supports_curves,
)
import numpy as np
import pytest
from shapely import Polygon

N_TESTS = 20_000

PLANE: dict[str, Space] = {
    'box': BoxSpace((0, 0), (3, 2)),
    'ball': BallSpace((1, 1), 1.5),
    'triangle': PolytopeSpace([[-1, 0], [0, -1], [1, 2]], [0, 0, 4]),
    'polygon': PolygonSpace(Polygon([(0, 0), (4, 0), (4, 3), (2, 1), (0, 3)])),
    'rooms': UnionSpace(BoxSpace((0, 0), (1, 1)), BoxSpace((0.1 + 0.9, 0.2), (2, 0.8))),
    'holes': DifferenceSpace(
        BoxSpace((0, 0), (4, 4)), BallSpace((1, 1), 0.5), BallSpace((3, 2), 1)
    ),
    'box and ball': UnionSpace(BoxSpace((0, 0), (2, 1)), BallSpace((2, 1), 1)),
}
SOLID: dict[str, Space] = {
    'cube': BoxSpace((0, 0, 0), (2, 2, 2)),
    'ball': BallSpace((1, 1, 1), 1.5),
    'cube with a hole': DifferenceSpace(BoxSpace((0, 0, 0), (2, 2, 2)), BallSpace((1, 1, 1), 0.6)),
}


def draw_curve(rng: np.random.Generator, x: Any, arcs: bool) -> Any:
    if arcs and rng.random() < 0.5:
        return Arc(x, rng.uniform(-4, 4), rng.choice([0.0, 0.3, 1.0, -2.0]))
    v, a = 2.0 * rng.normal(size=len(x)), 2.0 * rng.normal(size=len(x))
    return Parabola(x, v * rng.choice([0.0, 1.0]), a * rng.choice([0.0, 1.0]))


def points_on(curve: Any, t: Any) -> Any:
    """Return the points (k, dim) of a curve at parameters (k,)."""
    t = t[:, np.newaxis]
    if isinstance(curve, Parabola):
        return curve.position + t * curve.velocity + t**2 / 2 * curve.acceleration
    if curve.curvature == 0.0:
        return curve.position + t * [np.cos(curve.heading), np.sin(curve.heading)]
    angle = curve.heading + curve.curvature * t
    across = np.hstack([np.sin(angle), -np.cos(angle)])
    first = np.array([math.sin(curve.heading), -math.cos(curve.heading)])
    return curve.position + (across - first) / curve.curvature


CASES = [(name, space) for name, space in [*PLANE.items(), *SOLID.items()]]
#: Of every kind of surface, and of pieces and holes.
KEPT = ('polygon', 'holes', 'box and ball', 'cube with a hole')


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ('name', 'space'),
    [case if case[0] in KEPT else sweep(*case) for case in CASES],
    ids=[name for name, _ in CASES],
)
def test_contact_lies_between_the_last_free_look_and_the_next(name: str, space: Space) -> None:
    rng = np.random.default_rng(7)
    lower, upper = space.bounds
    with mode_of_thread(Mode.COMPILED):
        space.contains(lower)  # from now on machine code, since it is asked of many points
    contacts = free = 0
    while contacts + free < 150:
        x = rng.uniform(lower, upper)
        if not space.contains(x):
            continue
        curve, end = draw_curve(rng, x, space.dim == 2), rng.uniform(0.1, 3.0)
        left = first_exit_on_curve(space.data, curve, end)
        times = np.linspace(0.0, end, N_TESTS)
        out = np.flatnonzero(~space.contains(points_on(curve, times)))
        if len(out) == 0:
            # What it cuts off between two tests is less than they resolve.
            assert left == math.inf or chord_is_short(space, curve, left, end / N_TESTS)
            free += 1
        else:
            if left < times[out[0] - 1]:
                assert chord_is_short(space, curve, left, end / N_TESTS)
            else:
                assert left <= times[out[0]]
            contacts += 1
    assert min(contacts, free) > 10


def chord_is_short(space: Space, curve: Any, left: float, step: float) -> bool:
    """Return whether a curve is outside right after ``left``, where dense tests cannot decide."""
    times = left + np.geomspace(1e-9, step, 2000)
    return bool((~space.contains(points_on(curve, times))).any())


@pytest.mark.interpreted
def test_a_gap_that_rays_pass_is_passed_by_curves() -> None:
    rooms = UnionSpace(BoxSpace((0, 0), (0.3, 1)), BoxSpace((0.1 + 0.2, 0), (1, 1)))
    x, v, a = np.array([0.1, 0.5]), np.array([0.5, 0.1]), np.array([0.1, -0.2])
    assert first_exit_on_curve(rooms.data, Parabola(x, v, a), 1.0) == math.inf
    apart = UnionSpace(BoxSpace((0, 0), (0.3, 1)), BoxSpace((0.3 + 1e-6, 0), (1, 1)))
    contact = first_exit_on_curve(apart.data, Parabola(x, v, a), 1.0)
    assert x[0] + contact * v[0] + contact**2 / 2 * a[0] == pytest.approx(0.3, abs=1e-12)


def test_only_spaces_whose_parts_all_have_surfaces_know_curves() -> None:
    assert all(supports_curves(space.data) for _, space in CASES)
