"""The paper's two planners, each against its definition, and what holds for every planner."""

from itertools import pairwise
import math
from test.brute_force import blocked_cells, chord_by_search, path_collisions
from test.core.planning.searches import plan, start_search
from test.laws import maps
from test.sweeps import sweep_but

from hnr_planner.core import ALGORITHMS, GridSpace, PlannerStatus, RRT
from hnr_planner.core.kernels.streams import normal, stream, uniform
from hnr_planner.maps import spiral
import numpy as np
import pytest

NAMES = [name for name in ALGORITHMS if name != 'auto']
BLOCKED = maps.rooms(60, 80, 10, seed=4)
ORIGIN = (2.0, -1.0, 0.4)
SPACE = GridSpace.from_blocked(BLOCKED, 0.1, ORIGIN)
START, GOAL = SPACE.cell_centres(2, 2), SPACE.cell_centres(57, 75)
SEEDS = sweep_but([0], range(5))


# -- every planner -------------------------------------------------------------------------------


@pytest.mark.parametrize('algorithm', ALGORITHMS)
@pytest.mark.parametrize('simplify', [False, True])
@pytest.mark.parametrize('seed', SEEDS)
def test_paths_are_free_and_end_where_they_should(algorithm: str, simplify: bool, seed: int):
    result = plan(SPACE, START, GOAL, algorithm=algorithm, seed=seed, simplify=simplify)
    assert result.status is PlannerStatus.SOLVED
    assert path_collisions(result.path, BLOCKED, 0.1, ORIGIN) == []
    np.testing.assert_array_equal(result.path[[0, -1]], [START, GOAL])
    lengths = np.hypot(*np.diff(result.path, axis=0).T)
    assert result.length == pytest.approx(lengths.sum(), rel=1e-12)


@pytest.mark.parametrize('algorithm', NAMES)
@pytest.mark.parametrize('seed', SEEDS)
def test_random_maps_with_a_robot(algorithm: str, seed: int):
    occupied = maps.speckle(80, 100, 0.01, seed)
    blocked = blocked_cells(occupied, 0.05, 0.12)
    space = GridSpace.from_blocked(occupied, 0.05, robot_radius=0.12)
    free = np.argwhere(space.largest_component())
    rng = np.random.default_rng(seed)
    for _ in range(10):
        start, goal = space.cell_centres(*free[rng.integers(len(free), size=2)].T)
        result = plan(space, start, goal, algorithm=algorithm, seed=seed)
        assert result.status is PlannerStatus.SOLVED
        assert path_collisions(result.path, blocked, 0.05) == []


@pytest.mark.parametrize('algorithm', NAMES)
def test_every_edge_of_the_search_is_free(algorithm: str):
    result = plan(SPACE, START, GOAL, algorithm=algorithm, seed=7)
    np.testing.assert_allclose(result.samples[0], START, atol=1e-12)
    assert (result.parents < np.arange(len(result.parents))).all()
    assert result.parents[0] == -1
    for child, parent in zip(result.samples, result.parents, strict=True):
        if parent >= 0:
            edge = [result.samples[parent], child]
            assert path_collisions(edge, BLOCKED, 0.1, ORIGIN) == []


@pytest.mark.parametrize('algorithm', NAMES)
@pytest.mark.parametrize('goal_radius', [0.0, 2.0])
def test_batches_of_any_size_give_the_same_search(algorithm: str, goal_radius: float):
    searches = []
    for batch in (1, 7, 100_000):
        search = start_search(algorithm, maps.rooms(60, 60, 10, seed=5), 3, goal_radius)
        while not search.solved:
            search.advance(batch)
        searches.append(search)
    for search in searches[1:]:
        assert search.iterations == searches[0].iterations
        assert search.counts == searches[0].counts
        np.testing.assert_array_equal(search.samples, searches[0].samples)
        np.testing.assert_array_equal(search.parents, searches[0].parents)


@pytest.mark.parametrize('algorithm', NAMES)
def test_a_solved_search_stays_as_it_is(algorithm: str):
    search = start_search(algorithm, maps.rooms(40, 40, 10, seed=5), 3)
    while not search.solved:
        search.advance(1000)
    before = search.samples.copy()
    search.advance(1000)
    np.testing.assert_array_equal(search.samples, before)


