"""Roadmaps of both kinds: which kind a space has, pure answers, and what is refused."""

from concurrent.futures import ThreadPoolExecutor
from functools import cache
import math
import pickle
from test.laws import maps
import threading

from hnr_planner.core import (
    BoxSpace,
    Cancelled,
    GridSpace,
    plan,
    PlannerStatus,
    PlanResult,
    RequestError,
    Roadmap,
)
from hnr_planner.core.planning.roadmap.data import empty_roadmap
from hnr_planner.core.planning.roadmap.sampled import SampledRoadmap
import numpy as np
import pytest

BLOCKED = maps.rooms(40, 50, 10, seed=4)
SPACE = GridSpace.from_blocked(BLOCKED, 0.1, (2.0, -1.0, 0.4))
START, GOAL = (SPACE.cell_centres(*k) for k in np.argwhere(SPACE.largest_component())[[0, -1]])


@cache
def shared() -> Roadmap:
    """Return the roadmap of SPACE that most tests ask; built when first needed."""
    return Roadmap.build(SPACE, seed=0)


def ask(roadmap: Roadmap, start, goal, **settings) -> PlanResult:
    settings = {'seed': 0, 'time_limit': math.inf} | settings
    return plan(roadmap.space, start, goal, algorithm=roadmap, **settings)


def same(a: PlanResult, b: PlanResult) -> bool:
    return a.status is b.status and np.array_equal(a.path, b.path)


def free_pairs(n: int, seed: int) -> list:
    free, rng = np.argwhere(SPACE.largest_component()), np.random.default_rng(seed)
    return [SPACE.cell_centres(*free[rng.integers(len(free), size=2)].T) for _ in range(n)]


def test_the_samples_of_an_answer_are_its_path():
    result = ask(shared(), START, GOAL)
    assert result.iterations == 0
    np.testing.assert_allclose(result.samples, result.path, atol=1e-12)
    np.testing.assert_array_equal(result.parents, np.arange(-1, len(result.path) - 1))


def test_answers_are_the_same_again_in_any_order_and_from_any_thread():
    pairs = free_pairs(40, seed=8)
    first = [ask(shared(), *pairs[k], seed=k) for k in range(40)]
    backwards = [ask(shared(), *pairs[k]) for k in reversed(range(40))][::-1]
    with ThreadPoolExecutor(8) as pool:
        at_once = list(pool.map(lambda pair: ask(shared(), *pair), pairs))
    assert all(map(same, first, backwards))
    assert all(map(same, first, at_once))


def test_a_seed_reproduces_a_roadmap_and_has_no_effect_on_a_grid():
    assert Roadmap.build(SPACE, seed=7).seed == 7
    pairs = free_pairs(10, seed=1)
    for other in (Roadmap.build(SPACE, seed=7), Roadmap.build(SPACE), shared().grow()):
        assert all(same(ask(shared(), *pair), ask(other, *pair)) for pair in pairs)
    assert shared().grow() == shared()


def test_a_change_leaves_the_roadmap_before_it_as_it_was():
    pairs = free_pairs(20, seed=1)
    before, nodes = [ask(shared(), *pair) for pair in pairs], shared().nodes
    blocked = BLOCKED.copy()
    blocked[13:17, 14:18] ^= True
    shared().update(GridSpace.from_blocked(blocked, SPACE.resolution, SPACE.origin))
    np.testing.assert_array_equal(shared().nodes, nodes)
    assert all(map(same, before, (ask(shared(), *pair) for pair in pairs)))


def test_a_roadmap_tells_its_size():
    assert shared().nbytes > 100 * len(shared().nodes)
    assert repr(shared()).startswith(
        f'Roadmap({SPACE!r}, nodes={len(shared().nodes)}, megabytes=0.'
    )


def test_a_copy_by_pickle_answers_for_its_own_space():
    copy = pickle.loads(pickle.dumps(shared()))
    assert same(ask(copy, START, GOAL), ask(shared(), START, GOAL))


def test_an_update_may_change_the_kind_of_space():
    box = BoxSpace((0.0, 0.0), (1.0, 1.0))
    of_box = Roadmap(7, SampledRoadmap(empty_roadmap(box)))
    assert shared()._kind.repaired(box, 0, None) is None  # else built: seconds of compilation
    there = of_box.update(SPACE)
    assert there.seed == 7
    assert same(ask(there, START, GOAL), ask(shared(), START, GOAL))


# -- refused -------------------------------------------------------------------------------------


def test_a_request_for_another_space_is_refused_with_a_hint_to_update():
    twin = GridSpace.from_blocked(BLOCKED, SPACE.resolution, SPACE.origin)
    for goal in (GOAL, START):
        with pytest.raises(RequestError, match='update'):
            plan(twin, START, goal, algorithm=shared())
    assert ask(shared().update(twin), START, GOAL).status is PlannerStatus.SOLVED


def test_distances_in_a_space_that_is_no_grid_are_refused():
    of_box = Roadmap(0, SampledRoadmap(empty_roadmap(BoxSpace((0.0, 0.0), (1.0, 1.0)))))
    with pytest.raises(RequestError, match='this roadmap is of a BoxSpace'):
        of_box.distances([(0.1, 0.1)], [(0.9, 0.9)])


@pytest.mark.parametrize('seed', [-1, 1.5, 'one'])
@pytest.mark.parametrize('space', [SPACE, BoxSpace((0.0, 0.0), (1.0, 1.0))], ids=['grid', 'box'])
def test_a_seed_that_is_none_is_refused(space, seed: object):
    with pytest.raises(RequestError, match='seed'):
        Roadmap.build(space, seed=seed)  # type: ignore[arg-type]


def test_a_space_that_is_not_of_the_plane_is_refused():
    with pytest.raises(RequestError, match='must have dimension 2, this BoxSpace has 3'):
        Roadmap.build(BoxSpace((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)))


def test_building_can_be_cancelled():
    cancel = threading.Event()
    cancel.set()
    for work in (
        lambda: Roadmap.build(SPACE, seed=0, cancel=cancel),
        lambda: shared().update(GridSpace.from_blocked(BLOCKED), cancel=cancel),
    ):
        with pytest.raises(Cancelled):
            work()


def test_a_request_that_nothing_can_answer_says_why():
    inside = SPACE.cell_centres(*np.argwhere(BLOCKED)[0])
    assert ask(shared(), inside, GOAL).status is PlannerStatus.INVALID_START
    assert ask(shared(), START, inside).status is PlannerStatus.INVALID_GOAL
