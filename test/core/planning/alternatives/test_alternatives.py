"""Further paths: free, different by the sides they pass, the shortest of all, in order."""

from collections import deque
from collections.abc import Callable
from functools import partial
from heapq import heappop, heappush
from itertools import combinations, pairwise
import math
from test.brute_force import path_collisions
from test.laws import maps
from test.sweeps import sweep
from test.visibility_graph import convex_corners, is_visible, Point, SCALE
import threading

from hnr_planner import core
from hnr_planner.core import ALGORITHMS, GridSpace, PlannerStatus, PlanResult, RequestError
from hnr_planner.core.kernels.streams import stream
from hnr_planner.core.planning.alternatives import grid_classes
from hnr_planner.core.planning.alternatives.grid_classes import corner_graph
from hnr_planner.core.planning.alternatives.taut_search import begin
from hnr_planner.core.planning.homology import islands_at, signature
from hnr_planner.core.planning.limits import Budget
from hnr_planner.core.planning.postprocessing.simplify import shorten
from hnr_planner.maps import load_map
from hypothesis import given, settings, strategies
import numpy as np
from numpy.typing import NDArray
import pytest

Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]
# No law here is about time, however busy the machine is.
plan = partial(core.plan, time_limit=60.0)

ORIGIN = (2.0, -1.0, 0.4)
#: Small maps in one comparison with all classes.
N_MAPS = 20


def three_blocks() -> Bools:
    blocked = np.zeros((60, 60), dtype=bool)
    blocked[24:36, 24:36] = blocked[42:54, 26:34] = blocked[6:18, 27:33] = True
    return blocked


BLOCKED = three_blocks()
SPACE = GridSpace.from_blocked(BLOCKED, 0.1, ORIGIN)
START, GOAL = SPACE.cell_centres(30, 3), SPACE.cell_centres(30, 56)


# -- an independent judge ------------------------------------------------------------------------


def islands(blocked: Bools) -> list[tuple[int, int]]:
    """Return a (row, column) in each group of blocked cells not joined with the outside."""
    ringed = np.pad(blocked, 1, constant_values=True)
    seen = np.zeros_like(ringed)
    found = []
    for cell in [(0, 0), *map(tuple, np.argwhere(ringed).tolist())]:
        if seen[cell]:
            continue
        found.append((cell[0] - 1, cell[1] - 1))
        seen[cell] = True
        waiting = deque([cell])
        while waiting:
            row, column = waiting.popleft()
            for near in [(row + i, column + j) for i in (-1, 0, 1) for j in (-1, 0, 1)]:
                inside = 0 <= near[0] < ringed.shape[0] and 0 <= near[1] < ringed.shape[1]
                if inside and ringed[near] and not seen[near]:
                    seen[near] = True
                    waiting.append(near)
    return found[1:]


def windings(points: Floats, first: Floats, second: Floats) -> list[int]:
    """Return how often the loop of two paths goes round each point, from the angles it turns."""
    loop = np.concatenate([first, second[-2::-1]])
    around = []
    for point in points:
        away = loop - point
        angles = np.arctan2(*away.T[::-1])
        turned = (np.diff(angles) + math.pi) % (2 * math.pi) - math.pi
        around.append(round(float(turned.sum()) / (2 * math.pi)))
    return around


def sides_passed(points: Floats, path: Floats) -> list[int]:
    """
    Return where a path crosses the rays that go up from points: 1 + k to the right, -1 - k back.

    A crossing that is taken back at once is left out: what remains is the same for two paths with
    the same ends exactly when they can be deformed into each other without meeting a point.
    """
    passed: list[int] = []
    for a, b in pairwise(path):
        direction = 1 if a[0] < b[0] else -1
        crossed = []
        for k, (x, y) in enumerate(points):
            if (a[0] < x) != (b[0] < x):
                t = (x - a[0]) / (b[0] - a[0])
                if a[1] + t * (b[1] - a[1]) > y:
                    crossed.append((t, direction * (1 + k)))
        for _, letter in sorted(crossed):
            if passed and passed[-1] == -letter:
                passed.pop()
            else:
                passed.append(letter)
    return passed


