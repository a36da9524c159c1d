"""
Slabs: the free cells of a grid as rectangles, which meet along horizontal portals only.

Each row of cells is cut into its maximal runs of free cells. A run with the same ends as a run in
the row below joins the slab of that run, so a slab is the largest rectangle of equal runs. Two
slabs are neighbours where their edges share more than a point: that interval of a grid line is a
portal. Every convex corner of the obstacles ends exactly one portal, and no portal leads between
two obstacles that touch at a corner, so paths through portals never pass there.

Kernel frame: one unit is one cell, x before y.
"""

from typing import NamedTuple

from hnr_planner.core.kernels.kernel import kernel
import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.int32]
#: Ends of a portal.
LEFT, RIGHT = 0, 1
#: A point on a grid line is moved up by this [cells].
OFF_LINE = 1e-9
#: Entry of ``exits`` for a slab that is no dead end.
THROUGH = -1


class Slabs(NamedTuple):
    """
    Slabs and portals of a grid.

    Attributes
    ----------
    boxes : (n_slabs, 4) int32
        Left, right, lower and upper edge [cells] of each slab.
    portals : (n_portals, 5) int32
        Left end x, right end x and height y [cells] of each portal, the index of the slab below it
        and that of the slab above it; ordered by height, then from left to right.
    above, below : (n_slabs, 2) int32
        Range of indices in ``portals`` of the portals on the upper (lower) edge of each slab: the
        first, and one after the last.
    steps : (n_portals, 2, 2) int8
        Direction (x, y) away from the obstacle corner at the left and right end of each portal;
        (0, 0) where the end lies on a wall.
    runs : (n_runs,) int32
        Index of the slab of each free run, row after row and from left to right.
    rows : (n_rows + 1,) int32
        Index in ``runs`` of the first run of each row, and the number of runs.
    exits : (n_slabs,) int32
        Index of the next slab on the way out of a dead end; ``THROUGH``, -1, for a slab that is in
        no dead end, and the slab's own index at the last slab of a component that is a tree.
    most_portals : int
        Largest number of portals of one slab.

    """

    boxes: Ints
    portals: Ints
    above: Ints
    below: Ints
    steps: NDArray[np.int8]
    runs: Ints
    rows: Ints
    exits: Ints
    most_portals: int


@kernel
def build_slabs(free):
    """
    Return the slabs of the free cells of an array (rows, columns).

    ``free`` is not 0 where a cell is free; the outermost rows and columns have to be 0.
    """
    starts, ends, rows = _free_runs(free)
    runs, boxes = _merge_runs(starts, ends, rows)
    portals = _find_portals(runs, boxes, rows)
    above, below = _portals_by_slab(portals, len(boxes))
    steps, exits = _steps_aside(portals, boxes), _find_dead_ends(portals, above, below)
    most = _most_portals(above, below)
    return Slabs(boxes, portals, above, below, steps, runs, rows, exits, most)


@kernel
def _free_runs(free):
    """
    Return start and end (n_runs,) of every maximal free run, and ``rows`` (n_rows + 1,).

    Start is the first column of the run, end the column after the last. ``rows`` is as in
    ``Slabs``.
    """
    n_rows, n_columns = free.shape
    rows = np.empty(n_rows + 1, dtype=np.int32)
    n_runs = 0
    for row in range(n_rows):
        for column in range(1, n_columns):
            if free[row, column] != 0 and free[row, column - 1] == 0:
                n_runs += 1
    starts, ends = np.empty(n_runs, dtype=np.int32), np.empty(n_runs, dtype=np.int32)
    k = 0
    for row in range(n_rows):
        rows[row] = k
        for column in range(1, n_columns):
            if free[row, column] != 0 and free[row, column - 1] == 0:
                starts[k] = column
            elif free[row, column] == 0 and free[row, column - 1] != 0:
                ends[k] = column
                k += 1
    rows[n_rows] = k
    return starts, ends, rows


@kernel
def _merge_runs(starts, ends, rows):
    """Return the slab index (n_runs,) of each run, and the box (n_slabs, 4) of each slab."""
    runs = np.empty(len(starts), dtype=np.int32)
    boxes = np.empty((len(starts), 4), dtype=np.int32)
    n_slabs = 0
    for row in range(len(rows) - 1):
        k = rows[row - 1] if row > 0 else 0
        for i in range(rows[row], rows[row + 1]):
            while k < rows[row] and starts[k] < starts[i]:
                k += 1
            if k < rows[row] and starts[k] == starts[i] and ends[k] == ends[i]:
                runs[i] = runs[k]
                boxes[runs[i], 3] = row + 1
                continue
            runs[i] = n_slabs
            boxes[n_slabs, 0], boxes[n_slabs, 1] = starts[i], ends[i]
            boxes[n_slabs, 2], boxes[n_slabs, 3] = row, row + 1
            n_slabs += 1
    return runs, boxes[:n_slabs].copy()


