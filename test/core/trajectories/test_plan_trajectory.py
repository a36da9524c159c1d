"""``plan_trajectory``: ends, limits, statuses, bad input, and time."""

import math
from pathlib import Path
import subprocess
import sys
from test.core.trajectories.worlds import (
    BLOCKED,
    CAR,
    faults,
    GOAL,
    in_map,
    INTEGRATOR,
    SPACE,
    space_of,
    START,
    state,
)
import threading
from typing import Any

from hnr_planner.core import (
    HnrError,
    plan,
    plan_trajectory,
    PlannerStatus,
    TrajectoryResult,
)
from hnr_planner.core.planning.planners.hit_and_run import HitAndRun
from hnr_planner.core.systems import DoubleIntegrator
from hnr_planner.core.trajectories.rrt import KinodynamicRRT
import numpy as np
import pytest


def solve(start: Any = START, goal: Any = GOAL, **given: Any) -> TrajectoryResult:
    """Plan in the serpentine; no clock limits it unless asked for."""
    arguments = {'system': INTEGRATOR, 'seed': 1, 'time_limit': math.inf, **given}
    system = arguments.pop('system')
    return plan_trajectory(SPACE, system, start, goal, **arguments)


# -- where it ends


def test_without_a_radius_it_ends_exactly_at_the_goal_and_at_rest_if_asked() -> None:
    result = solve(goal_speed=0.0)
    assert faults(result, INTEGRATOR, BLOCKED) == []
    assert result.trajectory is not None
    assert result.trajectory.states[-1].tolist() == [*GOAL, 0.0, 0.0]


@pytest.mark.parametrize('speed', [0.0, 0.3, math.inf])
@pytest.mark.parametrize('radius', [0.0, 0.4])
def test_the_end_lies_in_the_goal_region_and_is_slow_enough(radius: float, speed: float) -> None:
    result = solve(goal_radius=radius, goal_speed=speed, optimize_iterations=1)
    assert faults(result, INTEGRATOR, BLOCKED) == []
    assert result.trajectory is not None
    end = result.trajectory.states[-1]
    assert np.hypot(*(end[:2] - GOAL)) <= radius + 1e-9
    assert np.hypot(*end[2:]) <= speed + 1e-9


def test_more_freedom_at_the_goal_makes_it_shorter() -> None:
    def duration(**given: Any) -> float:
        trajectory = solve(optimize_iterations=2, **given).trajectory
        assert trajectory is not None
        return trajectory.duration

    resting = duration(goal_speed=0.0)
    assert duration() < resting - 0.5
    assert duration(goal_radius=0.5) < duration() - 0.1


def test_a_start_in_the_goal_region_stays_there() -> None:
    result = solve(goal=START[:2])
    assert result.status is PlannerStatus.SOLVED and result.iterations == 0
    assert result.trajectory is not None
    assert result.trajectory.duration == 0.0
    assert result.trajectory.states.tolist() == [START.tolist()] * 2
    assert result.path.tolist() == [START[:2].tolist()] * 2
    assert faults(result, INTEGRATOR, BLOCKED) == []


def test_a_start_at_the_goal_that_is_too_fast_comes_back() -> None:
    result = solve(state(2.0, 0.75, 1.0, 0.0), in_map(2.0, 0.75), goal_speed=0.0)
    assert result.status is PlannerStatus.SOLVED
    assert faults(result, INTEGRATOR, BLOCKED) == []
    assert result.trajectory is not None
    assert result.trajectory.duration > 1.0
    assert result.trajectory.states[-1, 2:].tolist() == [0.0, 0.0]


# -- time


def test_smoothing_makes_it_shorter_again_and_again() -> None:
    durations = []
    for given in ({'simplify': False}, {}, {'optimize_iterations': 1}, {'optimize_iterations': 4}):
        result = solve(goal_radius=0.5, **given)
        assert faults(result, INTEGRATOR, BLOCKED) == []
        assert result.trajectory is not None and result.first_solution is not None
        durations.append(result.trajectory.duration)
    assert durations == sorted(durations, reverse=True)
    assert durations[1] < 0.9 * durations[0] and durations[3] < 0.99 * durations[1]


