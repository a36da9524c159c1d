"""The answer to a request: every status, every refusal, the clock and the seed."""

import math
import subprocess
import sys
from test.brute_force import path_collisions
from test.core.planning.searches import plan
from test.laws import maps
import threading
import time

from hnr_planner.core import ALGORITHMS, GridSpace, PlannerStatus, RequestError, RRT, warm_up
from hnr_planner.maps import spiral
import numpy as np
import pytest

BLOCKED = maps.rooms(60, 80, 10, seed=4)
SPACE = GridSpace.from_blocked(BLOCKED, 0.1)
START, GOAL = SPACE.cell_centres(2, 2), SPACE.cell_centres(57, 75)

NARROW = spiral(0.4)
HARD = GridSpace.from_blocked(NARROW.blocked, NARROW.resolution)


@pytest.fixture(scope='module', autouse=True)
def compiled() -> None:
    """Keep the compiler out of what tests here measure by the clock."""
    warm_up('paths')


def hard(**arguments):
    return plan(HARD, NARROW.start, NARROW.goal, algorithm='rrt', seed=0, **arguments)


def walled_off() -> GridSpace:
    blocked = np.zeros((20, 20), dtype=bool)
    blocked[:, 10] = True
    return GridSpace.from_blocked(blocked)


# -- solved --------------------------------------------------------------------------------------


@pytest.mark.parametrize('algorithm', ALGORITHMS)
def test_the_same_seed_gives_the_same_result_to_the_last_bit(algorithm: str):
    request = {'algorithm': algorithm, 'seed': 9, 'optimize_iterations': 2}
    first, second = (plan(SPACE, START, GOAL, **request, time_limit=math.inf) for _ in range(2))
    np.testing.assert_array_equal(first.path, second.path)
    np.testing.assert_array_equal(first.samples, second.samples)
    assert first.iterations == second.iterations
    assert not first.cut_by_time
    other = plan(SPACE, START, GOAL, algorithm=algorithm, seed=10)
    if algorithm != 'polyanya':  # which draws nothing
        assert other.path.shape != first.path.shape or (other.path != first.path).any()


def test_a_fresh_seed_is_reported_and_gives_the_result_again():
    fresh = plan(SPACE, START, GOAL)
    again = plan(SPACE, START, GOAL, seed=fresh.seed)
    np.testing.assert_array_equal(again.path, fresh.path)
    assert len({plan(SPACE, START, GOAL).seed for _ in range(5)}) > 1


@pytest.mark.parametrize('algorithm', ALGORITHMS)
@pytest.mark.parametrize('goal_radius', [0.0, 0.5])
def test_start_equal_to_goal_is_solved_by_two_equal_points(algorithm: str, goal_radius: float):
    result = plan(SPACE, START, START, algorithm=algorithm, goal_radius=goal_radius)
    assert result.status is PlannerStatus.SOLVED
    np.testing.assert_array_equal(result.path, [START, START])
    assert result.length == 0.0
    assert result.iterations == 0


def test_the_first_solution_is_kept_beside_the_simplified_path():
    raw = plan(SPACE, START, GOAL, algorithm='hit_and_run', seed=3, simplify=False)
    result = plan(SPACE, START, GOAL, algorithm='hit_and_run', seed=3)
    assert result.first_solution.length == raw.length == raw.first_solution.length
    assert result.length < raw.length
    assert result.first_solution.elapsed <= result.elapsed
    np.testing.assert_array_equal(result.first_solution.path, raw.path)
    np.testing.assert_array_equal(raw.first_solution.path, raw.path)
    assert len(result.paths) == 1 and result.paths[0] is result.path


@pytest.mark.parametrize('origin', [(3.0, -2.0, 0.7), (5e5, 5e6, -1.2)])
@pytest.mark.parametrize('algorithm', ALGORITHMS)
def test_what_is_returned_is_free_in_the_caller_s_coordinates(algorithm: str, origin):
    """Turned, and in a national grid, where coordinates are rounded to 2e-8 of a cell."""
    blocked = maps.rooms(40, 50, 8, seed=1)
    space = GridSpace.from_blocked(blocked, 0.05, origin)
    free = np.argwhere(space.largest_component())
    rng = np.random.default_rng(1)
    for seed in range(40):
        start, goal = space.cell_centres(*free[rng.integers(len(free), size=2)].T)
        result = plan(space, start, goal, algorithm=algorithm, seed=seed)
        assert result.status is PlannerStatus.SOLVED
        assert space.contains(result.samples).all()
        np.testing.assert_array_equal(result.samples[0], start)
        assert space.first_blocked_segment(result.path) is None


#: A planner that further searches improve; auto ends once the shortest path is proved.
SAMPLING = {'algorithm': 'hit_and_run_connect'}


