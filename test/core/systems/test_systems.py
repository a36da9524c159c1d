"""Systems: exact motion, limits, frames."""

import math
from test.curve_brute_force import Bend, curve_collisions, Throw
from typing import Any

from hnr_planner.core import GridSpace, HnrError
from hnr_planner.core.systems import (
    Car,
    DoubleIntegrator,
    join_trajectories,
    System,
    Trajectory,
)
from hnr_planner.core.systems.double_integrator import limit_acceleration
from hnr_planner.core.systems.primitives import contact
import numpy as np
import pytest

pytestmark = pytest.mark.interpreted

SYSTEMS: list[System] = [
    DoubleIntegrator(dim=2, max_acceleration=2.0, max_speed=3.0),
    Car(max_acceleration=2.0, max_speed=3.0, max_curvature=1.5),
]
IDS = ['double integrator', 'car']
PLACES = [(1.0, (0.0, 0.0, 0.0)), (0.05, (-3.0, 7.0, 0.0)), (0.2, (1.0, -2.0, 2.2))]


def draw(system: System, rng: np.random.Generator) -> tuple[Any, Any]:
    """Draw a state, and a control within the limits."""
    state, control = rng.uniform(-1.0, 1.0, 4), rng.uniform(-1.0, 1.0, 2)
    return state, control


@pytest.mark.parametrize('system', SYSTEMS, ids=IDS)
def test_motion_solves_the_equations_of_motion(system: System) -> None:
    """Against 2000 steps of the fourth-order Runge-Kutta method."""

    def slope(state: Any, control: Any) -> Any:
        if isinstance(system, Car):
            heading, speed = state[2:]
            way = speed * np.array([math.cos(heading), math.sin(heading), control[1]])
            return np.append(way, control[0])
        return np.concatenate([state[2:], control])

    rng = np.random.default_rng(0)
    state, control = draw(system, rng)
    exact, n, duration = system.propagate(state, control, 3.0), 2000, 3.0
    h = duration / n
    for _ in range(n):
        k1 = slope(state, control)
        k2 = slope(state + h / 2 * k1, control)
        k3 = slope(state + h / 2 * k2, control)
        k4 = slope(state + h * k3, control)
        state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    assert exact == pytest.approx(state, abs=1e-11)


@pytest.mark.parametrize('system', SYSTEMS, ids=IDS)
def test_motion_may_be_interrupted(system: System) -> None:
    rng = np.random.default_rng(1)
    for _ in range(100):
        state, control = draw(system, rng)
        first, second = rng.uniform(0.0, 2.0, 2)
        between = system.propagate(state, control, first)
        whole = system.propagate(state, control, first + second)
        assert system.propagate(between, control, second) == pytest.approx(whole, abs=1e-12)
        states, controls = np.stack([state, state, between]), np.stack([control] * 3)
        lengths = system.lengths(states, controls, np.array([first + second, first, second]))
        assert lengths[0] == pytest.approx(lengths[1:].sum(), rel=3e-3)
        assert (system.propagate(state, control, 0.0) == state).all()


@pytest.mark.parametrize('place', PLACES)
@pytest.mark.parametrize('system', SYSTEMS, ids=IDS)
def test_motion_is_the_same_in_the_frame_of_a_grid(system: System, place: Any) -> None:
    resolution, origin = place
    space = GridSpace.from_blocked(np.zeros((9, 9), dtype=bool), resolution, origin)
    rng = np.random.default_rng(2)
    for _ in range(20):
        state, control = draw(system, rng)
        inside = system.to_kernel(space, state)
        assert system.from_kernel(space, inside[np.newaxis])[0] == pytest.approx(state, abs=1e-12)
        turned = system.controls_to_kernel(space, control[np.newaxis])
        back = system.controls_from_kernel(space, turned)[0]
        assert back == pytest.approx(control, abs=1e-12)
        there = system.to_kernel(space, system.propagate(state, control, 1.3))
        assert system.propagate(inside, turned[0], 1.3) == pytest.approx(there, abs=1e-10)


@pytest.mark.parametrize('system', SYSTEMS, ids=IDS)
def test_contact_of_a_motion_is_where_brute_force_finds_it(system: System) -> None:
    """400 motions, among them cars that turn back on the way."""
    rng = np.random.default_rng(4)
    seen = {True: 0, False: 0}
    while sum(seen.values()) < 400:
        blocked = rng.random((9, 9)) < 0.1
        space = GridSpace.from_blocked(blocked)
        state, control = draw(system, rng)
        state[:2], state[3] = rng.uniform(0.0, 9.0, 2), 2.0 * state[3]
        if not space.contains(state[:2]):
            continue
        inside = system.to_kernel(space, state)
        time = contact(system.compiled(space), space.data, inside, control, 1.5)
        free = time == math.inf
        seen[free] += 1
        before = max(min(time, 1.5) - 1e-6, 0.0)
        assert not curve_collisions(followed(system, state, control, before), blocked)
        assert free or curve_collisions(followed(system, state, control, time + 1e-3), blocked)
    assert min(seen.values()) > 50