def test_a_trajectory_is_known_between_its_times() -> None:
    trajectory = solve().trajectory
    assert trajectory is not None
    times = np.linspace(0.0, trajectory.duration, 1000)
    states = trajectory.at(times)
    assert np.array_equal(trajectory.at(trajectory.times), trajectory.states)
    assert np.array_equal(trajectory.at([-1.0, 1e9]), trajectory.states[[0, -1]])
    slopes = np.diff(states[:, :2], axis=0) / np.diff(times)[:, None]
    means = (states[1:, 2:] + states[:-1, 2:]) / 2.0
    assert np.abs(slopes - means).max() < 1e-2
    ways = np.hypot(*np.diff(states[:, :2], axis=0).T).sum()
    assert trajectory.length == pytest.approx(ways, rel=1e-3)


def test_limits_on_work_end_it_in_words() -> None:
    given = {'algorithm': 'kinodynamic_rrt', 'goal_radius': 0.1}
    assert solve(max_iterations=5, **given).status is PlannerStatus.ITERATION_LIMIT
    late = solve(time_limit=0.0, **given)
    assert late.status is PlannerStatus.TIMEOUT and late.cut_by_time
    assert late.trajectory is None and len(late.path) == 0 and late.length == math.inf
    event = threading.Event()
    event.set()
    assert solve(cancel=event, **given).status is PlannerStatus.CANCELLED


# -- what cannot be


def test_ends_that_are_no_good_are_named() -> None:
    wall = in_map(1.0, 1.6)
    assert solve(np.append(wall, [0.0, 0.0])).status is PlannerStatus.INVALID_START
    assert solve(goal=wall).status is PlannerStatus.INVALID_GOAL
    blocked = BLOCKED.copy()
    blocked[6] = True
    result = plan_trajectory(space_of(blocked), INTEGRATOR, START, GOAL)
    assert result.status is PlannerStatus.UNREACHABLE and 'no path exists' in result.message


#: Moving in from far outside, and stopping inside, as far as the bounds are concerned.
FIRST_REQUEST = """
import sys
sys.path.insert(0, '.')
from hnr_planner.core import GridSpace, plan_trajectory
from hnr_planner.core.planning.planners.hit_and_run import HitAndRun
from hnr_planner.core.systems import DoubleIntegrator
from hnr_planner.core.trajectories.rrt import KinodynamicRRT
import numpy as np
space = GridSpace.from_blocked(np.zeros((20, 20), bool), 0.5)
system = DoubleIntegrator(max_speed=1e5)
for start in ((-5e7, 5.0, (1e8 + 10.0) ** 0.5, 0.0), (2.0, 5.0, 0.0, 0.0)):
    print(plan_trajectory(space, system, start, (8.0, 8.0), seed=0).status.name)
"""


def test_a_start_outside_the_map_harms_no_request_to_come(tmp_path: Path) -> None:
    """In a process of its own: the first request compiles, before anybody looks at its ends."""
    script = tmp_path / 'first_request.py'
    script.write_text(FIRST_REQUEST)
    done = subprocess.run(
        [sys.executable, script], capture_output=True, text=True, cwd=Path(__file__).parents[4]
    )
    assert (done.returncode, done.stdout) == (0, 'INVALID_START\nSOLVED\n'), done.stderr


def test_a_start_at_rest_beside_the_goal_takes_one_step() -> None:
    goal = START[:2] + [5e-9, 0.0]
    trajectory = solve(goal=goal).trajectory
    assert trajectory is not None
    assert np.diff(trajectory.times).min() >= 1e-9
    assert np.array_equal(trajectory.positions[-1], goal)


# -- options


def test_without_simplifying_the_hybrid_drives_the_path_as_it_was_found() -> None:
    raw, short = solve(simplify=False), solve()
    assert raw.first_solution is not None and short.first_solution is not None
    assert np.array_equal(raw.first_solution.path, raw.path)
    assert np.array_equal(short.first_solution.path, raw.path)
    assert short.first_solution.length == raw.length
    assert short.length < raw.length
    assert raw.trajectory is not None and short.trajectory is not None
    assert short.trajectory.duration < raw.trajectory.duration
    assert faults(raw, INTEGRATOR, BLOCKED) == []


def test_a_short_time_to_optimize_takes_nothing_from_the_shortening_of_every_request() -> None:
    plain, optimized = solve(), solve(optimize_for=1e-9)
    assert plain.trajectory is not None and optimized.trajectory is not None
    assert np.array_equal(plain.trajectory.states, optimized.trajectory.states)


def test_a_planner_value_brings_its_boundary() -> None:
    given = {'goal_radius': 0.5, 'simplify': False, 'seed': 3}
    value = solve(algorithm=KinodynamicRRT(boundary='inelastic'), **given)
    named = solve(algorithm='kinodynamic_rrt', boundary='inelastic', **given)
    assert value.trajectory is not None and named.trajectory is not None
    assert np.array_equal(value.trajectory.states, named.trajectory.states)


