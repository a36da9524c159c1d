"""Paths of robots that are not round: free, drivable, with the ends asked for."""

import math
from test.core.planning.poses.test_words import DRIVES
from test.core.spaces.poses.robots import checker, L_SHAPE, RECTANGLE

from hnr_planner.core import GridSpace, plan, PlannerStatus, PoseSpace, RequestError, RRT
from hnr_planner.core.planning.poses import searches
from hnr_planner.core.planning.poses.attempt import ADDED_AT_FIRST
from hnr_planner.core.planning.poses.search import N_ADDED
import numpy as np
import pytest

pytestmark = pytest.mark.interpreted

ALGORITHMS = ('auto', 'hit_and_run', 'rrt', 'hit_and_run_connect', 'rrt_connect')
START, GOAL = (1.5, 1.2, 0.0), (6.5, 2.2, 2.0)
PATIENT = {'time_limit': math.inf, 'max_iterations': 20_000}


def hall(footprint=RECTANGLE, **options):
    """Return the poses in a hall of 8 m by 6 m with two walls."""
    blocked = np.zeros((60, 80), dtype=bool)
    blocked[:35, 38:42] = blocked[45:, 20:24] = True
    return PoseSpace(GridSpace.from_blocked(blocked, 0.1), footprint, **options)


def check(space, result, start=START, goal=GOAL):
    """Assert that a result has a free path that the drive can make, with its ends exactly."""
    assert result.status is PlannerStatus.SOLVED, result.message
    np.testing.assert_array_equal(result.path[0], start)
    np.testing.assert_array_equal(result.path[-1], goal)
    assert checker(space).collisions(result.path, result.twists, 0.2) == []
    vx, vy, omega = result.twists.T
    assert result.length == pytest.approx(np.hypot(vx, vy).sum())
    drive = space.drive
    if drive.name != 'omnidirectional':
        assert (vy == 0.0).all()
    if drive.name == 'car':
        assert (np.abs(vx) >= drive.min_turning_radius * np.abs(omega) * (1.0 - 1e-9)).all()
    if not drive.reverse:
        assert (vx >= 0.0).all()


@pytest.mark.parametrize('algorithm', ALGORITHMS)
@pytest.mark.parametrize('drive', ['car', 'differential', 'omnidirectional'])
def test_every_planner_finds_a_drivable_path(algorithm, drive):
    space = hall(**DRIVES[drive])
    result = plan(space, START, GOAL, algorithm=algorithm, seed=1, **PATIENT)
    check(space, result)
    assert result.length <= result.first_solution.length * 1.5
    assert result.lower_bound <= result.length
    assert len(result.samples) == len(result.parents)
    assert result.parents[0] == -1


@pytest.mark.parametrize('drive', ['car ahead', 'differential ahead'])
def test_a_robot_that_must_not_reverse_drives_ahead_only(drive):
    space, goal = hall(L_SHAPE, **DRIVES[drive]), (6.5, 4.0, 0.5)
    check(space, plan(space, START, goal, seed=2, **PATIENT), goal=goal)


def test_a_car_that_must_not_reverse_turns_round_where_there_is_room():
    # It stands in a corridor that is 1.4 m wide, the goal is behind it, and the room is ahead.
    blocked = np.ones((50, 160), dtype=bool)
    blocked[20:34, 1:110] = blocked[2:48, 110:158] = False
    space = PoseSpace(GridSpace.from_blocked(blocked, 0.1), RECTANGLE, **DRIVES['car ahead'])
    start, goal = (6.0, 2.7, 0.0), (2.0, 2.7, -math.pi)
    options = {'time_limit': math.inf, 'max_iterations': 300}
    for seed in range(3):
        result = plan(space, start, goal, seed=seed, **options)
        check(space, result, start, goal)
        assert result.path[:, 0].max() > 11.0


def test_the_same_seed_gives_the_same_path_to_the_last_bit():
    space = hall(**DRIVES['car'])
    one, other, third = (plan(space, START, GOAL, seed=seed, **PATIENT) for seed in (3, 3, 4))
    np.testing.assert_array_equal(one.path, other.path)
    np.testing.assert_array_equal(one.twists, other.twists)
    assert one.path.tolist() != third.path.tolist()


def test_a_path_as_found_is_free_as_well():
    space = hall(**DRIVES['car'])
    raw = plan(space, START, GOAL, seed=5, simplify=False, **PATIENT)
    check(space, raw)
    assert raw.first_solution.length == raw.length


def price(space, result):
    """Return the cost of a path of a car: length, reverse twice, and changes of direction."""
    driven = result.twists[:, 0]
    n_changes = np.count_nonzero(np.diff(np.sign(driven)))
    radius = space.drive.min_turning_radius
    return np.abs(driven).sum() - driven[driven < 0.0].sum() + radius * n_changes


def answers_of_races(space, requests, n, monkeypatch):
    """Return the answers to requests (k, 2, 3) whose first race has at most n searches."""
    monkeypatch.setattr(searches, 'N_RACED', n)
    results = [plan(space, *request, seed=7, **PATIENT) for request in requests]
    for result, request in zip(results, requests, strict=True):
        check(space, result, *request)
    return results


