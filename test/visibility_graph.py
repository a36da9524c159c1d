"""
Shortest paths on small grids by a full visibility graph in whole numbers.

Independent of the package: no floating-point number decides what is visible. Points are whole
numbers with ``SCALE`` units to a cell. Free space is taken as closed, except that nothing passes
between two blocked cells that touch at a corner, or along an edge between two blocked cells: so
lengths are the infimum of those of free paths.
"""

from fractions import Fraction
from heapq import heappop, heappush
from itertools import pairwise
import math

import numpy as np
from numpy.typing import NDArray

SCALE = 4
Point = tuple[int, int]
Cells = NDArray[np.bool_]


def shortest_length(blocked: Cells, start: Point, goal: Point) -> float:
    """Return the length [cells] of the shortest path; inf where there is none."""
    points = [start, goal, *convex_corners(blocked)]
    left, done = [math.dist(point, goal) for point in points], [False] * len(points)
    heap = [(left[0], 0.0, 0, 0)]
    while heap:
        # A*; whether one point sees the next is tested only when that edge is the best.
        _, length, i, j = heappop(heap)
        if done[j] or not is_visible(blocked, points[i], points[j]):
            continue
        if j == 1:
            return length / SCALE
        done[j] = True
        for k, point in enumerate(points):
            if not done[k]:
                longer = length + math.dist(points[j], point)
                heappush(heap, (longer + left[k], longer, j, k))
    return math.inf


def is_blocked(blocked: Cells, row: int, column: int) -> bool:
    rows, columns = blocked.shape
    inside = 0 <= row < rows and 0 <= column < columns
    return not inside or bool(blocked[row, column])


def cells_around(x: int, y: int) -> list[tuple[int, int]]:
    return [(row, column) for row in (y - 1, y) for column in (x - 1, x)]


def convex_corners(blocked: Cells) -> list[Point]:
    """Return the grid points that touch one blocked cell: where shortest paths bend."""
    rows, columns = blocked.shape
    return [
        (SCALE * x, SCALE * y)
        for y in range(rows + 1)
        for x in range(columns + 1)
        if sum(is_blocked(blocked, *cell) for cell in cells_around(x, y)) == 1
    ]


def is_visible(blocked: Cells, a: Point, b: Point) -> bool:
    """Return whether the segment between two points is free, by its pieces between grid lines."""
    if a == b:
        return True
    step = b[0] - a[0], b[1] - a[1]
    cuts = sorted({Fraction(0), Fraction(1), *_crossings(a[0], b[0]), *_crossings(a[1], b[1])})
    for begin, end in pairwise(cuts):
        middle = (begin + end) / 2
        x, y = ((a[i] + middle * step[i]) / SCALE for i in (0, 1))
        if all(is_blocked(blocked, *cell) for cell in _touching(x, y)):
            return False
    inner = ([(a[i] + t * step[i]) / SCALE for i in (0, 1)] for t in cuts[1:-1])
    return all(
        _passes(blocked, int(x), int(y), step)
        for x, y in inner
        if x.denominator == y.denominator == 1
    )


def _crossings(a: int, b: int) -> list[Fraction]:
    """Return the parameters at which a coordinate from a to b is a whole number of cells."""
    if a == b:
        return []
    lines = range(min(a, b) // SCALE, max(a, b) // SCALE + 2)
    parameters = [Fraction(SCALE * line - a, b - a) for line in lines]
    return [t for t in parameters if 0 < t < 1]


def _touching(x: Fraction, y: Fraction) -> list[tuple[int, int]]:
    """Return the cells that touch a point that is no grid point: one, or two beside a line."""
    columns = {math.floor(x), math.ceil(x) - 1}
    return [(row, column) for row in {math.floor(y), math.ceil(y) - 1} for column in columns]


def _passes(blocked: Cells, x: int, y: int, step: Point) -> bool:
    """Return whether a line may pass a grid point: its two sides join over free cells there."""
    free = {cell for cell in cells_around(x, y) if not is_blocked(blocked, *cell)}
    before = free & _cells_towards(x, y, (-step[0], -step[1]))
    after = free & _cells_towards(x, y, step)
    reached, stack = set(before), list(before)
    while stack:
        row, column = stack.pop()
        for cell in ((row + 1, column), (row - 1, column), (row, column + 1), (row, column - 1)):
            if cell in free and cell not in reached:
                reached.add(cell)
                stack.append(cell)
    return bool(reached & after)


def _cells_towards(x: int, y: int, step: Point) -> set[tuple[int, int]]:
    """Return the cells that touch a line right after a grid point."""
    rows = [y] if step[1] > 0 else [y - 1] if step[1] < 0 else [y - 1, y]
    columns = [x] if step[0] > 0 else [x - 1] if step[0] < 0 else [x - 1, x]
    return {(row, column) for row in rows for column in columns}