@pytest.mark.parametrize('algorithm', NAMES)
def test_with_a_radius_the_path_ends_in_the_ball(algorithm: str):
    result = plan(SPACE, START, GOAL, algorithm=algorithm, goal_radius=0.4, seed=1, simplify=False)
    assert result.status is PlannerStatus.SOLVED
    assert np.hypot(*(result.path[-1] - GOAL)) <= 0.4
    assert path_collisions(result.path, BLOCKED, 0.1, ORIGIN) == []


@pytest.mark.parametrize('algorithm', ['hit_and_run', 'rrt'])
def test_the_paper_s_planners_stop_at_the_first_sample_in_the_ball(algorithm: str):
    result = plan(SPACE, START, GOAL, algorithm=algorithm, goal_radius=0.4, seed=1, simplify=False)
    from_goal = np.hypot(*(result.samples - GOAL).T)
    assert from_goal[-1] <= 0.4 < from_goal[:-1].min()
    np.testing.assert_allclose(result.path[-1], result.samples[-1], atol=1e-12)


# -- Hit-and-Run, by its definition --------------------------------------------------------------


def test_hit_and_run_is_a_uniform_direction_and_a_uniform_point_of_its_chord():
    """Walk the same chain by hand: same stream, chords from exact rational arithmetic."""
    blocked = maps.TWO_ROOMS
    search = start_search('hit_and_run', blocked, seed=11, goal_radius=1e-12)
    search.advance(40)
    rng = stream(11)
    x = np.array([1.5, 1.5])
    for sample in search.samples[1:]:
        u = np.array([normal(rng), normal(rng)])
        u /= np.hypot(*u)
        lower, upper = map(float, chord_by_search(blocked, x - 1.0, u))
        x = x + (lower + (upper - lower) * uniform(rng)) * u
        np.testing.assert_allclose(sample, x, atol=1e-9)
        x = sample
    np.testing.assert_array_equal(search.parents, np.arange(-1, 40))


def test_the_path_of_hit_and_run_is_its_whole_chain():
    result = plan(SPACE, START, GOAL, algorithm='hit_and_run', seed=2, simplify=False)
    assert len(result.path) == len(result.samples) + 1 == result.iterations + 2
    np.testing.assert_allclose(result.path[:-1], result.samples, atol=1e-12)


# -- RRT, by its definition ----------------------------------------------------------------------


def grow_by_definition(blocked, rng, vertices, parents, margin: float) -> int:
    """Handle one proposal as the paper says; return how many draws fell outside the space."""
    rows, columns = blocked.shape
    rejected = -1
    free = False
    while not free:
        rejected += 1
        proposal = np.array([columns * uniform(rng), rows * uniform(rng)])
        free = not blocked[int(proposal[1]), int(proposal[0])]
    parent = int(np.argmin([np.sum((proposal - v) ** 2) for v in vertices]))
    u = proposal - vertices[parent]
    reach = float(chord_by_search(blocked, vertices[parent], u)[1])
    length = np.hypot(*u)
    s = 1.0 if reach > 1.0 else reach - margin / length
    if s * length > margin:
        vertices.append(vertices[parent] + s * u)
        parents.append(parent)
    return rejected


def test_rrt_extends_the_nearest_vertex_to_the_farthest_visible_point():
    blocked = maps.TWO_ROOMS
    search = start_search('rrt', blocked, seed=5, goal_radius=1e-12)
    search.advance(60)
    rng = stream(5)
    vertices, parents = [np.array([0.5, 0.5])], [-1]
    margin = 1e-9 * math.hypot(*blocked.shape)
    rejected = sum(grow_by_definition(blocked, rng, vertices, parents, margin) for _ in range(60))
    assert search.iterations == 60
    assert search.counts == {'rejected_proposals': rejected}
    np.testing.assert_array_equal(search.parents, parents)
    # How far before a wall a vertex stops is of no interest here: about 1e-8 of a cell.
    np.testing.assert_allclose(search.samples - 1.0, vertices, atol=1e-6)
    assert rejected > 0
    assert len(vertices) > 30


