"""
Roadmaps of grids give the shortest paths, by an independent solver and by Polyanya.

After a change of the map they equal roadmaps built from nothing.
"""

from itertools import pairwise
import math
from test.brute_force import path_collisions
from test.laws import maps
from test.visibility_graph import convex_corners, SCALE, shortest_length

from hnr_planner.core import GridSpace, plan, PlannerStatus, Polyanya, RequestError, Roadmap
from hnr_planner.core.planning.roadmap.grid.edges import Edges
from hnr_planner.core.planning.roadmap.grid.graph import build_graph, Graph, repair_graph
from hnr_planner.core.planning.roadmap.grid.landmarks import measure_landmarks
from hnr_planner.core.planning.roadmap.grid.search import shortest_paths
from hnr_planner.maps import spiral
import numpy as np
import pytest

SEEDS = range(40)
#: What margins at corners add to a length at most [cells].
MARGINS = 1e-6
#: Difference [cells] between two lengths that are equal up to rounding.
ROUNDING = 1e-8


def random_map(rng: np.random.Generator) -> np.ndarray:
    return rng.random(rng.integers(2, 10, size=2)) < rng.choice([0.15, 0.3, 0.45])


def random_points(rng: np.random.Generator, blocked: np.ndarray, n: int) -> np.ndarray:
    """Return points (n, 2) in quarters of a cell, on grid lines too."""
    rows, columns = blocked.shape
    x, y = rng.integers(1, SCALE * columns, size=n), rng.integers(1, SCALE * rows, size=n)
    return np.stack([x, y], axis=1)


