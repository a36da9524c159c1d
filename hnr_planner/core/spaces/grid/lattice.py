"""
A coarse lattice over a grid: rough, free paths that take the short route around obstacles.

The grid is divided into square blocks. A node is the cell of its block that is farthest from the
walls; the nodes of neighbouring blocks are joined where the segment between them is free. A path
on the lattice is free and nearly always of the shortest homotopy class, but longer than need be:
it has to be shortened.
"""

from heapq import heappop, heappush
import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.copies import copy_into, copy_rows
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.lengths import distance
from hnr_planner.core.spaces.grid.traversal import GridData
from hnr_planner.core.spaces.primitives import segment_is_free
from hnr_planner.core.trees import branch, NONE
import numpy as np
from numpy.typing import NDArray

#: Least side of a block [cells].
SIDE_MIN = 4
#: Largest number of blocks along the longer side of the grid.
BLOCKS_MAX = 128
#: Rings of blocks around a point that are searched for a visible node.
RINGS = 3
#: Steps (rows, columns) to the neighbouring blocks; the second four are the opposite of the first.
STEPS = ((0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1))


class Lattice(NamedTuple):
    """
    Nodes and the edges between them, kernel frame.

    Node ``row * columns + column`` is that of the block (row, column).

    Attributes
    ----------
    side : int
        Cells along the side of a block.
    columns : int
        Blocks in a row.
    nodes : (k, 2)
        Centre of the block's most open cell.
    joined : (k, 8) bool
        Whether there is an edge to the node of the block one of ``STEPS`` away.

    """

    side: int
    columns: int
    nodes: Floats
    joined: NDArray[np.bool_]


def build_lattice(grid: GridData) -> Lattice:
    """Build the lattice of a grid."""
    rows, columns = grid.free_distance.shape
    side = max(SIDE_MIN, math.ceil(max(rows, columns) / BLOCKS_MAX))
    return Lattice(side, math.ceil(columns / side), *_joined_nodes(grid, side))


@kernel
def _joined_nodes(grid, side):
    """Return the nodes (k, 2) of blocks of ``side`` cells, and the edges (k, 8) bool."""
    grid = borrowed(grid)
    rows, columns = grid.free_distance.shape
    block_rows, block_columns = math.ceil(rows / side), math.ceil(columns / side)
    nodes = np.empty((block_rows * block_columns, 2))
    joined = np.zeros((len(nodes), len(STEPS)), dtype=np.bool_)
    for k in range(len(nodes)):
        _most_open(grid.free_distance, k // block_columns, k % block_columns, side, nodes[k])
    for k in range(len(nodes)):
        for step in range(4):
            near = _block_at(k, step, block_columns, len(nodes))
            if near != NONE and segment_is_free(grid, nodes[k], nodes[near]):
                joined[k, step] = joined[near, step + 4] = True
    return nodes, joined


@kernel
def _most_open(free_distance, row, column, side, node):
    """Write to ``node`` (2,) the centre of the cell in a block that is farthest from the walls."""
    rows, columns = free_distance.shape
    farthest = -1
    for i in range(row * side, min((row + 1) * side, rows)):
        for j in range(column * side, min((column + 1) * side, columns)):
            if free_distance[i, j] > farthest:
                farthest = int(free_distance[i, j])
                node[0], node[1] = j + 0.5, i + 0.5


@kernel
def _block_at(k, step, columns, n_blocks):
    """Return the block one step away from block ``k``, or NONE beyond the grid."""
    down, right = STEPS[step]
    row, column = k // columns + down, k % columns + right
    inside = 0 <= column < columns and 0 <= row < n_blocks // columns
    return row * columns + column if inside else NONE


@kernel
def rough_path(grid, lattice, start, goal):
    """Return the shortest free path (m, 2) over the lattice, by A*; (0, 2) where it has none."""
    grid, lattice, start, goal = borrowed(grid), borrowed(lattice), borrowed(start), borrowed(goal)
    nodes, n = lattice.nodes, len(lattice.nodes)
    length, parents = np.full(n, math.inf), np.full(n, NONE)
    ends, waiting = np.zeros(n, dtype=np.bool_), [(0.0, 0) for _ in range(0)]
    for k in _visible_nodes(grid, lattice, goal):
        ends[k] = True
    for k in _visible_nodes(grid, lattice, start):
        length[k] = distance(start, nodes[k])
        heappush(waiting, (length[k] + distance(nodes[k], goal), k))
    while len(waiting) > 0:
        least, k = heappop(waiting)
        left = distance(nodes[k], goal)
        if least > length[k] + left:
            continue  # a shorter path to this node was found since
        if ends[k]:
            between = branch(nodes, parents, k)
            path = np.empty((len(between) + 2, 2))
            copy_into(path[0], start)
            copy_rows(path[1:-1], between)
            copy_into(path[-1], goal)
            return path
        for step in range(len(STEPS)):
            if lattice.joined[k, step]:
                near = _block_at(k, step, lattice.columns, n)
                through = length[k] + distance(nodes[k], nodes[near])
                if through < length[near]:
                    length[near], parents[near] = through, k
                    heappush(waiting, (through + distance(nodes[near], goal), near))
    return np.empty((0, 2))


@kernel
def _visible_nodes(grid, lattice, x):
    """Return the nodes visible from ``x`` (2,) in the nearest rings of blocks that have any."""
    row, column = int(x[1]) // lattice.side, int(x[0]) // lattice.side
    rows = len(lattice.nodes) // lattice.columns
    visible = [0 for _ in range(0)]
    for reach in range(1, RINGS + 1):
        for i in range(max(row - reach, 0), min(row + reach + 1, rows)):
            for j in range(max(column - reach, 0), min(column + reach + 1, lattice.columns)):
                k = i * lattice.columns + j
                if segment_is_free(grid, x, lattice.nodes[k]):
                    visible.append(k)
        if len(visible) > 0:
            break
    return visible