def test_reprs_say_what_was_found() -> None:
    result = solve()
    assert f'trajectory={result.trajectory!r}' in repr(result)
    assert 'of a DoubleIntegrator' in repr(result.trajectory)


# -- bad input

TREE_OF_A_CAR = {'system': CAR, 'algorithm': 'kinodynamic_rrt', 'goal_radius': 1.0}
BAD: dict[str, tuple[dict[str, Any], str]] = {
    'speed': ({'start': state(1.0, 1.0, 2.0, 1.0)}, 'start must be no faster than max_speed'),
    'no velocity': ({'start': START[:2]}, 'start must have shape'),
    'not finite': ({'start': START * np.nan}, 'start must be finite'),
    'goal': ({'goal': START}, 'goal must have shape'),
    'goal_speed': ({'goal_speed': -0.1}, 'goal_speed must be in 0'),
    'goal_speed nan': ({'goal_speed': math.nan}, 'goal_speed must be in 0'),
    'goal_radius': ({'goal_radius': -1.0}, 'goal_radius must be in 0'),
    'no region': ({'algorithm': 'kinodynamic_rrt'}, 'goal_radius must be above 0'),
    'no speed': (
        {'algorithm': 'kinodynamic_rrt', 'goal_radius': 1.0, 'goal_speed': 0.0},
        'goal_speed must be above 0 for kinodynamic_rrt',
    ),
    'system': ({'system': 'bicycle'}, 'system must be a system'),
    'class': ({'system': DoubleIntegrator}, 'system must be a system'),
    'dimension': ({'system': DoubleIntegrator(dim=3)}, 'dimension of the space, 2, got 3'),
    'algorithm': ({'algorithm': 'rrt'}, 'algorithm must be one of auto, kinodynamic_connect'),
    'alternatives': ({'alternatives': 2}, 'plan_trajectory takes no alternatives'),
    'clearance': ({'clearance': 0.5}, 'plan_trajectory takes no clearance'),
    'simplify a car': ({**TREE_OF_A_CAR, 'simplify': True}, 'for a Car: only'),
    'optimize a car': (
        {**TREE_OF_A_CAR, 'optimize_for': 0.1},
        'optimize_for must be 0 for a Car',
    ),
    'optimize a car again': (
        {**TREE_OF_A_CAR, 'optimize_iterations': 1},
        'optimize_iterations must be 0 for a Car',
    ),
    'optimize what is raw': (
        {'simplify': False, 'optimize_iterations': 1},
        'optimize_iterations must be 0 when simplify is false',
    ),
    'a planner of paths': ({'algorithm': HitAndRun()}, 'hit_and_run plans paths of points'),
    'hybrid at the boundary': (
        {'boundary': 'inelastic'},
        "boundary must be 'forbidden' for this kinodynamic_connect",
    ),
    'boundary of a value': (
        {'algorithm': KinodynamicRRT(), 'boundary': 'inelastic'},
        "boundary must be 'forbidden' for this kinodynamic_rrt",
    ),
    'time_step too short': (
        {'algorithm': 'kinodynamic_rrt', 'time_step': 1e-10},
        'time_step must be at least',
    ),
    'connect a car': (
        {'system': CAR, 'algorithm': 'kinodynamic_connect'},
        'connects states of a DoubleIntegrator only, got a Car',
    ),
    'boundary': ({'algorithm': 'kinodynamic_rrt', 'boundary': 'soft'}, 'boundary must be one of'),
    'transition': ({'algorithm': 'kinodynamic_rrt', 'transition': 1}, 'transition must be one of'),
    'time_step': ({'algorithm': 'kinodynamic_rrt', 'time_step': 0.0}, 'time_step must be above 0'),
    'weight': (
        {'algorithm': 'kinodynamic_rrt', 'velocity_weight': -1.0},
        'velocity_weight must be in 0',
    ),
    'setting': ({'time_step': 0.1}, "has no setting 'time_step'"),
}


@pytest.mark.parametrize(('given', 'message'), BAD.values(), ids=BAD.keys())
def test_bad_input_is_named(given: dict[str, Any], message: str) -> None:
    with pytest.raises(HnrError, match=message):
        solve(**given)


@pytest.mark.parametrize('given', [{'goal_speed': 1.0}, {'system': INTEGRATOR}])
def test_plan_names_plan_trajectory_for_a_system(given: dict[str, Any]) -> None:
    with pytest.raises(HnrError, match='plan_trajectory'):
        plan(SPACE, START[:2], GOAL, **given)