@pytest.mark.sweep
def test_a_race_of_three_searches_finds_cheaper_paths_than_one_search(monkeypatch):
    blocked = np.zeros((44, 44), dtype=bool)
    for row in range(9, 11):
        blocked[row::12, 9::12] = True  # pillars that leave little room to turn
    space = PoseSpace(GridSpace.from_blocked(blocked, 0.1), RECTANGLE, **DRIVES['car'])
    poses = np.random.default_rng(0).uniform(*space.bounds, (200, 3))
    requests = poses[space.contains(poses)][:40].reshape(20, 2, 3)
    alone, raced = (answers_of_races(space, requests, n, monkeypatch) for n in (1, 3))
    costs = [sum(price(space, result) for result in results) for results in (alone, raced)]
    assert costs[1] < 0.97 * costs[0]
    for one, three in zip(alone, raced, strict=True):
        assert three.first_solution.length == one.first_solution.length
        assert three.iterations >= one.iterations


def test_a_long_search_is_not_raced(monkeypatch):
    monkeypatch.setattr(searches, 'TRANSITIONS_MAX', -1)
    space, requests = hall(**DRIVES['car']), [(START, GOAL)]
    alone, raced = (answers_of_races(space, requests, n, monkeypatch)[0] for n in (1, 3))
    np.testing.assert_array_equal(alone.path, raced.path)


@pytest.mark.sweep
def test_further_searches_never_make_a_path_dearer():
    space, saved = hall(**DRIVES['car']), []
    for goal in (GOAL, (7.0, 1.0, 2.0), (7.0, 5.0, -1.6), (5.0, 1.0, 1.5)):
        once = plan(space, START, goal, seed=6, **PATIENT)
        more = plan(space, START, goal, seed=6, optimize_iterations=12, **PATIENT)
        check(space, more, goal=goal)
        saved.append(price(space, once) - price(space, more))
    assert min(saved) >= -1e-9
    assert max(saved) > 0.01


def test_start_equal_to_goal_is_a_path_of_two_equal_poses():
    result = plan(hall(), START, START, seed=1, **PATIENT)
    assert result.status is PlannerStatus.SOLVED
    np.testing.assert_array_equal(result.path, [START, START])
    np.testing.assert_array_equal(result.twists, np.zeros((1, 3)))
    assert result.length == 0.0


def test_poses_follow_the_path_with_a_spacing():
    space = hall(**DRIVES['car'])
    result = plan(space, START, GOAL, seed=1, **PATIENT)
    poses = result.poses(0.05)
    np.testing.assert_array_equal(poses[[0, -1]], [START, GOAL])
    steps = np.hypot(*np.diff(poses[:, :2], axis=0).T)
    assert steps.max() <= 0.05 + 1e-12
    assert steps.sum() == pytest.approx(result.length, rel=1e-3)
    assert checker(space).is_free(poses).all()
    with pytest.raises(RequestError, match='spacing must be above 0'):
        result.poses(0.0)
    with pytest.raises(RequestError, match='result of a PoseSpace'):
        plan(space.grid, START[:2], GOAL[:2], seed=1).poses(0.1)


def test_a_goal_region_is_reached_within_its_tolerances():
    space = hall(**DRIVES['car'])
    options = {'goal_radius': 0.3, 'heading_tolerance': 0.5}
    result = plan(space, START, GOAL, seed=7, **options, **PATIENT)
    assert result.status is PlannerStatus.SOLVED
    assert math.dist(result.path[-1, :2], GOAL[:2]) <= 0.3
    assert abs(result.path[-1, 2] - GOAL[2]) <= 0.5
    # The goal itself is blocked, a turned one is not.
    blocked = (3.35, 3.0, 0.0)
    assert plan(space, START, blocked, seed=7).status is PlannerStatus.INVALID_GOAL
    turned = plan(space, START, blocked, seed=7, heading_tolerance=math.pi, **PATIENT)
    assert turned.status is PlannerStatus.SOLVED


@pytest.mark.sweep
def test_a_car_parks_in_a_slot_little_longer_than_itself():
    # The robot is .9 m long, and turns out of the slot of 1.3 m by strokes back and forth.
    blocked = np.zeros((60, 120), dtype=bool)
    blocked[:15, :50] = blocked[:15, 76:] = True
    space = PoseSpace(GridSpace.from_blocked(blocked, 0.05), RECTANGLE, **DRIVES['car'])
    start, goal = (1.2, 1.5, 0.0), (3.05, 0.36, 0.0)
    check(space, plan(space, start, goal, seed=1, **PATIENT), start, goal)


