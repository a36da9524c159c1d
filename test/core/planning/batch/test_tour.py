"""Tours: no order of few stops is shorter, and many are ordered well."""

from itertools import permutations
import math
from test.laws import maps

from hnr_planner.core import distances, GridSpace, RequestError, tour
from hnr_planner.core.planning.batch import order
from hnr_planner.core.planning.batch.order import length_in_order, shortest_order
from hnr_planner.core.planning.limits import Budget
import numpy as np
import pytest

NO_LIMIT = Budget(math.inf)
BLOCKED = maps.rooms(30, 30, 8, seed=2)
SPACE = GridSpace.from_blocked(BLOCKED)


def table(points: np.ndarray) -> np.ndarray:
    """Return the straight distances (k, k) between points (k, 2)."""
    return np.hypot(*(points[:, None] - points).transpose(2, 0, 1))


def free_stops(n: int, seed: int) -> np.ndarray:
    """Return free points (n, 2) of the rooms, all in one component."""
    cells = np.argwhere(SPACE.largest_component())
    rows = np.random.default_rng(seed).choice(len(cells), size=n, replace=False)
    return SPACE.cell_centres(*cells[rows].T)


@pytest.mark.parametrize('closed', [False, True])
@pytest.mark.parametrize('n', [1, 2, 3, 6])
def test_no_order_of_few_stops_is_shorter(n: int, closed: bool):
    stops = free_stops(n, seed=n)
    lengths = distances(SPACE, stops)
    found = tour(SPACE, stops, closed=closed)
    orders = [np.array([0, *rest]) for rest in permutations(range(1, n))]
    least = min(length_in_order(lengths, each, closed=closed) for each in orders)
    assert found.order[0] == 0 and sorted(found.order.tolist()) == list(range(n))
    assert found.length == pytest.approx(least, rel=1e-12)
    assert found.length == length_in_order(lengths, found.order, closed=closed)


@pytest.mark.parametrize('closed', [False, True])
@pytest.mark.parametrize('seed', range(4))
def test_the_local_search_finds_the_best_order_of_twelve(
    monkeypatch: pytest.MonkeyPatch, closed: bool, seed: int
):
    lengths = table(np.random.default_rng(seed).random((12, 2)))
    best = shortest_order(lengths, closed=closed, budget=NO_LIMIT)
    monkeypatch.setattr(order, 'EXACT_MAX', 3)
    found = shortest_order(lengths, closed=closed, budget=NO_LIMIT)
    assert found[0] == 0 and sorted(found.tolist()) == list(range(12))
    assert length_in_order(lengths, found, closed=closed) == pytest.approx(
        length_in_order(lengths, best, closed=closed), rel=1e-12
    )


@pytest.mark.parametrize('closed', [False, True])
def test_sixty_stops_on_a_circle_are_taken_one_after_the_other(closed: bool):
    angles = np.random.default_rng(3).permutation(60) * math.pi / 30.0
    lengths = table(np.stack([np.cos(angles), np.sin(angles)], axis=1))
    found = shortest_order(lengths, closed=closed, budget=NO_LIMIT)
    side = 2.0 * math.sin(math.pi / 60.0)
    expected = (60 if closed else 59) * side
    assert length_in_order(lengths, found, closed=closed) == pytest.approx(expected, rel=1e-9)


def test_the_same_stops_give_the_same_order():
    stops = free_stops(20, seed=5)
    first, second = (tour(SPACE, stops, n_jobs=n) for n in (1, 2))
    np.testing.assert_array_equal(first.order, second.order)
    assert first.length == second.length


def test_a_stop_out_of_reach_makes_the_length_infinite():
    blocked = np.zeros((9, 9), dtype=bool)
    blocked[:, 4] = True
    found = tour(GridSpace.from_blocked(blocked), [(1.5, 1.5), (7.5, 1.5), (1.5, 3.5)])
    assert found.length == math.inf and found.order.tolist() == [0, 1, 2]


def test_a_time_limit_of_nothing_leaves_the_order_as_it_is():
    found = tour(SPACE, free_stops(5, seed=1), time_limit=0.0)
    assert found.length == math.inf and found.order.tolist() == [0, 1, 2, 3, 4]


@pytest.mark.parametrize(
    ('stops', 'words'),
    [
        (np.empty((0, 2)), 'points must be 1 to 200 stops, got 0'),
        (np.zeros((201, 2)), 'points must be 1 to 200 stops, got 201'),
        ([(0.0, math.inf)], 'points must be finite'),
    ],
)
def test_malformed_stops_are_refused(stops: np.ndarray, words: str):
    with pytest.raises(RequestError, match=words):
        tour(SPACE, stops)
