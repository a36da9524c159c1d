"""
Flood fill of a grid from the start towards the goal: it finds a path if there is any.

Free cells are reached over the edges that they share. Of the cells that were reached, the one of
the least estimate spreads next: its distance to the goal and a part of its steps from the start,
in whole cells. Of several it is the one reached last. So where obstacles are small few cells are
touched; at worst, all those of the start's component are.
"""

from dataclasses import dataclass, field
import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.copies import copy_into, copy_rows
from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.planning.planner import Problem
import numpy as np
from numpy.typing import NDArray

#: Weight of a step in the estimates, below the root of 1/2: then straight towards the goal, also
#: diagonally, the estimates decrease. In noise paths are a tenth shorter than without steps.
WEIGHT = 0.6
#: Steps to the cells that share an edge, (rows, columns).
STEPS = ((0, 1), (1, 0), (0, -1), (-1, 0))
#: Mark of the first cell, which no step has reached.
FIRST = len(STEPS) + 1
#: Index that stands for no cell.
NONE = -1
#: Entries of ``Fill.sizes``: number of cells reached, least estimate of which a list may hold a
#: cell, and index of the cell that reaches the goal, NONE (-1) before.
N_REACHED, LEAST, LAST = 0, 1, 2


class Fill(NamedTuple):
    """
    State of a flood fill.

    Attributes
    ----------
    reached_by : (rows, columns) uint8
        Number of the step, from 1, by which each cell was reached; ``FIRST`` for the first cell, 0
        for cells that were not reached.
    cells : (rows * columns,) int64
        The cells reached, in that order: row times ``columns`` plus column.
    n_steps : (rows * columns,) int32
        Number of steps from the first cell to each of ``cells``.
    first : (n,) int64
        For each estimate, the index in ``cells`` of the first cell in the list of those that have
        not spread; NONE (-1) for an empty list. The last list also holds all larger estimates.
    following : (rows * columns,) int64
        Index in ``cells`` of the cell after each in its list; NONE after the last one.
    sizes : (3,) int64
        Entries ``N_REACHED``, ``LEAST`` and ``LAST``.

    """

    reached_by: NDArray[np.uint8]
    cells: NDArray[np.int64]
    n_steps: NDArray[np.int32]
    first: NDArray[np.int64]
    following: NDArray[np.int64]
    sizes: NDArray[np.int64]


@dataclass
class FloodFill:
    """
    A running flood fill of a grid, which advances by cells.

    Attributes
    ----------
    problem : Problem
        The problem to solve, kernel frame; its space is a grid.

    """

    problem: Problem
    _fill: Fill = field(init=False)

    def __post_init__(self) -> None:
        """Reach the cell of the start."""
        rows, columns = self.problem.space.free_distance.shape
        # The operating system provides memory only for what is written.
        self._fill = Fill(
            np.zeros((rows, columns), dtype=np.uint8),
            np.empty(rows * columns, dtype=np.int64),
            np.empty(rows * columns, dtype=np.int32),
            np.full(2 * (rows + columns), NONE),
            np.empty(rows * columns, dtype=np.int64),
            np.array([0, 0, NONE]),
        )
        _begin(self.problem, self._fill)

    @property
    def solved(self) -> bool:
        """Whether a cell that reaches the goal was found."""
        return bool(self._fill.sizes[LAST] != NONE)

    @property
    def path(self) -> Floats:
        """Path (m, 2) of a solved fill through centres of cells to the goal, kernel frame."""
        return _path(self.problem, self._fill)

    def advance(self, n_cells: int) -> int:
        """Let at most ``n_cells`` cells spread; return how many, fewer where the fill is over."""
        return _spread(self.problem, self._fill, n_cells)


@kernel
def _begin(problem, fill):
    """Reach the cell of the start, which no step leads to."""
    _reach(problem, fill, math.floor(problem.start[1]), math.floor(problem.start[0]), FIRST, 0)


