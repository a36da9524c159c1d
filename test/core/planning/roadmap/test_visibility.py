"""Tables of shortest ways: equal to those of another implementation, made new or mended."""

from hnr_planner.core.planning.roadmap.corners import distinct
from hnr_planner.core.planning.roadmap.visibility import edges_of, mend, no_ways, SEEN, Ways
from hnr_planner.core.trees import NONE
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import shortest_path
from scipy.spatial.distance import cdist

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


def random_sights(rng: np.random.Generator, n_nodes: int, density: float) -> Bools:
    one_way = np.tril(rng.random((n_nodes, n_nodes)) < density, -1)
    return one_way | one_way.T


def mended(ways: Ways, points: Floats, before: Bools, after: Bools) -> Ways:
    """Mend ways along the sights before for those after."""
    fixed = Ways(ways.distance.copy(), ways.previous.copy())
    sights = after.astype(np.uint8) * SEEN
    new = np.argwhere(after & ~before)
    length = np.linalg.norm(points[new[:, 0]] - points[new[:, 1]], axis=1).astype(np.float32)
    edges = edges_of(points, points, sights)
    mend(fixed, np.arange(len(points)), edges, sights, new, length)
    return fixed


def check_ways(ways: Ways, points: Floats, sights: Bools) -> None:
    """Compare the lengths with SciPy's, and follow each way along its edges."""
    length = cdist(points, points)
    graph = np.where(sights, length, np.inf)
    np.testing.assert_allclose(ways.distance, shortest_path(graph), rtol=1e-5)
    for root, end in np.ndindex(ways.distance.shape):
        walked = 0.0
        node = end
        while ways.previous[root, node] != NONE:
            before = int(ways.previous[root, node])
            assert sights[before, node]
            walked += length[before, node]
            node = before
        assert node == root or np.isinf(ways.distance[root, end])
        if node == root:
            np.testing.assert_allclose(walked, ways.distance[root, end], rtol=1e-5)


@settings(max_examples=50, deadline=None, derandomize=True)
@given(
    seed=st.integers(0, 2**32 - 1),
    n_nodes=st.integers(0, 25),
    density=st.sampled_from([0.05, 0.2, 0.6]),
    part_changed=st.sampled_from([0.0, 0.02, 0.5, 1.0]),
)
def test_ways_are_shortest_made_new_and_mended(
    seed: int, n_nodes: int, density: float, part_changed: float
):
    rng = np.random.default_rng(seed)
    points = rng.random((n_nodes, 2))
    none, before = np.zeros((n_nodes, n_nodes), bool), random_sights(rng, n_nodes, density)
    changes = random_sights(rng, n_nodes, part_changed)
    after = np.where(changes, random_sights(rng, n_nodes, density), before)
    made = mended(no_ways(n_nodes), points, none, before)
    check_ways(made, points, before)
    check_ways(mended(made, points, before, after), points, after)


@settings(max_examples=50, deadline=None, derandomize=True)
@given(seed=st.integers(0, 2**32 - 1), n_points=st.integers(0, 40), n_kept=st.integers(0, 40))
def test_of_points_near_each_other_the_first_stands(seed: int, n_points: int, n_kept: int):
    points = np.random.default_rng(seed).integers(0, 6, (n_points, 2)) / 5.0
    stands = distinct(points, n_kept, 0.25)
    for k, point in enumerate(points):
        earlier = points[:k][stands[:k]]
        near = (np.linalg.norm(earlier - point, axis=1) <= 0.25).any()
        assert stands[k] == (k < n_kept or not near)
