"""
Roadmaps from samples: free and short paths, pure answers, as valid after a change as before.

Any space of the plane may have one, a grid too, on which paths can be checked cell by cell. No
user makes one of a grid, so nobody else needs its kernels: outside of the sweeps all runs
interpreted, on a small map and with few draws.
"""

from concurrent.futures import ThreadPoolExecutor
from functools import cache
from test.brute_force import path_collisions
from test.laws import maps
from test.sweeps import IN_FULL, sweep, sweep_but
import threading
from typing import Any

from hnr_planner.core import (
    Cancelled,
    GridSpace,
    plan,
    PlannerStatus,
    PlanResult,
    Roadmap,
)
from hnr_planner.core.planning.roadmap import sampled as module
from hnr_planner.core.planning.roadmap.build import build_data
from hnr_planner.core.planning.roadmap.data import empty_roadmap
from hnr_planner.core.planning.roadmap.sampled import SampledRoadmap
from hnr_planner.core.spaces.space import Space
from hnr_planner.maps import spiral
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as some
import numpy as np
from numpy.typing import NDArray
import pytest

pytestmark = pytest.mark.interpreted

Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]

#: Rows and columns of the map and of its rooms, draws of its roadmap, requests, other maps.
SHAPE, N_DRAWS, N_REQUESTS, N_EXAMPLES = (
    ((60, 80, 10), 4096, 50, 10) if IN_FULL else ((30, 40, 10), 128, 15, 3)
)


@pytest.fixture(autouse=True)
def number_of_draws(monkeypatch: pytest.MonkeyPatch) -> None:
    """Build roadmaps from so many draws."""
    monkeypatch.setattr(module, 'N_DRAWS', N_DRAWS)


def sampled(space: Space, seed: int, cancel: threading.Event | None = None) -> Roadmap:
    return Roadmap(seed, SampledRoadmap.build(space, seed, cancel))


RESOLUTION, ORIGIN = 0.1, (2.0, -1.0, 0.4)
BLOCKED = maps.rooms(*SHAPE, seed=4)
SPACE = GridSpace.from_blocked(BLOCKED, RESOLUTION, ORIGIN)
START, GOAL = SPACE.cell_centres(2, 2), SPACE.cell_centres(SHAPE[0] - 3, SHAPE[1] - 5)


def requests(space: GridSpace, n_requests: int, seed: int) -> Floats:
    """Draw pairs (n, 2, 2) of points in free cells of any part."""
    free, rng = np.argwhere(~space.blocked), np.random.default_rng(seed)
    cells = free[rng.integers(len(free), size=(n_requests, 2))]
    shift = space.resolution * rng.uniform(-0.4, 0.4, (n_requests, 2, 2))
    return space.cell_centres(cells[..., 0], cells[..., 1]) + shift


def check_answers(
    roadmap: Roadmap, blocked: Bools, seed: int, n_requests: int = N_REQUESTS
) -> None:
    """Ask for paths; each is there exactly when there is one, free, and as the result says."""
    space = roadmap.space
    assert isinstance(space, GridSpace)
    for start, goal in requests(space, n_requests, seed):
        result = ask(roadmap, start, goal, seed=seed)
        assert (result.status is PlannerStatus.SOLVED) == space.connected(start, goal)
        if result.status is PlannerStatus.SOLVED:
            assert path_collisions(result.path, blocked, space.resolution, space.origin) == []
            np.testing.assert_array_equal(result.path[[0, -1]], [start, goal])
            lengths = np.hypot(*np.diff(result.path, axis=0).T)
            assert result.length == pytest.approx(lengths.sum(), rel=1e-12)


def poor_roadmap(space: GridSpace, n_draws: int) -> Roadmap:
    """Return a roadmap that has hardly looked around."""
    data = build_data(empty_roadmap(space), space, n_draws, 0, None)
    return Roadmap(0, SampledRoadmap(data))


@cache
def shared() -> Roadmap:
    """Return the roadmap of SPACE that most tests ask; built when first needed."""
    return sampled(SPACE, 0)


def ask(roadmap: Roadmap, start: Floats, goal: Floats, **settings: Any) -> PlanResult:
    """Ask for a path, with more time than a compiler takes."""
    settings = {'seed': 0, 'time_limit': 100.0} | settings
    return plan(roadmap.space, start, goal, algorithm=roadmap, **settings)


def same(a: PlanResult, b: PlanResult) -> bool:
    return a.status is b.status and np.array_equal(a.path, b.path)


# -- paths ---------------------------------------------------------------------------------------


@settings(max_examples=N_EXAMPLES, deadline=None, derandomize=True)
@given(
    blocked=some.arrays(bool, st.tuples(st.integers(1, 20), st.integers(1, 20))),
    seed=st.integers(0, 1000),
)
def test_every_path_is_free_on_any_map(blocked: Bools, seed: int):
    space = GridSpace.from_blocked(blocked, 0.05, (-3.0, 1.0, 2.0))
    roadmap = sampled(space, seed)
    if not blocked.all():
        check_answers(roadmap, blocked, seed)


