"""Many requests at once: each has the result that ``plan`` gives it, on any number of threads."""

import math
from test.brute_force import path_collisions
from test.laws import maps
from test.visibility_graph import SCALE, shortest_length
import threading

from hnr_planner.core import (
    BoxSpace,
    distances,
    GridSpace,
    plan,
    plan_many,
    PlannerStatus,
    RequestError,
)
import numpy as np
import pytest

pytestmark = pytest.mark.interpreted

BLOCKED = maps.speckle(30, 40, 0.25, 1)
ORIGIN = (3.0, -2.0, 0.7)
SPACE = GridSpace.from_blocked(BLOCKED, 0.05, ORIGIN)
#: What margins at corners add to a length at most [cells].
MARGINS = 1e-6


def random_ends(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Return starts and goals (n, 2) anywhere on the map, blocked ones too."""
    points = np.random.default_rng(0).uniform(0.0, 1.0, (2 * n, 2)) * BLOCKED.shape[::-1]
    points = SPACE.from_cells(points)
    return points[:n], points[n:]


@pytest.mark.parametrize('goal_radius', [0.0, 0.15])
def test_every_result_is_that_of_plan(goal_radius: float):
    starts, goals = random_ends(150)
    limits = {'goal_radius': goal_radius, 'max_iterations': 40}
    batch = plan_many(SPACE, starts, goals, **limits, n_jobs=2)
    assert len(batch) == 150 and not batch.cut_by_time
    for i in range(len(batch)):
        one = plan(SPACE, starts[i], goals[i], algorithm='polyanya', time_limit=math.inf, **limits)
        assert batch.status[i] is one.status
        assert batch.length[i] == one.length
        assert batch.iterations[i] == one.iterations
        assert batch.lower_bound[i] == pytest.approx(one.lower_bound, rel=1e-12)
        np.testing.assert_array_equal(batch.path(i), one.path)
    seen = set(batch.status)
    assert {PlannerStatus.SOLVED, PlannerStatus.INVALID_START} < seen
    assert goal_radius > 0.0 or {PlannerStatus.ITERATION_LIMIT, PlannerStatus.INVALID_GOAL} < seen


def test_paths_are_free_and_the_shortest():
    rng = np.random.default_rng(2)
    blocked = rng.random((7, 9)) < 0.3
    points = rng.integers(1, [SCALE * 9, SCALE * 7], size=(60, 2))
    batch = plan_many(GridSpace.from_blocked(blocked), points[:30] / SCALE, points[30:] / SCALE)
    n_solved = 0
    for i, (a, b) in enumerate(zip(points[:30].tolist(), points[30:].tolist(), strict=True)):
        if batch.status[i] is PlannerStatus.SOLVED:
            n_solved += 1
            expected = shortest_length(blocked, tuple(a), tuple(b))
            assert batch.length[i] == pytest.approx(expected, abs=MARGINS)
            assert path_collisions(batch.path(i), blocked, 1.0) == []
    assert n_solved > 5


def test_any_number_of_threads_gives_the_same():
    starts, goals = random_ends(400)
    batches = [plan_many(SPACE, starts, goals, n_jobs=n) for n in (1, 2, 5, None)]
    for batch in batches[1:]:
        np.testing.assert_array_equal(batch.length, batches[0].length)
        assert (batch.status == batches[0].status).all()
        for i in range(len(batch)):
            np.testing.assert_array_equal(batch.path(i), batches[0].path(i))


def test_a_path_longer_than_the_room_for_it_is_whole():
    """One path of a thousand bends and more, in a chunk with room for as many in all."""
    comb = np.zeros((20, 1200), dtype=bool)
    comb[:-1, 1::4] = comb[1:, 3::4] = True
    space = GridSpace.from_blocked(comb)
    batch = plan_many(space, [(0.5, 0.5)] * 3, [(1198.5, 0.5)] * 3)
    assert (batch.status == PlannerStatus.SOLVED).all()
    assert len(batch.path(0)) > 1000
    for i in (1, 2):
        np.testing.assert_array_equal(batch.path(i), batch.path(0))


def test_what_the_clock_or_a_cancellation_ends_has_a_bound_and_no_path():
    starts, goals = random_ends(20)
    cancel = threading.Event()
    cancel.set()
    for limit, status in (
        ({'time_limit': 0.0}, PlannerStatus.TIMEOUT),
        ({'cancel': cancel}, PlannerStatus.CANCELLED),
    ):
        batch = plan_many(SPACE, starts, goals, **limit)
        assert batch.cut_by_time and (batch.status == status).all()
        assert (batch.length == math.inf).all() and batch.path(3).shape == (0, 2)
        np.testing.assert_allclose(batch.lower_bound, np.hypot(*(goals - starts).T))


def test_no_request_is_a_batch_too():
    batch = plan_many(SPACE, np.empty((0, 2)), np.empty((0, 2)))
    assert len(batch) == 0
    with pytest.raises(IndexError):
        batch.path(0)


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        (((1.0, 2.0), (1.0, 2.0)), r'starts must have shape \(k, 2\), got \(2,\)'),
        (([(1.0, 2.0)], [(1.0, 2.0)] * 2), 'must be as many, got 1 and 2'),
        (([(1.0, math.nan)], [(1.0, 2.0)]), r'starts must be finite, got \[1.0, nan\] in row 0'),
        (([(1.0, 2.0, 3.0)], [(1.0, 2.0)]), r'starts must have shape'),
    ],
)
def test_malformed_requests_are_refused(arguments: tuple, words: str):
    with pytest.raises(RequestError, match=words):
        plan_many(SPACE, *arguments)


def test_bad_options_and_other_spaces_are_refused():
    ends = [(1.0, 2.0)], [(1.0, 2.0)]
    with pytest.raises(RequestError, match='n_jobs must be at least 1, got 0'):
        plan_many(SPACE, *ends, n_jobs=0)
    with pytest.raises(RequestError, match='goal_radius must be in'):
        plan_many(SPACE, *ends, goal_radius=-1.0)
    with pytest.raises(RequestError, match='plan_many plans in a GridSpace, got a BoxSpace'):
        plan_many(BoxSpace((0.0, 0.0), (1.0, 1.0)), *ends)


# -- distances -----------------------------------------------------------------------------------


def test_distances_are_symmetric_and_those_of_plan():
    blocked = maps.TWO_ROOMS
    space = GridSpace.from_blocked(blocked)
    points = space.cell_centres(*np.argwhere(~blocked)[::7].T)
    table = distances(space, points)
    np.testing.assert_array_equal(table, table.T)
    assert (table.diagonal() == 0.0).all()
    one = plan(space, points[0], points[-1], algorithm='polyanya', time_limit=math.inf)
    assert table[0, -1] == one.length


def test_a_distance_is_infinite_where_no_path_leads():
    blocked = np.zeros((9, 9), dtype=bool)
    blocked[:, 4] = True
    table = distances(GridSpace.from_blocked(blocked), [(1.5, 1.5), (1.5, 3.5), (7.5, 1.5)])
    np.testing.assert_array_equal(table, [[0, 2, np.inf], [2, 0, np.inf], [np.inf, np.inf, 0]])


def test_a_point_that_is_not_free_is_named():
    space = GridSpace.from_blocked(np.eye(5, dtype=bool))
    with pytest.raises(RequestError, match=r'row 1 of points, \(2.5, 2.5\), is .*cell \[2, 2\]'):
        distances(space, [(0.5, 3.5), (2.5, 2.5)])
