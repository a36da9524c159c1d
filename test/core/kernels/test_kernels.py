"""Compiled kernels: fresh after every edit, the same as interpreted, and never without a cache."""

import os
from pathlib import Path
import shutil
import subprocess
import sys
from test.laws import maps

from hnr_planner.core import GridSpace
from hnr_planner.core.kernels import cache_folder
from hnr_planner.core.kernels.kernel import interpreted
from hnr_planner.core.kernels.streams import stream
from hnr_planner.core.planning.alternatives import class_graph, taut_search
from hnr_planner.core.planning.homology import islands_at, NO_ISLANDS
from hnr_planner.core.planning.planner import Problem
from hnr_planner.core.planning.planners import hit_and_run_connect as connect
from hnr_planner.core.planning.planners import nearest, rrt
from hnr_planner.core.planning.planners.hit_and_run import _walk
from hnr_planner.core.planning.postprocessing import clearance as stand_off
from hnr_planner.core.planning.postprocessing import shortcuts
from hnr_planner.core.planning.roadmap.grid.corners import find_corners
from hnr_planner.core.planning.roadmap.grid.edges import Edges, scan
from hnr_planner.core.spaces.primitives import chord_or_empty
from hnr_planner.core.trees import NONE
import numpy as np
import pytest

#: In a box, whose kernels are quick to compile.
CHORD = """
from hnr_planner.core.spaces import BoxSpace
print(BoxSpace((0.0, 0.0), (3.0, 3.0)).chord((0.5, 0.5), (1.0, 0.0)).upper)
"""


def chord_of_copy(folder: Path, cache: Path) -> float:
    """Upper end of a chord, answered by a fresh Python on the copy of the package."""
    environment = dict(os.environ, PYTHONPATH=str(folder), NUMBA_CACHE_DIR=str(cache))
    done = subprocess.run(
        [sys.executable, '-c', CHORD],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=120,
        check=True,
    )
    return float(done.stdout)


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """Return a folder with a copy of the core that a test may edit."""
    core = Path(cache_folder.__file__).parents[1]
    shutil.copytree(core, tmp_path / 'hnr_planner' / 'core')
    (tmp_path / 'hnr_planner' / '__init__.py').touch()
    return tmp_path


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert text.count(old) == 1, f'{old!r} is {text.count(old)} times in {path.name}, not once'
    path.write_text(text.replace(old, new))


HALVED = ('if first < last or', 'last /= 2.0\n    if first < last or')


def test_an_edited_space_is_never_answered_from_a_stale_cache(copy: Path, tmp_path: Path):
    core = copy / 'hnr_planner' / 'core'
    assert chord_of_copy(copy, tmp_path / 'cache') == 2.5
    edit(core / 'spaces' / 'box.py', *HALVED)
    assert chord_of_copy(copy, tmp_path / 'cache') == 1.25


@pytest.mark.sweep
def test_a_cache_that_ignores_other_files_would_be_stale(copy: Path, tmp_path: Path):
    """Show that the test above can fail: it does with one folder for all sources."""
    core = copy / 'hnr_planner' / 'core'
    edit(
        core / 'kernels' / 'cache_folder.py',
        'return digest.hexdigest()[:16]',
        "return 'always the same'",
    )
    assert chord_of_copy(copy, tmp_path / 'cache') == 2.5
    edit(core / 'spaces' / 'box.py', *HALVED)
    assert chord_of_copy(copy, tmp_path / 'cache') == 2.5


def test_without_a_folder_to_write_another_takes_its_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
):
    occupied = tmp_path / 'a file'
    occupied.touch()
    monkeypatch.setenv('NUMBA_CACHE_DIR', str(occupied))
    folder = cache_folder.cache_folder.__wrapped__()
    assert folder.is_dir()
    (record,) = caplog.records
    assert 'set NUMBA_CACHE_DIR' in record.getMessage()
    monkeypatch.setenv('NUMBA_CACHE_DIR', str(cache_folder.cache_home(folder)))
    assert cache_folder.cache_folder.__wrapped__() == folder


# -- interpreted and compiled agree to the last bit ----------------------------------------------

GRID = GridSpace.from_blocked(maps.rooms(40, 40, 10, seed=1), 0.05)
LOWER, UPPER = GRID.kernel_bounds
PROBLEM = Problem(GRID.data, LOWER, UPPER, LOWER + 1.5, UPPER - 1.5, 0.0, GRID.margin, 5.0, 1.0)


def both(kernel, *arguments):
    """Run a kernel compiled and interpreted, each on arguments of its own."""
    outcomes = []
    for function in (kernel, interpreted(kernel)):
        own = [value.copy() if isinstance(value, np.ndarray) else value for value in arguments]
        outcomes.append((function(*own), own))
    return outcomes