def followed(system: System, state: Any, control: Any, time: float) -> Any:
    """Return the curve of a motion for the checker."""
    if isinstance(system, DoubleIntegrator):
        return Throw(state[:2], state[2:], control, time)
    speed, pull = state[3], control[0]
    ways, turn = [0.0, speed * time + pull * time**2 / 2.0], -speed / pull
    if 0.0 < turn < time:
        ways.append(speed * turn / 2.0)
    return Bend(complex(*state[:2]), state[2], control[1], ways)


@pytest.mark.parametrize('bad', [0.0, -1.0, math.nan, math.inf, 'fast', None])
@pytest.mark.parametrize('name', ['max_acceleration', 'max_speed'])
@pytest.mark.parametrize('kind', [DoubleIntegrator, Car])
def test_bad_limits_are_named(kind: Any, name: str, bad: Any) -> None:
    with pytest.raises(HnrError, match=name):
        kind(**{name: bad})


def test_other_bad_numbers_are_named() -> None:
    with pytest.raises(HnrError, match='max_curvature'):
        Car(max_curvature=0.0)
    with pytest.raises(HnrError, match='dim must be at least 1'):
        DoubleIntegrator(dim=0)
    system = DoubleIntegrator(max_speed=1.0)
    with pytest.raises(HnrError, match=r'state must have shape \(k, 4\)'):
        system.check_state('state', (0, 0, 0))
    with pytest.raises(HnrError, match=r'no faster than max_speed, 1 m/s, got 1\.5'):
        system.check_state('state', (0, 0, 0.9, 1.2))
    with pytest.raises(
        HnrError, match=r'no faster than max_speed, 1 m/s, got 1\.2 m/s in \[.*-1\.2\]'
    ):
        Car().check_state('state', (0, 0, 0, -1.2))
    with pytest.raises(HnrError, match='duration must be in 0'):
        system.propagate((0, 0, 0, 0), (0, 0), -1.0)


def test_the_controller_takes_the_best_acceleration_within_both_limits() -> None:
    """Against the nearest of 200 x 200 accelerations, and right up to where rounding decides."""
    system = DoubleIntegrator(max_acceleration=1.0, max_speed=2.0)
    rng, step = np.random.default_rng(6), 0.4
    radius, angle = np.meshgrid(np.linspace(0.0, 1.0, 200), np.linspace(0.0, 2.0 * np.pi, 200))
    allowed = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1).reshape(-1, 2)
    for k in range(300):
        v = rng.normal(size=2)
        v *= 2.0 * rng.choice([1.0, rng.random()]) / np.hypot(*v)
        wish = 5.0 * rng.normal(size=2) if k % 3 else v * (1.0 + 1e-12 * rng.normal())
        control = wish.copy()
        limit_acceleration(system.data, v, step, control)
        assert np.hypot(*control) <= 1.0 + 1e-9
        assert np.hypot(*(v + step * control)) <= 2.0 + 1e-9
        others = allowed[np.hypot(*(v + step * allowed).T) <= 2.0]
        nearest = np.hypot(*(others - wish).T).min()
        assert np.hypot(*(control - wish)) <= nearest + 1e-6


def test_trajectories_are_joined_where_one_begins_as_the_other_ends() -> None:
    system, rng = DoubleIntegrator(), np.random.default_rng(7)
    states, controls = [rng.normal(size=4)], rng.normal(size=(5, 2))
    durations = rng.uniform(0.1, 1.0, 5)
    for control, duration in zip(controls, durations, strict=True):
        states.append(system.propagate(states[-1], control, duration))
    times = np.append(0.0, np.cumsum(durations))
    whole = Trajectory(system, times, np.array(states), controls)

    def piece(i: int, j: int) -> Trajectory:
        after = j + 1
        steps = times[i:after] - times[i], whole.states[i:after], controls[i:j]
        return Trajectory(system, *steps)

    stay = Trajectory(system, np.zeros(2), whole.states[[2, 2]], np.zeros((1, 2)))
    joined = join_trajectories([piece(0, 2), stay, piece(2, 3), piece(3, 5)])
    assert joined.times == pytest.approx(times, abs=1e-12)
    assert np.array_equal(joined.states, whole.states)
    assert np.array_equal(joined.controls, controls)
    assert np.array_equal(join_trajectories([stay, stay]).states, stay.states)
    with pytest.raises(HnrError, match='trajectory 1 must begin in the state'):
        join_trajectories([piece(0, 2), piece(3, 5)])
    with pytest.raises(HnrError, match='at least one'):
        join_trajectories([])
