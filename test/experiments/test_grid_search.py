"""Grid searches that planners are compared with: their paths are free and short enough."""

from test.brute_force import path_collisions
from test.laws import maps
from test.sweeps import sweep_but

from hnr_planner.core import GridSpace
from hnr_planner.experiments.grid_search import a_star, pull_string, theta_star, wavefront
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

SEARCHES = (a_star, theta_star, wavefront)


def shortest(free: NDArray[np.bool_], source: tuple[int, int]) -> NDArray[np.float64]:
    """Lengths (rows, columns) of shortest paths over eight neighbours that cut no corner."""
    rows, columns = free.shape
    edges = []
    for row, column in np.argwhere(free):
        for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
            to_row, to_column = row + down, column + right
            if to_row < rows and 0 <= to_column < columns and free[to_row, to_column]:
                if free[row, to_column] and free[to_row, column]:
                    ends = row * columns + column, to_row * columns + to_column
                    edges.append((*ends, np.hypot(down, right)))
    first, second, lengths = np.array(edges).T
    graph = coo_array((lengths, (first.astype(int), second.astype(int))), shape=(free.size,) * 2)
    origin = source[0] * columns + source[1]
    return dijkstra(graph.tocsr(), directed=False, indices=origin).reshape(free.shape)


def length(path: NDArray[np.float64]) -> float:
    return float(np.hypot(*np.diff(path, axis=0).T).sum())


@pytest.mark.interpreted
@pytest.mark.parametrize('seed', sweep_but([0], range(4)))
def test_paths_are_free_and_as_long_as_their_search_promises(seed: int):
    blocked = maps.speckle(40, 50, 0.2, seed)
    space = GridSpace.from_blocked(blocked)
    cells = np.argwhere(space.largest_component())
    source = tuple(cells[0])
    exact = shortest(~blocked, source)
    for target in cells[np.random.default_rng(seed).integers(1, len(cells), size=10)]:
        ends = space.cell_centres(*source), space.cell_centres(*target)
        found = {}
        for search in SEARCHES:
            path = space.from_kernel(search(space.data, *space.to_kernel(np.stack(ends))))
            np.testing.assert_allclose(path[[0, -1]], ends)
            assert path_collisions(path, blocked, 1.0) == []
            pulled = space.from_kernel(pull_string(space.data, space.to_kernel(path)))
            assert path_collisions(pulled, blocked, 1.0) == []
            assert length(pulled) <= length(path) + 1e-9
            found[search] = length(path)
        assert found[a_star] == pytest.approx(exact[tuple(target)], rel=1e-5)
        assert found[theta_star] <= found[a_star] + 1e-9
        assert found[wavefront] >= found[a_star] - 1e-3


def test_theta_star_goes_straight_where_it_sees():
    space = GridSpace.from_blocked(np.zeros((20, 30), dtype=bool))
    path = theta_star(space.data, *space.to_kernel(np.array([(0.5, 0.5), (28.5, 11.5)])))
    np.testing.assert_allclose(space.from_kernel(path), [(0.5, 0.5), (28.5, 11.5)])
