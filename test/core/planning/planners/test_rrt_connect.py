"""RRT-Connect against its definition, step by step."""

import math
from test.brute_force import chord_by_search
from test.core.planning.searches import plan, start_search
from test.laws import maps

from hnr_planner.core import GridSpace, PlannerStatus
from hnr_planner.core.kernels.streams import stream, uniform
from hnr_planner.core.planning.planners.rrt_connect import RRTConnect
import numpy as np
from numpy.typing import NDArray
import pytest

STEPS = 150


class ByDefinition:
    """Two lists of vertices, and every nearest one and every free step looked for from scratch."""

    def __init__(self, blocked: NDArray[np.bool_], max_step: float, seed: int) -> None:
        self.blocked, self.max_step = blocked, max_step
        self.rng = stream(seed)
        rows, columns = blocked.shape
        self.vertices = [np.array([0.5, 0.5]), np.array([columns - 0.5, rows - 0.5])]
        self.parents, self.tree_of = [-1, -1], [0, 1]
        self.met = False

    def grow(self, steps: int) -> None:
        """Take so many steps, fewer when the trees meet."""
        rows, columns = self.blocked.shape
        tree, followed = 0, None
        for _ in range(steps):
            if followed is None:
                target = np.array([columns * uniform(self.rng), rows * uniform(self.rng)])
            else:
                target = self.vertices[followed]
            arrived, added = self.step(tree, target, keep=followed is None)
            self.met = arrived and followed is not None
            if self.met:
                return
            if followed is None:
                tree, followed = 1 - tree, added
            elif added is None:
                followed = None

    def step(self, tree: int, target: NDArray[np.float64], keep: bool) -> tuple[bool, int | None]:
        """Go from the tree's nearest vertex; say whether it arrives, and the row that it adds."""
        own = [k for k in range(len(self.vertices)) if self.tree_of[k] == tree]
        parent = min(own, key=lambda k: np.sum((self.vertices[k] - target) ** 2))
        u = target - self.vertices[parent]
        part = min(1.0, self.max_step / np.hypot(*u))
        if chord_by_search(self.blocked, self.vertices[parent], part * u)[1] <= 1:
            return False, None
        if part == 1.0 and not keep:
            return True, None
        self.vertices.append(self.vertices[parent] + part * u)
        self.parents.append(parent)
        self.tree_of.append(tree)
        return part == 1.0, len(self.vertices) - 1


@pytest.mark.parametrize('seed', range(10))
@pytest.mark.parametrize('max_step', [None, 1.0, math.inf])
def test_trees_grow_by_free_steps_and_follow_each_other(seed: int, max_step: float | None):
    blocked = maps.TWO_ROOMS
    longest = 0.2 * math.hypot(*blocked.shape) if max_step is None else max_step
    search = start_search('rrt_connect', blocked, seed, max_step=max_step)
    search.advance(STEPS)
    expected = ByDefinition(blocked, longest, seed)
    expected.grow(STEPS)
    assert search.solved == expected.met
    np.testing.assert_array_equal(search.parents, expected.parents)
    # The grid has a rim of one cell.
    np.testing.assert_allclose(search.samples - 1.0, expected.vertices, atol=1e-9)


def test_on_those_maps_some_searches_meet_and_some_steps_are_blocked():
    searches = [start_search('rrt_connect', maps.TWO_ROOMS, seed) for seed in range(10)]
    for search in searches:
        search.advance(STEPS)
    assert any(search.solved for search in searches)
    assert any(len(search.samples) < search.iterations for search in searches)


@pytest.mark.parametrize('max_step', [0.3, 2.0])
def test_a_longest_step_holds_for_every_edge(max_step: float):
    blocked = maps.rooms(60, 80, 10, seed=4)
    space = GridSpace.from_blocked(blocked, 0.1, (2.0, -1.0, 0.4))
    ends = space.cell_centres(2, 2), space.cell_centres(57, 75)
    result = plan(space, *ends, algorithm=RRTConnect(max_step), seed=2, simplify=False)
    assert result.status is PlannerStatus.SOLVED
    children = np.flatnonzero(result.parents >= 0)
    edges = result.samples[children] - result.samples[result.parents[children]]
    assert np.hypot(*edges.T).max() <= max_step + 1e-9
    assert np.hypot(*np.diff(result.path, axis=0).T).max() <= max_step + 1e-9