@pytest.mark.sweep
@pytest.mark.parametrize('density', [0.01, 0.1, 0.3])
def test_every_path_is_free_among_single_cells(density: float):
    blocked = maps.speckle(50, 70, density, seed=3)
    roadmap = sampled(GridSpace.from_blocked(blocked, 0.25, ORIGIN), 1)
    check_answers(roadmap, blocked, seed=2, n_requests=200)


@pytest.mark.sweep
def test_paths_are_short_and_take_no_search():
    lengths, shortest = [], []
    for k, (start, goal) in enumerate(requests(SPACE, 30, seed=5)):
        if SPACE.connected(start, goal) and not SPACE.is_motion_valid(start, goal):
            result = ask(shared(), start, goal)
            assert result.iterations == 0
            best = plan(SPACE, start, goal, seed=k, optimize_iterations=30, time_limit=100.0)
            lengths.append(result.length)
            shortest.append(min(result.length, best.length))
    ratios = np.array(lengths) / shortest
    assert len(ratios) > 20
    assert np.median(ratios) <= 1.001
    assert ratios.max() <= 1.05


@pytest.mark.sweep
@pytest.mark.parametrize('width', [0.4, 0.8, 1.6])
def test_a_spiral_has_a_node_at_every_turn(width: float):
    problem = spiral(width)
    space = GridSpace.from_blocked(problem.blocked, problem.resolution)
    roadmap = sampled(space, 1)
    result = ask(roadmap, problem.start, problem.goal)
    assert result.iterations == 0
    assert path_collisions(result.path, problem.blocked, problem.resolution) == []
    best = plan(space, problem.start, problem.goal, seed=0, time_limit=100.0)
    assert result.length <= 1.0005 * best.length


def test_nodes_are_corners_of_obstacles():
    cells = SPACE.to_kernel(shared().nodes)
    corner = np.round(cells).astype(int)
    assert np.abs(cells - corner).max() < 0.05
    around = sum(
        np.pad(BLOCKED, 1, constant_values=True)[corner[:, 1] - i, corner[:, 0] - j].astype(int)
        for i in (0, 1)
        for j in (0, 1)
    )
    assert np.mean(around == 1) > 0.99


def test_a_region_is_reached_whether_its_centre_is_free_or_not():
    blocked_centre = SPACE.cell_centres(SHAPE[0] - 5, SHAPE[1] - 10)
    assert not SPACE.contains(blocked_centre)
    for centre in (GOAL, blocked_centre):
        result = ask(shared(), START, centre, goal_radius=0.3)
        assert result.status is PlannerStatus.SOLVED
        assert np.hypot(*(result.path[-1] - centre)) <= 0.3
        assert path_collisions(result.path, BLOCKED, RESOLUTION, ORIGIN) == []


def test_a_region_outside_the_map_is_reached_where_it_comes_in():
    outside = SPACE.from_kernel(SPACE.to_kernel(START) - (4.0, 0.0))
    result = ask(shared(), GOAL, outside, goal_radius=0.25)
    assert result.status is PlannerStatus.SOLVED
    assert path_collisions(result.path, BLOCKED, RESOLUTION, ORIGIN) == []


@pytest.mark.parametrize('n_draws', sweep_but([0, 16], [0, 1, 16, 64]))
def test_what_a_roadmap_does_not_know_is_searched_for(n_draws: int):
    check_answers(poor_roadmap(SPACE, n_draws), BLOCKED, seed=6)


def test_the_samples_of_an_answer_are_its_path():
    result = ask(shared(), START, GOAL)
    np.testing.assert_allclose(result.samples, result.path, atol=1e-12)
    np.testing.assert_array_equal(result.parents, np.arange(-1, len(result.path) - 1))


@pytest.mark.parametrize(
    'blocked', [sweep(maps.ONE_CELL), np.ones((4, 6), bool), np.zeros((9, 2), bool)]
)
def test_a_space_without_corners_has_a_roadmap_without_nodes(blocked: Bools):
    space = GridSpace.from_blocked(blocked)
    roadmap = sampled(space, 0)
    assert roadmap.nodes.shape == (0, 2)
    assert roadmap.grow().update(GridSpace.from_blocked(blocked)).nodes.shape == (0, 2)
    result = ask(roadmap, np.array((0.5, 0.5)), np.array((0.5, 0.6)))
    assert result.status is (
        PlannerStatus.INVALID_START if blocked.all() else PlannerStatus.SOLVED
    )


# -- pure ----------------------------------------------------------------------------------------


@pytest.mark.sweep
def test_answers_are_the_same_again_in_any_order_and_from_any_thread():
    pairs = requests(SPACE, 40, seed=8)

    def answer(k: int) -> PlanResult:
        return ask(shared(), *pairs[k], seed=k)

    first = [answer(k) for k in range(len(pairs))]
    backwards = [answer(k) for k in reversed(range(len(pairs)))][::-1]
    with ThreadPoolExecutor(8) as pool:
        at_once = list(pool.map(answer, range(len(pairs))))
    assert all(map(same, first, backwards))
    assert all(map(same, first, at_once))


