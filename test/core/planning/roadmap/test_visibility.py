"""Tables of shortest shortest: equal to those of another implementation, made new or repaired."""

from hnr_planner.core.planning.roadmap.corners import distinct
from hnr_planner.core.planning.roadmap.visibility import (
    edges_of,
    empty_paths,
    repair,
    ShortestPaths,
    VISIBLE,
)
from hnr_planner.core.trees import NONE
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.sparse.csgraph import shortest_path
from scipy.spatial.distance import cdist

pytestmark = pytest.mark.interpreted

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


def random_visibility(rng: np.random.Generator, n_nodes: int, density: float) -> Bools:
    one_way = np.tril(rng.random((n_nodes, n_nodes)) < density, -1)
    return one_way | one_way.T


def repaired(
    shortest: ShortestPaths, points: Floats, before: Bools, after: Bools
) -> ShortestPaths:
    """Mend shortest along the visibility before for those after."""
    fixed = ShortestPaths(shortest.distance.copy(), shortest.previous.copy())
    visibility = after.astype(np.uint8) * VISIBLE
    new = np.argwhere(after & ~before)
    length = np.linalg.norm(points[new[:, 0]] - points[new[:, 1]], axis=1).astype(np.float32)
    edges = edges_of(points, points, visibility)
    repair(fixed, np.arange(len(points)), edges, visibility, new, length)
    return fixed


def check_paths(shortest: ShortestPaths, points: Floats, visibility: Bools) -> None:
    """Compare the lengths with SciPy's, and follow each path along its edges."""
    length = cdist(points, points)
    graph = np.where(visibility, length, np.inf)
    np.testing.assert_allclose(shortest.distance, shortest_path(graph), rtol=1e-5)
    for root, end in np.ndindex(shortest.distance.shape):
        walked = 0.0
        node = end
        while shortest.previous[root, node] != NONE:
            before = int(shortest.previous[root, node])
            assert visibility[before, node]
            walked += length[before, node]
            node = before
        assert node == root or np.isinf(shortest.distance[root, end])
        if node == root:
            np.testing.assert_allclose(walked, shortest.distance[root, end], rtol=1e-5)


@settings(max_examples=50, deadline=None, derandomize=True)
@given(
    seed=st.integers(0, 2**32 - 1),
    n_nodes=st.integers(0, 25),
    density=st.sampled_from([0.05, 0.2, 0.6]),
    fraction_changed=st.sampled_from([0.0, 0.02, 0.5, 1.0]),
)
def test_paths_are_shortest_built_and_repaired(
    seed: int, n_nodes: int, density: float, fraction_changed: float
):
    rng = np.random.default_rng(seed)
    points = rng.random((n_nodes, 2))
    none, before = np.zeros((n_nodes, n_nodes), bool), random_visibility(rng, n_nodes, density)
    changes = random_visibility(rng, n_nodes, fraction_changed)
    after = np.where(changes, random_visibility(rng, n_nodes, density), before)
    made = repaired(empty_paths(n_nodes), points, none, before)
    check_paths(made, points, before)
    check_paths(repaired(made, points, before, after), points, after)


@settings(max_examples=50, deadline=None, derandomize=True)
@given(seed=st.integers(0, 2**32 - 1), n_points=st.integers(0, 40), n_kept=st.integers(0, 40))
def test_of_points_near_each_other_the_first_stands(seed: int, n_points: int, n_kept: int):
    points = np.random.default_rng(seed).integers(0, 6, (n_points, 2)) / 5.0
    is_first = distinct(points, n_kept, 0.25)
    for k, point in enumerate(points):
        earlier = points[:k][is_first[:k]]
        near = (np.linalg.norm(earlier - point, axis=1) <= 0.25).any()
        assert is_first[k] == (k < n_kept or not near)
