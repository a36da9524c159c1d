"""Trajectories of a car to a pose or a position: drivable, free, within limits, at rest."""

import math
from test.core.trajectories.worlds import BLOCKED, CAR, faults, GOAL, in_map, ORIGIN, SPACE

from hnr_planner.core import GridSpace, plan_trajectory, PlannerStatus, RequestError
import numpy as np
import pytest

pytestmark = pytest.mark.interpreted

PATIENT = {'time_limit': math.inf, 'max_iterations': 5000}
START = np.append(in_map(0.75, 0.75), [ORIGIN[2], 0.0])
POSE = np.append(GOAL, ORIGIN[2] + 0.3)


def solve(start=START, goal=POSE, **options):
    return plan_trajectory(SPACE, CAR, start, goal, **{'seed': 1, **PATIENT, **options})


def reversals(trajectory):
    ways = np.sign(trajectory.states[:, 3])
    ways = ways[ways != 0.0]
    return np.count_nonzero(ways[1:] != ways[:-1])


def check(result, goal, start=START):
    """Assert that a trajectory is free and within the limits, and ends at rest at the goal."""
    assert result.status is PlannerStatus.SOLVED, result.message
    assert faults(result, CAR, BLOCKED) == []
    states = result.trajectory.states
    np.testing.assert_array_equal(states[0], start)
    np.testing.assert_allclose(states[-1, :2], goal[:2], atol=1e-9)
    if len(goal) == 3:
        turn = (states[-1, 2] - goal[2] + np.pi) % (2.0 * np.pi) - np.pi
        assert abs(turn) < 1e-9
    assert states[-1, 3] == 0.0


@pytest.mark.parametrize('goal', [POSE, GOAL], ids=['a pose', 'a position'])
def test_a_car_reaches_its_goal_at_rest_without_many_reversals(goal):
    result = solve(goal=goal)
    check(result, goal)
    assert result.planner == 'hit_and_run_connect'
    assert reversals(result.trajectory) <= 4


@pytest.mark.parametrize('speed', [0.6, -0.6])
def test_a_car_that_moves_goes_on_or_is_braked_first(speed):
    start = np.append(in_map(1.5, 0.75), [ORIGIN[2], speed])
    check(solve(start), POSE, start)


def test_a_straight_way_is_driven_in_the_least_time():
    space = GridSpace.from_blocked(np.zeros((20, 60), dtype=bool), 0.25)
    for way, fastest in ((9.0, 9.0 / 2.0 + 2.0), (2.25, 3.0)):
        goal = (1.0 + way, 2.0, 0.0)
        result = plan_trajectory(space, CAR, (1.0, 2.0, 0.0, 0.0), goal, seed=1, **PATIENT)
        assert result.trajectory.duration == pytest.approx(fastest, abs=1e-9)


def test_a_goal_region_and_a_free_heading_are_kept():
    result = solve(goal_radius=0.5, heading_tolerance=0.2)
    assert math.dist(result.trajectory.states[-1, :2], POSE[:2]) <= 0.5
    assert abs(result.trajectory.states[-1, 2] - POSE[2]) % (2.0 * np.pi) <= 0.2


def test_start_equal_to_goal_is_a_trajectory_of_no_time():
    result = solve(goal=START[:3])
    assert result.status is PlannerStatus.SOLVED
    assert result.trajectory.duration == 0.0


def test_the_same_seed_gives_the_same_trajectory_to_the_last_bit():
    one, other = solve().trajectory, solve().trajectory
    np.testing.assert_array_equal(one.states, other.states)


def test_what_cannot_be_is_named():
    wall = np.append(in_map(5.9, 0.75), [ORIGIN[2], 1.5])
    doomed = solve(wall)
    assert doomed.status is PlannerStatus.INEVITABLE_COLLISION
    assert 'can neither stop before the boundary' in doomed.message
    assert solve(goal=in_map(1.0, 1.6)).status is PlannerStatus.INVALID_GOAL
    with pytest.raises(RequestError, match='goal must be a position'):
        solve(goal=(1.0, 2.0, 0.0, 0.0))
    with pytest.raises(RequestError, match="no setting 'max_step'"):
        solve(max_step=1.0)