@kernel
def _spread(problem, fill, n_cells):
    """
    Reach the neighbours of at most ``n_cells`` cells, those of the least estimates first.

    Returns the number of cells handled: fewer where one of them reaches the goal, whose index is
    stored in ``fill.sizes`` then, or where none is left.
    """
    problem, fill = borrowed(problem), borrowed(fill)
    free_distance, first, sizes = problem.space.free_distance, fill.first, fill.sizes
    columns, point = free_distance.shape[1], np.empty(2)
    if sizes[LAST] != NONE:
        return 0
    for n in range(n_cells):
        while sizes[LEAST] < len(first) and first[sizes[LEAST]] == NONE:
            sizes[LEAST] += 1
        if sizes[LEAST] == len(first):
            return n
        k = first[sizes[LEAST]]
        first[sizes[LEAST]] = fill.following[k]
        row, column = fill.cells[k] // columns, fill.cells[k] % columns
        if _reaches_goal(problem, row, column, point):
            sizes[LAST] = k
            return n + 1
        for step in range(len(STEPS)):
            i, j = row + STEPS[step][0], column + STEPS[step][1]
            if free_distance[i, j] > 0 and fill.reached_by[i, j] == 0:
                _reach(problem, fill, i, j, step + 1, fill.n_steps[k] + 1)
    return n_cells


@inlined
def _reach(problem, fill, row, column, step, n_steps):
    """Add a cell, reached by the step of number ``step``, to the list of its estimate."""
    sizes, goal = fill.sizes, problem.goal
    k = sizes[N_REACHED]
    sizes[N_REACHED] += 1
    fill.reached_by[row, column] = step
    fill.cells[k], fill.n_steps[k] = row * fill.reached_by.shape[1] + column, n_steps
    x, y = column + 0.5 - goal[0], row + 0.5 - goal[1]
    estimate = WEIGHT * n_steps + math.sqrt(x * x + y * y)
    at = int(min(estimate, len(fill.first) - 1.0))
    fill.following[k] = fill.first[at]
    fill.first[at] = k
    sizes[LEAST] = min(sizes[LEAST], at)


@inlined
def _reaches_goal(problem, row, column, point):
    """
    Return whether a cell reaches the goal, and write the point where to ``point`` (2,).

    With a goal radius of 0 the cell has to hold the goal. Otherwise its point nearest to the goal,
    at least the margin inside the cell, has to be within that radius.
    """
    goal, margin = problem.goal, problem.margin
    if problem.goal_radius == 0.0:
        copy_into(point, goal)
        return row == math.floor(goal[1]) and column == math.floor(goal[0])
    point[0] = min(max(goal[0], column + margin), column + 1 - margin)
    point[1] = min(max(goal[1], row + margin), row + 1 - margin)
    squared = (point[0] - goal[0]) ** 2 + (point[1] - goal[1]) ** 2
    return squared <= problem.goal_radius**2


@kernel
def _path(problem, fill):
    """Return the path (m, 2) of a solved fill, from the start to the goal or into its region."""
    columns, last = fill.reached_by.shape[1], fill.cells[fill.sizes[LAST]]
    row, column = last // columns, last % columns
    path, n, before = np.empty((64, 2)), 1, 0
    _reaches_goal(problem, row, column, path[0])
    while True:
        step = int(fill.reached_by[row, column])
        # A vertex wherever the direction changes, the first and the last cell included.
        if step != before:
            if n + 1 == len(path):
                larger = np.empty((2 * len(path), 2))
                copy_rows(larger[:n], path)
                path = larger
            path[n, 0], path[n, 1] = column + 0.5, row + 0.5
            n += 1
        if step == FIRST:
            break
        row, column, before = row - STEPS[step - 1][0], column - STEPS[step - 1][1], step
    copy_into(path[n], problem.start)
    forwards = np.empty((n + 1, 2))
    copy_rows(forwards, path[n::-1])
    return forwards