def test_the_path_of_rrt_is_the_branch_of_its_last_vertex():
    search = start_search('rrt', maps.rooms(60, 60, 10, seed=5), 3)
    while not search.solved:
        search.advance(100)
    path = search.path
    np.testing.assert_array_equal(path[-1], search.problem.goal)
    np.testing.assert_array_equal(path[[0, -2]], search.samples[[0, -1]])
    rows = [int(np.flatnonzero((search.samples == x).all(axis=1))[0]) for x in path[:-1]]
    assert [int(search.parents[k]) for k in rows[1:]] == rows[:-1]


def test_a_longest_step_holds_for_every_edge():
    result = plan(SPACE, START, GOAL, algorithm=RRT(max_step=0.5), seed=2, simplify=False)
    assert result.status is PlannerStatus.SOLVED
    edges = result.samples[1:] - result.samples[result.parents[1:]]
    assert np.hypot(*edges.T).max() <= 0.5 + 1e-9
    by_name = plan(SPACE, START, GOAL, algorithm='rrt', max_step=0.5, seed=2, simplify=False)
    np.testing.assert_array_equal(by_name.path, result.path)


def test_hundred_thousand_vertices_keep_their_nearest_parents():
    """A goal that is never reached; the last vertices against brute force over those before."""
    search = start_search('rrt', np.zeros((50, 50), dtype=bool), seed=1, goal_radius=1e-12)
    search.advance(100_000)
    assert len(search.samples) == 100_001
    for k in range(99_000, 100_001, 50):
        squared = ((search.samples[:k] - search.samples[k]) ** 2).sum(axis=1)
        assert search.parents[k] == squared.argmin()


# -- trees from both ends -----------------------------------------------------------------------


CONNECTING = pytest.mark.parametrize('algorithm', ['hit_and_run_connect', 'rrt_connect'])


@CONNECTING
@pytest.mark.parametrize('seed', range(5))
def test_connect_has_a_tree_at_each_end_and_the_path_is_a_branch_of_each(
    algorithm: str, seed: int
):
    search = start_search(algorithm, maps.rooms(60, 60, 10, seed=5), seed)
    assert not search.solved
    while not search.solved:
        search.advance(100)
    samples, parents = search.samples, search.parents
    np.testing.assert_array_equal(np.flatnonzero(parents == -1), [0, 1])
    np.testing.assert_array_equal(samples[:2], [search.problem.start, search.problem.goal])
    rows = [int(np.flatnonzero((samples == x).all(axis=1))[0]) for x in search.path]
    assert (rows[0], rows[-1]) == (0, 1)
    bridges = [(a, b) for a, b in pairwise(rows) if parents[b] != a and parents[a] != b]
    assert len(bridges) == 1


@CONNECTING
def test_connect_finds_into_a_region_whose_centre_is_blocked(algorithm: str):
    centre = SPACE.cell_centres(55, 70)
    assert not SPACE.contains(centre)
    result = plan(SPACE, START, centre, algorithm=algorithm, goal_radius=0.3, seed=1)
    assert result.status is PlannerStatus.SOLVED
    assert np.hypot(*(result.path[-1] - centre)) <= 0.3
    assert (result.parents == -1).sum() == 1
    assert path_collisions(result.path, BLOCKED, 0.1, ORIGIN) == []


@pytest.mark.parametrize('width', [0.4, 0.8, 1.6])
def test_connect_never_fails_on_a_spiral(width: float):
    problem = spiral(width)
    space = GridSpace.from_blocked(problem.blocked, problem.resolution)
    for seed in range(30):
        result = plan(
            space, problem.start, problem.goal, algorithm='hit_and_run_connect', seed=seed
        )
        assert result.status is PlannerStatus.SOLVED


@CONNECTING
def test_connect_plants_no_tree_where_the_start_cannot_get(algorithm: str):
    """The region's centre lies in a sealed box, and the region reaches out of it."""
    blocked = np.zeros((40, 40), dtype=bool)
    blocked[25:36, 25:36] = True
    blocked[28:33, 28:33] = False
    blocked[:30, 10] = True
    space = GridSpace.from_blocked(blocked)
    result = plan(space, (2.5, 2.5), (30.5, 30.5), algorithm=algorithm, goal_radius=8.0, seed=0)
    assert result.status is PlannerStatus.SOLVED
    assert np.hypot(*(result.path[-1] - (30.5, 30.5))) <= 8.0
    assert all(space.connected((2.5, 2.5), sample) for sample in result.samples)
    assert (result.parents == -1).sum() == 1