def test_more_searches_never_give_a_longer_path():
    once = plan(SPACE, START, GOAL, seed=4, **SAMPLING)
    often = plan(SPACE, START, GOAL, seed=4, optimize_iterations=20, **SAMPLING)
    assert often.length < once.length
    assert often.iterations > once.iterations
    assert often.first_solution.length == once.first_solution.length
    assert path_collisions(often.path, BLOCKED, 0.1) == []


def test_optimizing_for_a_time_is_bounded_by_a_count_of_searches():
    """The clock has no part in it where it does not cut: the same seed, the same path."""
    once, *often = (
        plan(SPACE, START, GOAL, seed=4, optimize_for=t, **SAMPLING) for t in (0, 5, 5)
    )
    assert often[0].length < once.length
    assert not often[0].cut_by_time
    np.testing.assert_array_equal(often[0].path, often[1].path)
    assert often[0].iterations == often[1].iterations


def test_the_clock_cuts_what_is_optimized_for_a_time():
    began = time.perf_counter()
    request = {'seed': 4, 'optimize_for': 0.2, 'optimize_iterations': 10**9, **SAMPLING}
    result = plan(SPACE, START, GOAL, **request)
    assert 0.2 <= time.perf_counter() - began < 30.0
    assert result.status is PlannerStatus.SOLVED
    assert result.cut_by_time


def test_optimizing_ends_where_nothing_is_gained():
    """Two rooms and a door: after a few searches there is nothing to be had."""
    blocked = np.zeros((20, 40), dtype=bool)
    blocked[:, 20] = True
    blocked[10, 20] = False
    space = GridSpace.from_blocked(blocked)
    few, many = (plan(space, (5.0, 3.0), (35.0, 3.0), seed=1, optimize_for=t) for t in (1, 100))
    assert few.iterations == many.iterations


def test_inputs_are_not_changed():
    start, goal = START.copy(), GOAL.copy()
    plan(SPACE, start, goal, seed=0)
    np.testing.assert_array_equal(start, START)
    np.testing.assert_array_equal(goal, GOAL)


def test_counts_are_those_of_all_searches():
    """RRT rejects a share of its proposals in each search."""
    request = {'algorithm': 'rrt', 'seed': 4, 'time_limit': math.inf}
    counts = [
        plan(SPACE, START, GOAL, optimize_iterations=n, **request).counts['rejected_proposals']
        for n in (0, 1, 5)
    ]
    assert 0 < counts[0] < counts[1] < counts[2]


def test_a_result_shows_what_it_is_without_its_arrays():
    shown = repr(plan(SPACE, START, GOAL, seed=4))
    assert shown.startswith('PlanResult(SOLVED, length=') and 'vertices=' in shown
    assert 'array' not in shown and len(shown) < 150


# -- refused at once -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ('start', 'words'),
    [
        ((-1.0, 1.0), 'outside the map'),
        ((0.0, 0.0), 'on the edge of the map'),
        ((10.5, 5.5), 'occupied'),
        ((11.0, 5.5), 'on the edge of a blocked cell'),
    ],
)
def test_a_start_that_is_not_free(start: tuple[float, float], words: str):
    assert BLOCKED[5, 10] and not BLOCKED[5, 11]
    result = plan(GridSpace.from_blocked(BLOCKED), start, (2.5, 2.5), seed=0)
    assert result.status is PlannerStatus.INVALID_START
    assert words in result.message and f'{start[0]:g}' in result.message
    assert result.path.shape == (0, 2) and result.paths == ()
    assert result.length == math.inf
    assert result.first_solution is None


FAR_AWAY = """
import numpy as np
from hnr_planner.core import ALGORITHMS, GridSpace, plan
space = GridSpace.from_blocked(np.zeros((50, 50), bool), 0.1, (0.0, 0.0, 0.4))
kinds = [{'algorithm': name} for name in ALGORITHMS]
for kind in (*kinds, {'clearance': 0.5}, {'alternatives': 2}):
    for start, goal in (((1e9, 1e9), (0.0, 1.0)), ((0.0, 1.0), (-1e9, 1e9))):
        print(plan(space, start, goal, **kind).status.name)
"""