def crosses_itself(path: Floats) -> bool:
    def side(a: Floats, b: Floats, x: Floats) -> float:
        return (b[0] - a[0]) * (x[1] - a[1]) - (b[1] - a[1]) * (x[0] - a[0])

    return any(
        side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0
        for (a, b), (c, d) in combinations(pairwise(path), 2)
    )


def length(path: Floats) -> float:
    return float(np.hypot(*np.diff(path, axis=0).T).sum())


def slack(space: GridSpace, path: Floats) -> list[int]:
    """Return the vertices at which the path could be pulled straighter: no obstacle is inside."""
    loose = []
    for k, (a, x, b) in enumerate(zip(path, path[1:], path[2:], strict=False)):
        inwards = (a - x) / math.dist(a, x) + (b - x) / math.dist(b, x)
        size = float(np.hypot(*inwards))
        if size > 1e-3 and space.contains(x + 1e-3 * space.resolution / size * inwards):
            loose.append(k + 1)
    return loose


def check(space: GridSpace, result: PlanResult, n_paths: int) -> None:
    """Hold every law of the answer to a request for alternatives."""
    assert result.status is PlannerStatus.SOLVED
    paths = result.paths
    assert 1 <= len(paths) <= n_paths
    assert paths[0] is result.path
    assert result.length == pytest.approx(length(result.path), rel=1e-12)
    lengths = [length(path) for path in paths]
    assert lengths == sorted(lengths)
    # Taut everywhere, a path is the shortest that it can be deformed into.
    assert len(paths) == 1 or ', each the shortest that it can be' in result.message
    for path in paths:
        assert slack(space, path) == []
        assert path_collisions(path, space.blocked, space.resolution, space.origin) == []
        np.testing.assert_array_equal(path[[0, -1]], result.path[[0, -1]])
    assert not any(map(crosses_itself, paths[1:]))
    centres = [space.cell_centres(*island) for island in islands(space.blocked)]
    for first, second in combinations(paths, 2):
        assert sides_passed(centres, first) != sides_passed(centres, second)