def test_a_way_round_is_found_where_the_shortest_path_of_the_disc_is_too_tight():
    # The gap is as wide as the robot, which touches both sides; the door is at the other end.
    blocked = np.zeros((120, 60), dtype=bool)
    blocked[:100, 29:31] = True
    blocked[10:16, 29:31] = False
    space = PoseSpace(GridSpace.from_blocked(blocked, 0.1), RECTANGLE, **DRIVES['car'])
    start, goal = (1.5, 1.3, 0.0), (4.5, 1.3, 0.0)
    options = {'time_limit': math.inf, 'max_iterations': 3000, 'simplify': False}
    solved = plan(space, start, goal, seed=1, **options)
    check(space, solved, start, goal)
    # Its nose goes round the end of the wall, at 10 m, less than its length before its origin.
    assert solved.path[:, 1].max() > 9.0


def test_ends_that_are_not_free_and_places_that_no_disc_reaches_are_named():
    space = hall()
    result = plan(space, (4.0, 1.0, 0.0), GOAL)
    assert result.status is PlannerStatus.INVALID_START
    assert 'touches the occupied cell [' in result.message
    assert plan(space, START, (8.5, 1.0, 0.0)).status is PlannerStatus.INVALID_GOAL
    blocked = np.zeros((40, 80), dtype=bool)
    blocked[:, 40] = True
    blocked[18:22, 40] = False
    narrow = PoseSpace(GridSpace.from_blocked(blocked, 0.1), RECTANGLE)
    apart = plan(narrow, (1.5, 2.0, 0.0), (6.5, 2.0, 0.0))
    assert apart.status is PlannerStatus.UNREACHABLE
    assert 'largest disc in the footprint' in apart.message
    assert apart.lower_bound == math.inf
    # The disc fits through a gap of 7 cells, and so the robot may.
    blocked[16:23, 40] = False
    wide = PoseSpace(GridSpace.from_blocked(blocked, 0.1), RECTANGLE)
    ends = (1.5, 2.0, 0.0), (6.5, 2.0, 0.0)
    check(wide, plan(wide, *ends, seed=1, **PATIENT), *ends)


def test_a_car_gets_round_walls_by_connections_along_the_guide_without_a_search():
    space = hall(**DRIVES['car'])
    for seed in range(3):
        result = plan(space, START, GOAL, seed=seed, simplify=False, **PATIENT)
        check(space, result)
        assert result.iterations == 0
        # Every vertex is an end of a motion that a tree has made, and its root is no other's.
        assert (result.parents[:2] == -1).all()
        assert (result.parents[2:] >= 0).all()


def test_a_first_attempt_gives_up_on_a_way_of_many_parts():
    # More bends than the attempt has extensions: what it has found is where the search begins.
    blocked = np.zeros((20, 1200), dtype=bool)
    blocked[:11, 30::60] = blocked[9:, 60::60] = True
    space = PoseSpace(GridSpace.from_blocked(blocked, 0.1), [(0.1, 0.1), (-0.1, 0.0), (0.1, -0.1)])
    ends = (0.5, 1.0, 0.0), (119.0, 1.0, 0.0)
    options = {'time_limit': math.inf, 'max_iterations': 1}
    result = plan(space, *ends, seed=1, **options)
    assert result.status is PlannerStatus.ITERATION_LIMIT
    assert len(result.samples) <= 2 + ADDED_AT_FIRST + N_ADDED
    assert result.samples[result.parents >= 0, 0].max() > 10.0
    assert space.contains(result.samples).all()


def test_a_search_that_is_cut_says_what_cut_it():
    space = hall(**DRIVES['car'])
    cut = plan(space, START, GOAL, algorithm='rrt', seed=1, max_iterations=1, time_limit=math.inf)
    assert cut.status is PlannerStatus.ITERATION_LIMIT
    assert cut.path.shape == (0, 3)
    assert cut.twists.shape == (0, 3)
    assert '(1 transitions' in cut.message
    assert plan(space, START, GOAL, time_limit=0.0).status is PlannerStatus.TIMEOUT


@pytest.mark.parametrize(
    ('options', 'why'),
    [
        ({'algorithm': 'polyanya'}, 'algorithm must be one of auto, hit_and_run, rrt'),
        ({'algorithm': RRT()}, 'algorithm must be one of'),
        ({'max_step': 1.0}, "no setting 'max_step'; they have heading_tolerance, reverse_penalty"),
        ({'heading_tolerance': -0.1}, 'heading_tolerance must be in 0..inf, got -0.1'),
        ({'reverse_penalty': 0.5}, 'reverse_penalty must be in 1..inf, got 0.5'),
        ({'clearance': 0.1}, 'clearance must be 0.0 in a PoseSpace'),
        ({'alternatives': 2}, 'alternatives must be 1 in a PoseSpace'),
        ({'goal_tolerance': 0.5}, 'goal_tolerance must be 0.0 in a PoseSpace'),
        ({'start_escape': 0.5}, 'start_escape must be 0.0 in a PoseSpace'),
    ],
)
def test_what_has_no_meaning_is_refused_with_the_reason(options, why):
    with pytest.raises(RequestError, match=why):
        plan(hall(), START, GOAL, **options)


def test_bad_poses_are_refused():
    for start in ((1.5, 1.2), (1.5, 1.2, math.nan)):
        with pytest.raises(RequestError, match='start must'):
            plan(hall(), start, GOAL)