def free_pairs(space: GridSpace, n: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Draw starts and goals (n, 2) uniform in free cells of any component."""
    rng, free = np.random.default_rng(seed), np.argwhere(~space.blocked)
    cells = free[rng.integers(len(free), size=(n, 2))]
    shift = space.resolution * rng.uniform(-0.5, 0.5, (n, 2, 2))
    points = space.cell_centres(cells[..., 0], cells[..., 1]) + shift
    return points[:, 0], points[:, 1]


def shortest(space: GridSpace, graph: Graph, starts, goals) -> np.ndarray:
    """Return the least lengths (k,) [cells] by a graph."""
    ends = space.to_kernel(np.asarray(starts)), space.to_kernel(np.asarray(goals))
    return shortest_paths(graph, space.data, *ends)[0]


# -- the shortest path ---------------------------------------------------------------------------


@pytest.mark.parametrize('seed', SEEDS)
def test_no_path_is_shorter(seed: int):
    rng = np.random.default_rng(seed)
    blocked = random_map(rng)
    space = GridSpace.from_blocked(blocked)
    roadmap = Roadmap.build(space, seed=seed)
    for a, b in zip(random_points(rng, blocked, 12), random_points(rng, blocked, 12), strict=True):
        if not (space.contains(a / SCALE) and space.contains(b / SCALE)):
            continue
        expected = shortest_length(blocked, tuple(map(int, a)), tuple(map(int, b)))
        result = plan(space, a / SCALE, b / SCALE, algorithm=roadmap, time_limit=math.inf)
        assert result.length == pytest.approx(expected, abs=MARGINS), (blocked, a, b)
        assert result.lower_bound == pytest.approx(expected, abs=MARGINS)
        assert (result.status is PlannerStatus.SOLVED) == math.isfinite(expected)
        if result.status is PlannerStatus.SOLVED:
            assert path_collisions(result.path, blocked, 1.0) == []


LARGE = {
    'rooms': maps.rooms(60, 80, 10, seed=4),
    'few single cells': maps.speckle(60, 80, 0.02, seed=1),
    'many single cells': maps.speckle(60, 80, 0.3, seed=2),
    'diagonals': maps.single_cells_and_diagonals(48),
    'spiral': maps.spiral(60, 6.0),
    'wide hall': maps.wide_hall(40, 90),
}


@pytest.mark.parametrize('name', LARGE)
def test_many_requests_in_one_call_agree_with_polyanya(name: str):
    space = GridSpace.from_blocked(LARGE[name])
    starts, goals = free_pairs(space, 250, seed=5)
    found = Roadmap.build(space).distances(starts, goals)
    for start, goal, length in zip(starts, goals, found, strict=True):
        result = plan(space, start, goal, algorithm=Polyanya(), time_limit=math.inf)
        assert length == pytest.approx(result.lower_bound, abs=ROUNDING), (start, goal)


def test_every_path_is_free_between_points_on_edges_of_cells_of_a_turned_map():
    blocked = LARGE['many single cells']
    space = GridSpace.from_blocked(blocked, 0.05, (-3.0, 1.0, 2.0))
    roadmap = Roadmap.build(space, seed=0)
    rng = np.random.default_rng(3)
    ends = space.from_kernel(1.0 + random_points(rng, blocked, 400) / SCALE)
    for start, goal in ends.reshape(-1, 2, 2):
        result = plan(space, start, goal, algorithm=roadmap, time_limit=math.inf)
        assert (result.status is PlannerStatus.SOLVED) == space.connected(start, goal)
        if result.status is PlannerStatus.SOLVED:
            np.testing.assert_array_equal(result.path[[0, -1]], [start, goal])
            assert path_collisions(result.path, blocked, space.resolution, space.origin) == []
            assert result.length == pytest.approx(result.lower_bound, rel=1e-6)


@pytest.mark.parametrize('width', [0.4, 1.6])
def test_a_spiral_takes_no_search(width: float):
    problem = spiral(width)
    space = GridSpace.from_blocked(problem.blocked, problem.resolution)
    roadmap = Roadmap.build(space, seed=1)
    result = plan(space, problem.start, problem.goal, algorithm=roadmap, time_limit=math.inf)
    assert result.iterations == 0
    assert result.message.endswith(', the shortest')
    assert path_collisions(result.path, problem.blocked, problem.resolution) == []


def test_ends_that_no_path_joins_have_no_distance():
    blocked = maps.drawn('..#..', '..#..', '..##.')
    roadmap = Roadmap.build(GridSpace.from_blocked(blocked, 0.5))
    starts = np.full((5, 2), 0.25)
    goals = [(2.25, 0.25), (1.25, 0.25), (9.0, 9.0), (math.nan, 0.25), (0.25, 1.25)]
    expected = [math.inf, math.inf, math.inf, math.inf, 1.0]
    np.testing.assert_array_equal(roadmap.distances(starts, goals), expected)
    assert roadmap.distances(np.empty((0, 2)), np.empty((0, 2))).shape == (0,)


@pytest.mark.parametrize(
    ('starts', 'goals', 'why'),
    [
        ((0.5, 0.5), (0.5, 0.5), r'same shape \(k, 2\), got \(2,\) and \(2,\)'),
        ([(0.5, 0.5)], np.zeros((2, 2)), r'same shape \(k, 2\), got \(1, 2\) and \(2, 2\)'),
        ([(0.5, 0.5, 0.5)], [(0.5, 0.5)], r'starts must have shape'),
        ([(0.5, 0.5)], 'near', r'goals must be numbers'),
    ],
)
def test_ends_of_the_wrong_shape_are_refused(starts, goals, why: str):
    roadmap = Roadmap.build(GridSpace.from_blocked(maps.TWO_ROOMS))
    with pytest.raises(RequestError, match=why):
        roadmap.distances(starts, goals)


def test_a_region_is_reached_whether_its_centre_is_free_or_not():
    blocked = LARGE['rooms']
    space = GridSpace.from_blocked(blocked, 0.1)
    roadmap = Roadmap.build(space, seed=0)
    start, blocked_centre = space.cell_centres(2, 2), space.cell_centres(50, 75)
    assert not space.contains(blocked_centre)
    for centre in (space.cell_centres(57, 75), blocked_centre):
        result = plan(
            space, start, centre, algorithm=roadmap, goal_radius=0.3, time_limit=math.inf
        )
        assert result.status is PlannerStatus.SOLVED
        assert np.hypot(*(result.path[-1] - centre)) <= 0.3
        exact = plan(
            space, start, centre, algorithm='polyanya', goal_radius=0.3, time_limit=math.inf
        )
        np.testing.assert_array_equal(result.path, exact.path)
        assert result.message.endswith(', the shortest')
        assert path_collisions(result.path, blocked, 0.1) == []


@pytest.mark.parametrize('blocked', [maps.ONE_CELL, np.ones((4, 6), bool), np.zeros((9, 2), bool)])
def test_a_grid_without_corners_has_a_roadmap_without_nodes(blocked: np.ndarray):
    space = GridSpace.from_blocked(blocked)
    roadmap = Roadmap.build(space, seed=0)
    assert roadmap.nodes.shape == (0, 2)
    assert roadmap.update(GridSpace.from_blocked(blocked)).nodes.shape == (0, 2)
    result = plan(space, (0.5, 0.5), (0.5, 0.6), algorithm=roadmap, time_limit=math.inf)
    status = PlannerStatus.INVALID_START if blocked.all() else PlannerStatus.SOLVED
    assert result.status is status


# -- the graph -----------------------------------------------------------------------------------


@pytest.mark.parametrize('name', LARGE)
def test_nodes_are_the_corners_of_obstacles(name: str):
    space = GridSpace.from_blocked(LARGE[name])
    nodes = Roadmap.build(space, seed=0).nodes
    assert space.contains(nodes).all()
    corners = np.round(nodes).astype(int)
    np.testing.assert_allclose(nodes, corners, atol=2.0 * space.margin)
    expected = {(x // SCALE, y // SCALE) for x, y in convex_corners(LARGE[name])}
    assert {(int(x), int(y)) for x, y in corners} == expected
    assert len(nodes) == len(expected)


@pytest.mark.parametrize('name', LARGE)
def test_every_edge_leads_back(name: str):
    edges = build_graph(GridSpace.from_blocked(LARGE[name]), None).edges
    begin = np.repeat(np.arange(len(edges.first) - 1), np.diff(edges.first))
    there = set(zip(begin.tolist(), edges.to.tolist(), strict=True))
    # Backwards a path passes a corner the other way round.
    assert there == {(b ^ 1, a ^ 1) for a, b in there}
    assert len(there) == len(edges.to)


def mutants(graph: Graph) -> dict[str, Graph]:
    """Return graphs with a mistake."""
    edges, n_states = graph.edges, len(graph.edges.first) - 1
    most_used = np.bincount(edges.to).argmax()
    missing = np.where(edges.to == most_used, most_used ^ 1, edges.to).astype(np.int32)
    lists = [edges.to[begin:end] for begin, end in pairwise(edges.first)]
    reverse = np.concatenate([some[::-1] for some in lists])
    no_last_edges = Edges(np.zeros(n_states + 1, dtype=np.int64), np.empty(0, dtype=np.int32))
    one_component = np.zeros(n_states // 2, dtype=np.int32)
    args = graph.slabs, graph.corners, edges, no_last_edges, one_component, None
    return {
        'the state most used is missing': graph._replace(edges=edges._replace(to=missing)),
        'edges are in the reverse order': graph._replace(edges=edges._replace(to=reverse)),
        'landmarks without last edges': graph._replace(landmarks=measure_landmarks(*args)),
    }


def test_wrong_graphs_give_wrong_lengths():
    """Show that the comparisons above detect mistakes."""
    space = GridSpace.from_blocked(maps.speckle(50, 60, 0.1, seed=1))
    graph, (starts, goals) = build_graph(space, None), free_pairs(space, 250, seed=5)
    right = shortest(space, graph, starts, goals)
    for name, mutant in mutants(graph).items():
        found = shortest(space, mutant, starts, goals)
        assert not np.allclose(found, right, rtol=0.0, atol=ROUNDING), name


# -- changes -------------------------------------------------------------------------------------


def arrays(value) -> list[np.ndarray]:
    if not isinstance(value, tuple):
        return [np.asarray(value)]
    return [array for member in value for array in arrays(member)]


def with_changes(rng: np.random.Generator, blocked: np.ndarray, n: int) -> np.ndarray:
    """Return a copy in which ``n`` random blocks are all blocked or all free."""
    changed = blocked.copy()
    for _ in range(n):
        row, column = rng.integers(blocked.shape)
        bottom, right = row + rng.integers(1, 5), column + rng.integers(1, 5)
        changed[row:bottom, column:right] = rng.random() < 0.5
    return changed


@pytest.mark.parametrize('seed', range(60))
def test_a_repaired_graph_equals_one_built_from_nothing(seed: int):
    rng = np.random.default_rng(seed)
    blocked = rng.random(rng.integers(1, 40, size=2)) < rng.choice([0.02, 0.1, 0.3, 0.5])
    space = GridSpace.from_blocked(blocked)
    graph = build_graph(space, None)
    for n in range(4):
        blocked = with_changes(rng, blocked, n)
        changed = GridSpace.from_blocked(blocked)
        graph, space = repair_graph(graph, space, changed, None), changed
        for repaired, built in zip(arrays(graph), arrays(build_graph(space, None)), strict=True):
            np.testing.assert_array_equal(repaired, built)
            assert repaired.dtype == built.dtype


def test_free_points_come_and_go():
    space = GridSpace.from_blocked(LARGE['rooms'])
    nothing = GridSpace.from_blocked(np.ones_like(LARGE['rooms']))
    roadmap = Roadmap.build(space, seed=0)
    empty = roadmap.update(nothing)
    assert len(empty.nodes) == 0
    np.testing.assert_array_equal(empty.update(space).nodes, roadmap.nodes)


@pytest.mark.parametrize('pad', [((0, 10), (0, 20)), ((3, 0), (0, 0))])
def test_a_map_of_another_shape_has_a_roadmap_built_from_nothing(pad):
    space = GridSpace.from_blocked(LARGE['rooms'], 0.1, (2.0, -1.0, 0.4))
    larger = GridSpace.from_blocked(np.pad(LARGE['rooms'], pad), 0.2, (0.0, 0.0, 0.0))
    updated = Roadmap.build(space, seed=0).update(larger)
    np.testing.assert_array_equal(updated.nodes, Roadmap.build(larger, seed=0).nodes)


def test_the_frame_of_a_map_may_change():
    space = GridSpace.from_blocked(LARGE['rooms'], 0.1, (2.0, -1.0, 0.4))
    moved = GridSpace.from_blocked(LARGE['rooms'], 0.2, (1.0, 3.0, -0.7))
    updated, built = Roadmap.build(space).update(moved), Roadmap.build(moved)
    np.testing.assert_array_equal(updated.nodes, built.nodes)
    ends = moved.cell_centres(2, 2), moved.cell_centres(57, 75)
    paths = [plan(moved, *ends, algorithm=x, time_limit=math.inf).path for x in (updated, built)]
    np.testing.assert_array_equal(*paths)
