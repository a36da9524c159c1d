"""What the boundary does to trajectories: it is not met, or stops the robot; doomed starts."""

import math
from test.core.trajectories.worlds import (
    BLOCKED,
    faults,
    GOAL,
    INTEGRATOR,
    SPACE,
    START,
    state,
)
from typing import Any

from hnr_planner.core import GridSpace, plan_trajectory, PlannerStatus, TrajectoryResult
from hnr_planner.core.systems import DoubleIntegrator
import numpy as np
import pytest


def solve(start: Any = START, goal: Any = GOAL, **given: Any) -> TrajectoryResult:
    """Plan in the serpentine; no clock limits it unless asked for."""
    arguments = {'seed': 1, 'time_limit': math.inf, **given}
    return plan_trajectory(SPACE, INTEGRATOR, start, goal, **arguments)


#: A hall whose wall is 0.1 m behind the goal.
HALL = GridSpace.from_blocked(np.arange(40) >= np.full((40, 1), 30), resolution=0.1)
BEFORE_WALL = (2.9, 2.0)
SLOW = DoubleIntegrator(dim=2, max_acceleration=1.0, max_speed=1.5)
KINDS = ['kinodynamic_connect', 'kinodynamic_hit_and_run', 'kinodynamic_rrt']


@pytest.mark.parametrize('algorithm', KINDS)
def test_nothing_stops_dead_at_a_wall_nor_has_to(algorithm: str) -> None:
    """Ten trajectories: a step begins as fast as the last one ended; the end can be braked."""
    for seed in range(10):
        result = plan_trajectory(
            HALL,
            SLOW,
            (0.5, 2.0, 0.0, 0.0),
            BEFORE_WALL,
            algorithm=algorithm,
            goal_radius=0.2,
            goal_speed=0.5,
            seed=seed,
            time_limit=math.inf,
        )
        motion = result.trajectory
        assert motion is not None
        gained = np.diff(motion.times)[:, np.newaxis] * motion.controls
        assert np.abs(np.diff(motion.states[:, 2:], axis=0) - gained).max() < 1e-6
        end, v = np.split(motion.states[-1], 2)
        assert HALL.is_motion_valid(end, end + v * np.hypot(*v) / (2.0 * SLOW.max_acceleration))


@pytest.mark.parametrize('goal', [(0.5, 2.0), (2.8, 2.0)], ids=['far', 'around the start'])
@pytest.mark.parametrize('algorithm', KINDS)
def test_a_start_that_must_hit_the_wall_is_an_inevitable_collision(
    algorithm: str, goal: Any
) -> None:
    result = plan_trajectory(
        HALL,
        SLOW,
        (2.8, 2.0, 1.5, 0.0),
        goal,
        algorithm=algorithm,
        goal_radius=0.3,
        seed=1,
        time_limit=math.inf,
    )
    assert result.status is PlannerStatus.INEVITABLE_COLLISION
    assert result.trajectory is None


BEGINS = [START, state(0.75, 0.75, 1.5, 0.0), state(0.75, 0.9, 1.6, 1.0)]


#: Every planner with every boundary that it plans for.
BOUNDARIES_OF = [(kind, 'forbidden') for kind in KINDS] + [
    (kind, 'inelastic') for kind in KINDS[1:]
]


@pytest.mark.parametrize(('algorithm', 'boundary'), BOUNDARIES_OF)
def test_no_step_is_shorter_than_a_nanosecond(algorithm: str, boundary: str) -> None:
    driven, shortest = algorithm != 'kinodynamic_connect', math.inf
    given: dict[str, Any] = {'algorithm': algorithm, 'boundary': boundary, 'goal_radius': 0.5}
    if driven:
        given |= {'time_step': 0.4}
    for begin in BEGINS[:2] if driven else BEGINS:
        for seed in range(2):
            trajectory = solve(begin, seed=seed, **given).trajectory
            assert trajectory is not None
            shortest = min(shortest, float(np.diff(trajectory.times).min()))
    assert shortest >= 1e-9


CERTAIN = {
    'head on, past the stopping distance': state(4.6, 0.75, 1.9, 0.0),
    'between two walls': state(3.0, 1.45, 0.0, 1.9),
    'at a slant into a corner': state(5.2, 0.5, 1.4, -1.4),
}
ESCAPES = {
    'at rest': START,
    'slow': state(3.0, 0.75, 0.0, 0.6),
    'along the arm': state(2.0, 0.75, 1.9, 0.0),
    'turning away is enough': state(0.75, 0.9, 1.6, 1.0),
}


@pytest.mark.parametrize('begin', CERTAIN.values(), ids=CERTAIN.keys())
@pytest.mark.parametrize('algorithm', ['auto', 'kinodynamic_rrt', 'kinodynamic_hit_and_run'])
def test_an_inevitable_collision_is_proved(algorithm: str, begin: Any) -> None:
    result = solve(begin, algorithm=algorithm, goal_radius=0.5)
    assert result.status is PlannerStatus.INEVITABLE_COLLISION
    assert 'can neither stop' in result.message and result.iterations == 0


@pytest.mark.parametrize('begin', ESCAPES.values(), ids=ESCAPES.keys())
def test_no_collision_is_called_inevitable_that_is_not(begin: Any) -> None:
    assert solve(begin).status is PlannerStatus.SOLVED


def test_proofs_of_collision_hold_against_random_driving() -> None:
    """Whatever 300 random motions do, none outlives the proof; the hybrid solves the others."""
    rng = np.random.default_rng(8)
    seen = {True: 0, False: 0}
    for _ in range(40):
        v = rng.normal(size=2)
        v *= rng.uniform(0.5, 2.0) / np.hypot(*v)
        begin = state(*rng.uniform((0.1, 0.1), (5.9, 1.4)), *v)
        result = solve(begin, time_limit=0.1)
        proved = result.status is PlannerStatus.INEVITABLE_COLLISION
        seen[proved] += 1
        assert proved or result.status in (PlannerStatus.SOLVED, PlannerStatus.TIMEOUT)
        if proved:
            assert not any(survives(begin, rng) for _ in range(300))
    assert min(seen.values()) > 8


def survives(begin: Any, rng: np.random.Generator) -> bool:
    """Drive at random by full acceleration for four seconds, looking every hundredth."""
    x, v = begin[:2].copy(), begin[2:].copy()
    angle, h = rng.uniform(0.0, 2.0 * np.pi), 0.01
    for k in range(400):
        if k % 50 == 0:
            angle += rng.normal()
        v = v + h * np.array([math.cos(angle), math.sin(angle)])
        x = x + h * v
        if not SPACE.contains(x):
            return False
    return True


def test_an_inelastic_boundary_makes_no_collision_inevitable() -> None:
    begin = CERTAIN['head on, past the stopping distance']
    given = {'algorithm': 'kinodynamic_rrt', 'boundary': 'inelastic', 'goal_radius': 0.5}
    result = solve(begin, simplify=False, **given)
    assert result.status is PlannerStatus.SOLVED
    assert faults(result, INTEGRATOR, BLOCKED, inelastic=True) == []