def shortest_of_classes(
    blocked: Bools, start: Point, goal: Point, n: int
) -> list[tuple[float, list[Point]]]:
    """
    Return lengths [cells] and vertices of the paths of the n shortest homology classes.

    Dijkstra's algorithm over corners and numbers of crossings of the rays that go up from the
    islands, with all edges of the full visibility graph. Start, goal and vertices are in
    ``SCALE`` units to a cell.
    """
    rays = [(SCALE * x + SCALE // 2, SCALE * y + SCALE // 2) for y, x in islands(blocked)]
    points = [start, goal, *convex_corners(blocked)]
    pairs = combinations(range(len(points)), 2)
    visible = [(i, j) for i, j in pairs if is_visible(blocked, points[i], points[j])]
    near: dict[int, list[int]] = {i: [] for i in range(len(points))}
    for i, j in visible:
        near[i].append(j)
        near[j].append(i)

    def crossed(ray: Point, a: Point, b: Point) -> int:
        (x, y), direction = ray, (1 if a[0] < b[0] else -1)
        if (a[0] < x) == (b[0] < x):
            return 0
        rise = (a[1] - y) * (b[0] - a[0]) + (x - a[0]) * (b[1] - a[1])
        return direction if direction * rise > 0 else 0

    waiting = [(0.0, (0,), (0,) * len(rays))]
    known, found = set(), []
    while waiting and len(found) < n:
        far, way, counts = heappop(waiting)
        if (way[-1], counts) in known:
            continue
        known.add((way[-1], counts))
        here = points[way[-1]]
        if way[-1] == 1:
            found.append((far / SCALE, [points[i] for i in way]))
        for j in near[way[-1]]:
            steps = [crossed(ray, here, points[j]) for ray in rays]
            after = tuple(map(sum, zip(counts, steps, strict=True)))
            heappush(waiting, (far + math.dist(here, points[j]), (*way, j), after))
    return found


def passes_a_point_twice(blocked: Bools, path: list[Point]) -> bool:
    """Return whether a path crosses itself, or passes a corner or one of its ends twice."""
    passed = path[:1]
    for a, b in pairwise(path):
        between = [
            c
            for c in {*convex_corners(blocked), path[0], path[-1]}
            if c not in (a, b)
            and (b[0] - a[0]) * (c[1] - a[1]) == (b[1] - a[1]) * (c[0] - a[0])
            and (c[0] - a[0]) * (c[0] - b[0]) + (c[1] - a[1]) * (c[1] - b[1]) < 0
        ]
        passed += [*sorted(between, key=lambda c: math.dist(a, c)), b]
    return len(set(passed)) < len(passed) or crosses_itself(np.array(passed, dtype=float))


def check_against_all_classes(seed: int) -> int:
    """
    Compare the alternatives on a small map with all classes; return the number compared.

    What is as long as the last one that either side has may be in one list only.
    """
    rng = np.random.default_rng(seed)
    blocked = rng.random((7, 9)) < rng.uniform(0.05, 0.2)
    space = GridSpace.from_blocked(blocked)
    free = np.argwhere(space.largest_component())
    (first_row, first_column), (row, column) = free[rng.integers(len(free), size=2)].tolist()
    # Not on lines through corners, and on some of them.
    offset = rng.choice([1, 2, 3], size=4).tolist()
    start = SCALE * first_column + offset[0], SCALE * first_row + offset[1]
    goal = SCALE * column + offset[2], SCALE * row + offset[3]
    if start == goal:
        return 0
    ends = np.array(start) / SCALE, np.array(goal) / SCALE
    result = plan(space, *ends, alternatives=4, seed=seed)
    check(space, result, 4)
    known = shortest_of_classes(blocked, start, goal, 40)
    lengths = [far for far, path in known if not passes_a_point_twice(blocked, path)]
    found = [length(path) for path in result.paths]
    most = math.inf if result.next_lower_bound == math.inf else found[-1] - 1e-6
    if len(known) == 40:
        most = min(most, known[-1][0] - 1e-6)
    expected, compared = ([x for x in each if x < most] for each in (lengths, found))
    assert compared == pytest.approx(expected, abs=1e-6), seed
    assert result.lower_bound == pytest.approx(lengths[0], abs=1e-6)
    assert result.next_lower_bound >= found[-1] - 1e-6
    return len(compared)


# -- what is found -------------------------------------------------------------------------------


@pytest.mark.parametrize('seed', range(30))
def test_three_blocks_have_three_paths_and_more(seed: int):
    result = plan(SPACE, START, GOAL, alternatives=3, seed=seed)
    check(SPACE, result, 3)
    assert len(result.paths) == 3


@pytest.mark.parametrize('first', [0, sweep(N_MAPS)])
def test_they_are_the_shortest_of_all_classes(first: int):
    """On small maps with up to a dozen islands, against the full visibility graph."""
    seeds = range(first, first + N_MAPS)
    assert sum(map(check_against_all_classes, seeds)) >= 2 * N_MAPS


def test_a_search_that_ends_early_has_the_shortest_and_a_true_bound(
    monkeypatch: pytest.MonkeyPatch,
):
    budget, ends = Budget(math.inf), (np.array(START), np.array(GOAL))
    whole = grid_classes.shortest_classes(SPACE, *ends, 3, budget)
    monkeypatch.setattr(grid_classes, 'LABELS_AT_ONCE', 1)
    for most in range(4):
        monkeypatch.setattr(grid_classes, 'LABELS_PER_CLASS', most)
        cut = grid_classes.shortest_classes(SPACE, *ends, 3, budget)
        n = len(cut.paths)
        assert cut.n_labels <= 3 * most and n == (3 if most == 3 else min(n, 2))
        for path, same in zip(cut.paths, whole.paths, strict=False):
            np.testing.assert_array_equal(path, same)
        assert n == 3 or cut.lower_bound <= length(whole.paths[n]) + 1e-6


def weighted(*arguments):
    """Begin a search whose estimates exceed the least lengths: it is in a hurry to the goal."""
    search = begin(*arguments)
    return search._replace(rest=2.0 * search.rest)


def without_some_edges(space, budget):
    """Return the graph without the last edge of every state, as a sweep that ends too early."""
    corners, edges = corner_graph(space, budget)
    lasts = edges.first[1:][np.diff(edges.first) > 0] - 1
    counts = np.maximum(np.diff(edges.first) - 1, 0)
    first = np.concatenate([[0], np.cumsum(counts)])
    return grid_classes.CornerGraph(
        corners, edges._replace(first=first, to=np.delete(edges.to, lasts))
    )


@pytest.mark.parametrize(
    ('name', 'mutant'), [sweep('begin', weighted), ('corner_graph', without_some_edges)]
)
def test_a_mutant_that_misses_classes_is_caught(
    name: str, mutant: Callable, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(grid_classes, name, mutant)
    with pytest.raises(AssertionError):
        test_they_are_the_shortest_of_all_classes(0)


boxes = strategies.tuples(*[strategies.integers(4, 30)] * 2, *[strategies.integers(1, 9)] * 2)


@settings(max_examples=60, deadline=None)
@given(
    strategies.lists(boxes, max_size=12),
    strategies.integers(2, 5),
    strategies.integers(0, 2**31),
    strategies.sampled_from([(0.0, 0.0, 0.0), (3.0, -2.0, 2.5)]),
)
def test_on_any_map_they_are_free_different_and_in_order(rectangles, n_paths, seed, origin):
    blocked = np.zeros((40, 40), dtype=bool)
    for row, column, height, width in rectangles:
        top, right = row + height, column + width
        blocked[row:top, column:right] = True
    space = GridSpace.from_blocked(blocked, 0.25, origin)
    start, goal = space.cell_centres(2, 2), space.cell_centres(39, 39)
    result = plan(space, start, goal, alternatives=n_paths, seed=seed)
    check(space, result, n_paths)
    assert len(result.paths) >= min(len(islands(blocked)) + 1, 2)


@pytest.mark.parametrize('seed', range(10))
def test_doors_between_rooms(seed: int):
    blocked = maps.rooms(60, 80, 10, seed=4)
    space = GridSpace.from_blocked(blocked, 0.1, ORIGIN)
    ends = space.cell_centres(2, 2), space.cell_centres(57, 75)
    result = plan(space, *ends, alternatives=3, seed=seed)
    check(space, result, 3)
    assert len(result.paths) == 3


def test_a_real_floor_with_a_robot():
    office = load_map('config/maps/office.yaml')
    space = GridSpace.from_occupancy(
        office.data, office.resolution, office.origin, robot_radius=0.22
    )
    for seed in range(2):
        result = plan(space, (3.0, 22.0), (34.0, 5.0), alternatives=3, seed=seed)
        check(space, result, 3)
        assert len(result.paths) == 3


def test_a_visible_goal_has_other_paths_too():
    start, goal = SPACE.cell_centres(39, 3), SPACE.cell_centres(39, 56)
    assert SPACE.is_motion_valid(start, goal)
    result = plan(SPACE, start, goal, alternatives=3, seed=0)
    check(SPACE, result, 3)
    assert len(result.paths) == 3
    assert result.length == pytest.approx(math.dist(start, goal))


@pytest.mark.parametrize('algorithm', ALGORITHMS)
def test_every_algorithm_has_them_and_the_same_seed_gives_the_same(algorithm: str):
    request = {'algorithm': algorithm, 'alternatives': 3, 'seed': 5}
    first, second = (plan(SPACE, START, GOAL, **request) for _ in range(2))
    check(SPACE, first, 3)
    assert not first.cut_by_time
    assert first.iterations == second.iterations
    for path, same in zip(first.paths, second.paths, strict=True):
        np.testing.assert_array_equal(path, same)


def test_ways_into_a_region_end_where_the_first_does():
    for seed in range(10):
        arguments = {'algorithm': 'rrt', 'goal_radius': 0.5, 'seed': seed}
        result = plan(SPACE, START, GOAL, alternatives=3, **arguments)
        check(SPACE, result, 3)
        assert len(result.paths) == 3
        assert math.dist(result.path[-1], GOAL) <= 0.5
        np.testing.assert_array_equal(
            result.path[-1], plan(SPACE, START, GOAL, **arguments).path[-1]
        )


def test_without_an_island_there_is_one_path_and_the_message_states_it():
    blocked = np.zeros((30, 30), dtype=bool)
    blocked[:20, 15] = True
    space = GridSpace.from_blocked(blocked)
    result = plan(space, (5, 5), (25, 5), alternatives=3, seed=0)
    check(space, result, 3)
    assert len(result.paths) == 1
    assert '1 of 3 paths' in result.message
    assert plan(SPACE, START, START, alternatives=3, seed=0).length == 0.0


def test_no_path_has_no_alternatives():
    blocked = np.zeros((20, 20), dtype=bool)
    blocked[:, 10] = True
    result = plan(GridSpace.from_blocked(blocked), (5, 5), (15, 5), alternatives=3)
    assert result.status is PlannerStatus.UNREACHABLE and result.paths == ()


def test_a_cancellation_leaves_what_was_found():
    cancel = threading.Event()
    cancel.set()
    start, goal = SPACE.cell_centres(39, 3), SPACE.cell_centres(39, 56)
    result = plan(SPACE, start, goal, alternatives=3, cancel=cancel)
    check(SPACE, result, 3)
    assert result.cut_by_time and len(result.paths) == 1


# -- each taut within its class ------------------------------------------------------------------


def detour(beyond: float) -> Floats:
    """Return a ragged path in cells that passes above the middle block, ``beyond`` it."""
    steps = [(4, 30), (10, 26), (20, 34), (25, beyond), (30, 38), (35, beyond), (45, 25), (56, 30)]
    return np.array(steps, dtype=float)


@pytest.mark.parametrize('seed', range(20))
def test_a_path_is_pulled_taut_on_its_side_of_every_island(seed: int):
    blocked = np.zeros((60, 60), dtype=bool)
    blocked[29:31, 29:31] = True
    space = GridSpace.from_blocked(blocked)
    pillar = islands_at(space.island_points)
    path = detour(beyond=50.0)
    budget, rng = Budget(math.inf), stream(seed)
    taut = shorten(space, path, rng, budget, islands=pillar)
    assert path_collisions(taut, blocked, 1.0) == []
    assert signature(pillar, space.to_kernel(taut)) == signature(pillar, space.to_kernel(path))
    assert windings([(30.0, 30.0)], path, taut) == [0]
    over = math.dist((4, 30), (29, 31)) + 2.0 + math.dist((31, 31), (56, 30))
    assert over <= length(taut) <= 1.002 * over


# -- refused -------------------------------------------------------------------------------------


class SidelessSpace(GridSpace):
    """A space without ``island_points``."""

    island_points = None


@pytest.mark.parametrize(
    ('space', 'arguments', 'words'),
    [
        (SPACE, {'alternatives': 0}, 'alternatives must be at least 1, got 0'),
        (SPACE, {'alternatives': 1.5}, 'alternatives must be a whole number, got 1.5'),
        (SPACE, {'alternatives': 2, 'simplify': False}, 'must be 1 when simplify is false, got 2'),
        (
            SidelessSpace.from_blocked(BLOCKED),
            {'alternatives': 2},
            'alternatives must be 1 in a SidelessSpace, .*, got 2',
        ),
    ],
)
def test_what_cannot_be_had_is_refused(space: GridSpace, arguments: dict, words: str):
    with pytest.raises(RequestError, match=words):
        plan(space, (5.0, 1.0), (4.0, 1.0), **arguments)
    assert plan(space, *space.cell_centres([1, 1], [1, 5]), seed=0).status is PlannerStatus.SOLVED
