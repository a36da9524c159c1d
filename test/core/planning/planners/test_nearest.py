"""The tree of boxes: as exact as brute force, and shallow whatever the order of the points."""

from hnr_planner.core.planning.planners.nearest import (
    BoxTree,
    DEPTH_MAX,
    empty_box_tree,
    grown,
    insert,
    LEAF_SIZE,
    nearest,
)
import numpy as np
from numpy.typing import NDArray
import pytest


def tree_of(points: NDArray[np.float64]) -> BoxTree:
    dim = points.shape[1]
    tree = empty_box_tree(np.zeros(dim), np.ones(dim), 1)
    for k in range(len(points)):
        if k == len(tree.following):
            tree = grown(tree, 2 * k)
        insert(tree, points, k)
    return tree


def depth_of(tree: BoxTree) -> int:
    deepest, waiting = 0, [(0, 0)]
    while waiting:
        node, depth = waiting.pop()
        deepest = max(deepest, depth)
        waiting += [(int(child), depth + 1) for child in tree.child[node] if child >= 0]
    return deepest


def orders(n: int) -> dict[str, NDArray[np.float64]]:
    rng = np.random.default_rng(0)
    along = np.linspace(0.0, 1.0, n, endpoint=False)
    return {
        'uniform': rng.random((n, 2)),
        'along a corridor': np.stack([along, np.full(n, 0.3)], axis=1),
        'along a diagonal, backwards': np.stack([along, along], axis=1)[::-1].copy(),
        'clusters': 0.5 + 1e-6 * rng.standard_normal((n, 2)),
        'on a lattice, twice': np.repeat(np.argwhere(np.ones((50, n // 100))) / n, 2, axis=0),
        'three dimensions': rng.random((n, 3)),
        'ten dimensions': rng.random((n, 10)),
    }


@pytest.mark.parametrize('name', orders(100))
def test_nearest_is_the_first_of_the_nearest_points(name: str):
    points = orders(5000)[name]
    tree = tree_of(points)
    rng = np.random.default_rng(1)
    queries = np.concatenate([rng.random((200, points.shape[1])), points[::50]])
    for x in queries:
        squared = ((points - x) ** 2).sum(axis=1)
        assert squared[nearest(tree, points, x)] == squared.min()


def test_each_root_answers_for_its_own_points():
    rng = np.random.default_rng(3)
    points, owners = rng.random((3000, 2)), rng.integers(3, size=3000)
    tree = empty_box_tree(np.zeros(2), np.ones(2), 10, n_roots=3)
    for k in range(len(points)):
        if k == len(tree.following):
            tree = grown(tree, 2 * k)
        insert(tree, points, k, owners[k])
    for x in rng.random((200, 2)):
        for root in range(3):
            squared = np.where(owners == root, ((points - x) ** 2).sum(axis=1), np.inf)
            assert nearest(tree, points, x, root) == squared.argmin()


def test_of_two_equal_points_the_first_is_nearest():
    points = np.repeat(np.random.default_rng(2).random((500, 2)), 2, axis=0)
    tree = tree_of(points)
    assert [nearest(tree, points, x) for x in points[1::2]] == list(range(0, 1000, 2))


@pytest.mark.parametrize('name', ['uniform', 'along a corridor', 'along a diagonal, backwards'])
def test_the_order_of_points_does_not_make_the_tree_deep(name: str):
    """100,000 points in leaves of 8 need 14 levels, twice as many where one axis is idle."""
    n = 100_000
    ideal = np.log2(n / LEAF_SIZE)
    assert depth_of(tree_of(orders(n)[name])) <= 2 * ideal + 4


def test_equal_points_fill_one_leaf_and_no_more_depth_than_allowed():
    points = np.full((1000, 2), 0.1)
    tree = tree_of(points)
    assert depth_of(tree) <= DEPTH_MAX
    assert nearest(tree, points, np.array([0.9, 0.9])) == 0