@kernel
def _find_portals(runs, boxes, rows):
    """Return the portals (n_portals, 5) between the slabs of neighbouring rows."""
    portals = np.empty((2 * len(runs), 5), dtype=np.int32)
    n_portals = 0
    for row in range(1, len(rows) - 1):
        i, k = rows[row - 1], rows[row]
        while i < rows[row] and k < rows[row + 1]:
            lower, upper = runs[i], runs[k]
            left = max(boxes[lower, 0], boxes[upper, 0])
            right = min(boxes[lower, 1], boxes[upper, 1])
            if left < right and lower != upper:
                portals[n_portals, 0], portals[n_portals, 1] = left, right
                portals[n_portals, 2] = row
                portals[n_portals, 3], portals[n_portals, 4] = lower, upper
                n_portals += 1
            if boxes[lower, 1] < boxes[upper, 1]:
                i += 1
            else:
                k += 1
    return portals[:n_portals].copy()


@kernel
def _portals_by_slab(portals, n_slabs):
    """Return ``above`` and ``below`` (n_slabs, 2) of ``Slabs``: ranges of portals by slab."""
    above = np.zeros((n_slabs, 2), dtype=np.int32)
    below = np.zeros((n_slabs, 2), dtype=np.int32)
    for k in range(len(portals)):
        for edge, slab in ((above, portals[k, 3]), (below, portals[k, 4])):
            if edge[slab, 1] == 0:
                edge[slab, 0] = k
            edge[slab, 1] = k + 1
    return above, below


@kernel
def _most_portals(above, below):
    """Return the largest number of portals of one slab; ``above``, ``below`` as in ``Slabs``."""
    most = 0
    for slab in range(len(above)):
        n_above, n_below = above[slab, 1] - above[slab, 0], below[slab, 1] - below[slab, 0]
        most = max(most, int(n_above + n_below))
    return most


@kernel
def _steps_aside(portals, boxes):
    """
    Return the direction (n_portals, 2, 2) away from the corner at each end of each portal.

    It is (0, 0) where the end lies on a straight wall, and not at a corner.
    """
    steps = np.zeros((len(portals), 2, 2), dtype=np.int8)
    for k in range(len(portals)):
        lower, upper = portals[k, 3], portals[k, 4]
        for side in (LEFT, RIGHT):
            if boxes[lower, side] != boxes[upper, side]:
                lower_ends_here = boxes[lower, side] == portals[k, side]
                steps[k, side, 0] = 1 if side == LEFT else -1
                steps[k, side, 1] = 1 if lower_ends_here else -1
    return steps


@kernel
def _find_dead_ends(portals, above, below):
    """
    Return ``exits`` (n_slabs,) of ``Slabs``: the next slab on the way out of a dead end.

    A slab with at most one neighbour is a dead end, and so is a slab of whose neighbours at most
    one is no dead end.
    """
    n_slabs = len(above)
    exits, degrees = np.full(n_slabs, THROUGH, dtype=np.int32), np.empty(n_slabs, dtype=np.int32)
    stack, n_stack = np.empty(n_slabs, dtype=np.int32), 0
    for slab in range(n_slabs):
        degrees[slab] = above[slab, 1] - above[slab, 0] + below[slab, 1] - below[slab, 0]
        if degrees[slab] <= 1:
            stack[n_stack] = slab
            n_stack += 1
    while n_stack > 0:
        n_stack -= 1
        slab = stack[n_stack]
        if exits[slab] != THROUGH:
            continue
        exits[slab] = slab
        for edge, column in ((above, 4), (below, 3)):
            for k in range(edge[slab, 0], edge[slab, 1]):
                other = portals[k, column]
                if exits[other] == THROUGH:
                    exits[slab] = other
                    degrees[other] -= 1
                    if degrees[other] == 1:
                        stack[n_stack] = other
                        n_stack += 1
    return exits


@kernel
def slab_at(slabs, x, y):
    """
    Return the index of the slab that holds the free point (x, y), kernel frame [cells].

    For a point on a horizontal grid line it is the slab above the line.
    """
    row = int(np.floor(y))
    low, high = slabs.rows[row], slabs.rows[row + 1]
    while high - low > 1:
        middle = (low + high) // 2
        if slabs.boxes[slabs.runs[middle], 0] <= x:
            low = middle
        else:
            high = middle
    return slabs.runs[low]