def test_equal_seeds_give_equal_roadmaps():
    with ThreadPoolExecutor(2) as pool:
        first, second = pool.map(lambda _: sampled(SPACE, 3), range(2))
    np.testing.assert_array_equal(first.nodes, second.nodes)
    changed = GridSpace.from_blocked(maps.rooms(*SHAPE, seed=5), RESOLUTION, ORIGIN)
    for a, b in ((first, second), (first.update(changed), second.update(changed))):
        for start, goal in requests(changed, N_REQUESTS // 3, seed=1):
            answers = [ask(x, start, goal) for x in (a, b)]
            assert same(*answers)
    assert not np.array_equal(sampled(SPACE, 4).nodes, first.nodes)


# -- changes -------------------------------------------------------------------------------------


def changed_maps() -> dict[str, Bools]:
    """Return the map with a door closed, a wall opened, a pillar more, and all of that."""
    closed, opened, pillar = BLOCKED.copy(), BLOCKED.copy(), BLOCKED.copy()
    doors = np.flatnonzero(~BLOCKED[:, 10])
    closed[doors[len(doors) // 2], 10] = True
    opened[20, 10:30] = False
    pillar[23:27, 24:28] = True
    return {
        'closed': closed,
        'opened': opened,
        'pillar': pillar,
        'all': (closed | pillar) & opened,
        'other': maps.rooms(*SHAPE, seed=7),
    }


@pytest.mark.sweep
@pytest.mark.parametrize('change', changed_maps())
def test_after_a_change_it_is_as_valid_as_a_new_one(change: str):
    blocked = changed_maps()[change]
    space = GridSpace.from_blocked(blocked, RESOLUTION, ORIGIN)
    repaired, new = shared().update(space), sampled(space, 9)
    check_answers(repaired, blocked, seed=3, n_requests=2 * N_REQUESTS)
    ratios = []
    for start, goal in requests(space, 2 * N_REQUESTS, seed=4):
        if space.connected(start, goal):
            lengths = [ask(x, start, goal).length for x in (repaired, new)]
            ratios.append(lengths[0] / lengths[1])
    assert np.quantile(ratios, 0.9) <= 1.001
    assert np.mean(ratios) <= 1.01


def test_a_change_leaves_the_roadmap_before_it_as_it_was():
    before = [ask(shared(), *pair) for pair in requests(SPACE, N_REQUESTS // 3, 1)]
    nodes = shared().nodes.copy()
    shared().update(GridSpace.from_blocked(changed_maps()['all'], RESOLUTION, ORIGIN))
    shared().grow()
    after = [ask(shared(), *pair) for pair in requests(SPACE, N_REQUESTS // 3, 1)]
    np.testing.assert_array_equal(shared().nodes, nodes)
    assert all(map(same, before, after))


def test_there_and_back_again():
    blocked = changed_maps()['all']
    there = shared().update(GridSpace.from_blocked(blocked, RESOLUTION, ORIGIN))
    check_answers(there, blocked, seed=3)
    check_answers(there.update(SPACE), BLOCKED, seed=5, n_requests=2 * N_REQUESTS)


def test_free_points_come_and_go():
    nothing = GridSpace.from_blocked(np.ones_like(BLOCKED), RESOLUTION, ORIGIN)
    empty = shared().update(nothing)
    assert len(empty.nodes) == 0
    check_answers(empty.update(SPACE), BLOCKED, seed=6)


@pytest.mark.parametrize(
    ('resolution', 'origin'), [(0.2, ORIGIN), (RESOLUTION, (0.0, 0.0, 0.0)), (0.1, (2.0, -1.0, 1))]
)
def test_the_roadmap_of_a_map_elsewhere_is_not_repaired(
    resolution: float, origin: tuple[float, float, float]
):
    kind = SampledRoadmap.build(SPACE, 0, None)
    for blocked in (BLOCKED, np.pad(BLOCKED, ((0, 10), (0, 20)))):
        assert kind.repaired(GridSpace.from_blocked(blocked, resolution, origin), 0, None) is None


def test_a_grown_roadmap_has_shorter_paths():
    blocked = maps.speckle(*SHAPE[:2], 0.05, seed=1)
    space = GridSpace.from_blocked(blocked, RESOLUTION)
    small = poor_roadmap(space, N_DRAWS // 32)
    grown = small.grow()
    assert len(grown.nodes) > len(small.nodes)
    check_answers(grown, blocked, seed=9)


# -- refused -------------------------------------------------------------------------------------


def test_building_can_be_cancelled():
    cancel = threading.Event()
    cancel.set()
    for work in (
        lambda: sampled(SPACE, 0, cancel),
        lambda: shared().update(SPACE, cancel=cancel),
        lambda: shared().grow(cancel=cancel),
    ):
        with pytest.raises(Cancelled):
            work()


def test_a_request_that_nothing_can_answer_says_why():
    inside = SPACE.cell_centres(*np.argwhere(BLOCKED)[0])
    blocked_start = ask(shared(), inside, GOAL)
    assert blocked_start.status is PlannerStatus.INVALID_START
    assert ask(shared(), START, inside).status is PlannerStatus.INVALID_GOAL
