"""Two-point connections of the double integrator."""

import math
from typing import Any

from hnr_planner.core.systems import DoubleIntegrator
from hnr_planner.core.trajectories.two_point import connect, empty_connection
import numpy as np
import pytest

pytestmark = pytest.mark.interpreted

SYSTEM = DoubleIntegrator(max_acceleration=1.5, max_speed=2.0)


def pieces(a: Any, b: Any, longest: float | None = None, system: Any = SYSTEM) -> Any:
    """Return duration and pieces of the connection from ``a`` to ``b``, in whatever time."""
    a, b = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
    room = empty_connection(len(a) // 2)
    limits = 1e-3 * 2.0 ** np.arange(30) if longest is None else [longest]
    for limit in limits:
        duration = connect(system.data, a, b, float(limit), room)
        if duration < math.inf:
            break
    n = room.n[0]
    return duration, room.durations[:n].copy(), room.controls[:n].copy()


def draw_state(rng: np.random.Generator, dim: int) -> Any:
    v = rng.normal(size=dim)
    v *= SYSTEM.max_speed * rng.choice([0.0, 1.0, rng.random()]) / np.linalg.norm(v)
    return np.append(rng.uniform(-3.0, 3.0, dim) * rng.choice([0.01, 1.0, 10.0]), v)


@pytest.mark.parametrize('dim', [1, 2, 3])
def test_a_connection_leads_where_it_should_within_the_limits(dim: int) -> None:
    """Across the displacement the speed limit may leave too little: then there may be none."""
    rng, found = np.random.default_rng(dim), 0
    for _ in range(300):
        a, b = draw_state(rng, dim), draw_state(rng, dim)
        duration, durations, controls = pieces(a, b)
        if duration == math.inf and dim > 1:
            continue
        found += 1
        assert durations.sum() == pytest.approx(duration, rel=1e-12)
        x, v = a[:dim].copy(), a[dim:].copy()
        for t, u in zip(durations, controls, strict=True):
            assert np.linalg.norm(u) <= SYSTEM.max_acceleration * (1 + 1e-12)
            x, v = x + t * v + t**2 / 2 * u, v + t * u
            assert np.linalg.norm(v) <= SYSTEM.max_speed * (1 + 1e-9)
        assert np.append(x, v) == pytest.approx(b, abs=1e-9)
    assert found >= 270


def test_from_rest_to_rest_it_takes_the_least_time() -> None:
    """Closed form: two ramps below d = V^2 / A, and a cruise between them above."""
    for way in (0.01, 1.0, 2.0, 3.0, 40.0):
        a, v = SYSTEM.max_acceleration, SYSTEM.max_speed
        least = 2.0 * math.sqrt(way / a) if way <= v * v / a else way / v + v / a
        u = np.array([math.cos(way), math.sin(way)]) * way
        duration, _, _ = pieces((1.0, 2.0, 0.0, 0.0), (1.0 + u[0], 2.0 + u[1], 0.0, 0.0))
        assert duration == pytest.approx(least, rel=1e-4)


def test_a_change_of_velocity_alone_takes_the_least_time() -> None:
    a = np.array([0.0, 0.0, 1.0, 0.0])
    control, t = np.array([-1.5, 0.0]), 1.2
    b = SYSTEM.propagate(a, control, t)
    assert pieces(a, b)[0] == pytest.approx(t, rel=1e-4)


def test_a_connection_keeps_to_the_time_that_it_is_given() -> None:
    a, b = (0.0, 0.0, 0.0, 0.0), (3.0, 0.0, 0.0, 0.0)
    best = pieces(a, b)[0]
    assert pieces(a, b, best * (1.0 + 1e-3))[0] <= best * (1.0 + 1e-3)
    assert pieces(a, b, best * (1.0 - 1e-3))[0] == math.inf
    assert pieces(a, b, 0.0)[0] == math.inf
    assert pieces(a, b, -1.0)[0] == math.inf


def test_the_direction_of_the_axes_does_not_matter() -> None:
    rng = np.random.default_rng(5)
    for _ in range(50):
        a, b = draw_state(rng, 2), draw_state(rng, 2)
        turn = np.linalg.qr(rng.normal(size=(2, 2)))[0]
        turned = [np.append(turn @ s[:2], turn @ s[2:]) for s in (a, b)]
        assert pieces(*turned)[0] == pytest.approx(pieces(a, b)[0], rel=1e-6)