def test_ends_far_from_the_map_are_refused_by_the_first_request_of_a_process_too():
    """What it compiles must not look at them: nothing has been checked by then."""
    done = subprocess.run(
        [sys.executable, '-c', FAR_AWAY], capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stderr
    assert set(done.stdout.split()) == {'INVALID_START', 'INVALID_GOAL'}


def test_a_goal_that_is_not_free():
    result = plan(SPACE, START, (1.05, 0.5))
    assert result.status is PlannerStatus.INVALID_GOAL
    assert 'occupied' in result.message


def test_inflated_and_unknown_are_named():
    data = np.zeros((20, 20), dtype=np.int8)
    data[10, 10], data[3, 3] = 100, -1
    space = GridSpace.from_occupancy(data, 0.1, robot_radius=0.25)
    near = plan(space, (0.5, 1.5), (1.25, 1.05))
    assert near.status is PlannerStatus.INVALID_GOAL
    assert 'robot radius of 0.25 m' in near.message
    unknown = plan(space, (0.35, 0.35), (1.5, 0.5))
    assert unknown.status is PlannerStatus.INVALID_START
    assert 'unknown' in unknown.message


@pytest.mark.parametrize('algorithm', ALGORITHMS)
def test_unreachable_is_proved_without_a_search(algorithm: str):
    result = plan(walled_off(), (5, 5), (15, 5), algorithm=algorithm, time_limit=math.inf)
    assert result.status is PlannerStatus.UNREACHABLE
    assert result.iterations == 0 and len(result.samples) == 0
    assert 'no path exists' in result.message


def test_no_path_passes_between_diagonal_obstacles():
    blocked = np.eye(12, dtype=bool)
    space = GridSpace.from_blocked(blocked)
    assert plan(space, (9.5, 1.5), (1.5, 9.5)).status is PlannerStatus.UNREACHABLE


def test_a_goal_region_across_the_wall_counts_when_it_reaches_over():
    space = walled_off()
    assert plan(space, (5, 5), (11.5, 5), goal_radius=1.4).status is PlannerStatus.UNREACHABLE
    over = plan(space, (5, 5), (11.5, 5), goal_radius=1.9, seed=0, algorithm='hit_and_run')
    assert over.status is PlannerStatus.SOLVED
    assert over.path[-1][0] < 10.0
    assert plan(space, (5, 5), (10.5, 5), goal_radius=0.4).status is PlannerStatus.INVALID_GOAL
    assert plan(space, (5, 5), (10.5, 5), goal_radius=0.9).status is PlannerStatus.SOLVED


# -- stopped -------------------------------------------------------------------------------------


def test_a_time_limit_ends_the_call_and_the_result_states_it():
    began = time.perf_counter()
    result = hard(time_limit=0.1)
    assert 0.1 <= time.perf_counter() - began < 2.0
    assert result.status is PlannerStatus.TIMEOUT
    assert result.cut_by_time
    assert str(result.iterations) in result.message
    assert len(result.samples) > 1 and result.path.shape == (0, 2)


def test_a_limit_on_transitions_is_exact_and_repeatable():
    first, second = hard(max_iterations=777), hard(max_iterations=777)
    assert first.status is PlannerStatus.ITERATION_LIMIT
    assert first.iterations == second.iterations == 777
    assert not first.cut_by_time
    np.testing.assert_array_equal(first.samples, second.samples)


def test_a_cancelled_search_ends_and_says_so():
    cancel = threading.Event()
    threading.Timer(0.2, cancel.set).start()
    began = time.perf_counter()
    result = hard(time_limit=30.0, cancel=cancel)
    assert result.status is PlannerStatus.CANCELLED
    assert 0.1 < time.perf_counter() - began < 5.0


def test_a_search_that_only_rejects_still_hears_the_clock():
    """A winding corridor of 23 cells in nine million, which RRT's sampler rarely hits."""
    blocked = np.ones((3000, 3000), dtype=bool)
    for turn in range(6):
        blocked[1500 + 2 * turn, 1500:1503] = False
        blocked[1501 + 2 * turn, 1500 + 2 * (turn % 2 == 0)] = False
    space = GridSpace.from_blocked(blocked)
    began = time.perf_counter()
    result = plan(space, (1500.5, 1500.5), (1500.5, 1511.5), algorithm='rrt', time_limit=0.2)
    assert time.perf_counter() - began < 2.0
    assert result.status is PlannerStatus.TIMEOUT
    assert result.counts['rejected_proposals'] > 1000


def test_threads_plan_side_by_side_and_get_what_they_get_alone():
    alone = [plan(SPACE, START, GOAL, seed=seed).path for seed in range(8)]
    together = [None] * 8

    def run(seed: int) -> None:
        together[seed] = plan(SPACE, START, GOAL, seed=seed, time_limit=30.0).path

    threads = [threading.Thread(target=run, args=(seed,)) for seed in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for a, b in zip(alone, together, strict=True):
        np.testing.assert_array_equal(a, b)


def test_a_call_that_was_cut_says_so_and_no_other_does():
    chain = {'algorithm': 'hit_and_run', 'seed': 3, 'time_limit': 30.0}
    assert not plan(SPACE, START, GOAL, **chain).cut_by_time
    assert not plan(SPACE, START, START + 0.01, time_limit=0.0).cut_by_time
    endless = {'optimize_for': 0.05, 'optimize_iterations': 10**9, **SAMPLING}
    assert plan(SPACE, START, GOAL, seed=3, **endless).cut_by_time
    cancelled = threading.Event()
    cancelled.set()
    assert plan(SPACE, START, GOAL, cancel=cancelled, **chain).cut_by_time


def test_a_goal_that_the_map_s_turn_rounds_into_a_wall_ends_all_the_same():
    """The goal lies on a line between free cells and rounds beyond it on the way back."""
    blocked = np.zeros((60, 60), dtype=bool)
    blocked[:, 45:] = blocked[40:, :] = True
    space = GridSpace.from_blocked(blocked, 0.05, (1.59, -29.58, 0.5))
    goal = (3.146091805017091, -27.735290246340803)
    assert space.contains(goal)
    start = space.cell_centres(5, 5)
    for algorithm in ALGORITHMS:
        result = plan(space, start, goal, algorithm=algorithm, goal_radius=0.3, time_limit=5.0)
        assert result.status is PlannerStatus.SOLVED
        assert space.first_blocked_segment(result.path) is None


def test_a_straight_path_is_not_searched_again():
    began = time.perf_counter()
    result = plan(SPACE, START, START + 0.01, optimize_for=20.0, time_limit=30.0)
    assert time.perf_counter() - began < 10.0
    assert result.status is PlannerStatus.SOLVED and not result.cut_by_time


def test_a_region_larger_than_a_large_map_costs_little():
    """A goal that is blocked, and a region over all sixteen million cells."""
    blocked = np.zeros((4000, 4000), dtype=bool)
    blocked[1990:2010, 1990:2010] = True
    space = GridSpace.from_blocked(blocked)
    result = plan(space, (10.5, 10.5), (2000.0, 2000.0), goal_radius=1e5, time_limit=5.0, seed=0)
    assert result.status is PlannerStatus.SOLVED
    nearest = space.nearest_reachable((10.5, 10.5), (2000.0, 2000.0), 1e5)
    np.testing.assert_allclose(np.abs(nearest - 2000.0).max(), 10.0, atol=1e-4)


# -- malformed -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        ({'start': (math.nan, 0.0)}, 'start must be finite'),
        ({'goal': (0.0, math.inf)}, 'goal must be finite'),
        ({'start': (1.0, 2.0, 3.0)}, r'start must have shape'),
        ({'goal': 'there'}, "goal must be numbers, got 'there'"),
        ({'goal_radius': -0.1}, 'goal_radius must be in'),
        ({'goal_radius': math.nan}, 'goal_radius must be in'),
        ({'time_limit': math.nan}, 'time_limit must be in'),
        ({'time_limit': -1.0}, 'time_limit must be in'),
        ({'max_iterations': 0}, 'max_iterations must be at least 1, got 0'),
        ({'max_iterations': 1.5}, 'max_iterations must be a whole number, got 1.5'),
        ({'seed': -1}, 'seed must be at least 0, got -1'),
        ({'optimize_for': -1.0}, 'optimize_for must be in'),
        (
            {'algorithm': 'dijkstra'},
            "one of auto, hit_and_run, rrt, .*, got 'dijkstra'",
        ),
        ({'algorithm': 'hit_and_run', 'max_step': 1.0}, "no setting 'max_step'"),
        ({'algorithm': 'rrt', 'step': 1.0}, "no setting 'step'; it has max_step"),
        ({'algorithm': 'rrt', 'max_step': 0.0}, 'max_step must be above 0'),
        ({'algorithm': None}, 'algorithm must be a name or a planner value, got None'),
        ({'algorithm': RRT}, 'algorithm must be a name or a planner value'),
        ({'algorithm': 'rrt', 'max_step': 'far'}, "max_step must be a number, got 'far'"),
        ({'start': (10**400, 1)}, 'start must be numbers'),
        ({'algorithm': RRT(), 'max_step': 1.0}, 'go with the name of a planner only'),
        ({'clearance': -1.0}, 'clearance must be in'),
        ({'clearance': 0.1, 'simplify': False}, 'clearance must be 0 when simplify is false'),
        ({'alternatives': 2, 'simplify': False}, 'alternatives must be 1 when simplify is false'),
        ({'cancel': True}, 'cancel must be an event'),
        ({'system': None}, 'plan takes no system: .* plan_trajectory'),
        ({'goal_speed': 0.0}, 'plan takes no goal_speed: .* plan_trajectory'),
    ],
)
def test_a_malformed_argument_is_a_value_error_that_names_the_value(arguments, words: str):
    request = {'start': START, 'goal': GOAL, **arguments}
    with pytest.raises(RequestError, match=words) as caught:
        plan(SPACE, request.pop('start'), request.pop('goal'), **request)
    assert isinstance(caught.value, ValueError)