def assert_same(compiled, plain):
    for a, b in zip(compiled, plain, strict=True):
        if isinstance(a, tuple):
            assert_same(a, b)
        elif isinstance(a, list):
            assert_same(tuple(a), tuple(b))
        else:
            np.testing.assert_array_equal(a, b)


def test_the_chord():
    rng = np.random.default_rng(3)
    directions = rng.standard_normal((300, 2))
    points = rng.uniform(LOWER, UPPER, (300, 2))
    for x, u in zip(points, directions, strict=True):
        assert chord_or_empty(GRID.data, x, u) == interpreted(chord_or_empty)(GRID.data, x, u)


def test_hit_and_run():
    chain = np.tile(PROBLEM.start, (300, 1))
    assert_same(*both(_walk, PROBLEM, stream(5), chain, 1, 300))


def test_rrt():
    compiled, plain = [], []
    for grow, insert, outcome in (
        (rrt._grow, nearest.insert, compiled),
        (interpreted(rrt._grow), interpreted(nearest.insert), plain),
    ):
        vertices, parents = np.tile(PROBLEM.start, (301, 1)), np.full(301, -1)
        tree = nearest.empty_box_tree(LOWER, UPPER, 301)
        insert(tree, vertices, 0)
        far = PROBLEM._replace(goal=np.array([-9.0, -9.0]), goal_radius=1.0)
        done = grow(far, np.inf, stream(5), vertices, parents, 1, tree, 300)
        outcome.extend([done, vertices, parents, tuple(tree)])
    assert_same(compiled, plain)


def test_hit_and_run_connect():
    for n_steps, is_solved in ((2, False), (120, True)):
        outcomes = []
        for begin in (connect._begin, interpreted(connect._begin)):
            table, trees, done = begin(PROBLEM, stream(5), n_steps)
            rows = int(table.sizes.sum())
            assert rows == 2 + done[1]
            assert (done[0][0] != NONE) == (trees is None) == is_solved
            outcomes.append([done[0], done[1:], table.vertices[:rows], table.parents[:rows]])
        assert_same(*outcomes)


@pytest.mark.parametrize('islands', [NO_ISLANDS, islands_at(GRID.island_points)])
def test_simplify(islands):
    chain = zigzag()
    kept = np.zeros(60, dtype=np.int64)
    assert_same(*both(shortcuts.skip, GRID.data, islands, chain, kept, 1, True, 100))
    assert_same(*both(shortcuts.join, GRID.data, islands, chain, stream(5), 100))
    assert_same(*both(shortcuts.pull, GRID.data, islands, chain, 1, 1e-8, 1000))


def zigzag() -> np.ndarray:
    """Points of the space, each of which sees the next."""
    chain = np.tile(PROBLEM.start, (60, 1))
    _walk(PROBLEM._replace(goal_radius=1e-9), stream(1), chain, 1, 60)
    return chain


@pytest.mark.sweep
def test_alternatives():
    points, islands = zigzag(), islands_at(GRID.island_points)
    edges = both(class_graph.near_edges, GRID.data, points, np.arange(60), 8)
    assert_same(*edges)
    graph = class_graph.class_graph(points, edges[0][0])
    assert_same(*both(class_graph._search, graph, islands, 4))
    assert_same(*both(class_graph.is_simple, points))


def test_shortest_classes_of_a_grid():
    corners = find_corners(GRID.slabs)
    counts, to, _, _ = scan(GRID.slabs, corners, np.arange(len(corners.ends)))
    graph = corners, Edges(np.concatenate([[0], np.cumsum(counts[:, 0])]), to)
    begun = both(taut_search.begin, GRID.slabs, *graph, PROBLEM.start, PROBLEM.goal, 4)
    searches = [each[0] for each in begun]
    extended = [
        taut_search.extend(*graph, searches[0], 500),
        interpreted(taut_search.extend)(*graph, searches[1], 500),
    ]
    assert extended[0] == extended[1] > 0
    used = [slice(int(search.sizes[0])) for search in searches]
    assert_same(
        *(
            [s.rest, s.to_goal, s.sizes, s.states[rows], s.parents[rows], s.lengths[rows]]
            for s, rows in zip(searches, used, strict=True)
        )
    )


def test_stand_off():
    wish = stand_off.clearance_cost(GRID, 0.2)
    islands = islands_at(GRID.island_points)
    spread = both(stand_off.spread, wish, zigzag()[:20])
    assert_same(*spread)
    points = spread[0][0]
    costs, steps = stand_off.segment_costs(wish, points), np.full(len(points), 2.0)
    moved = both(stand_off.move, GRID.data, islands, wish, points, costs, steps)
    assert_same(*moved)
    assert (moved[0][1][3] != points).any()
    assert_same(*both(stand_off.drop, GRID.data, islands, wish, points))
