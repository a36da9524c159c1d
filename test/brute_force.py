"""
An independent checker of paths and chords: slow, and obviously right.

It shares no code with the planner. A path is compared with every blocked cell that a segment
comes near; a chord is found in exact fractions, by cutting the line with every blocked square.
"""

from fractions import Fraction
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

TOLERANCE = 1e-7
"""How deep, in cells, a path may lie in a blocked square before it counts as a collision."""


def blocked_cells(
    occupied: ArrayLike,
    resolution: float,
    robot_radius: float,
    unknown: ArrayLike | None = None,
) -> NDArray[np.bool_]:
    """
    Return the cells that a round robot may not enter, by the definition.

    Parameters
    ----------
    occupied : (rows, cols) bool
        Cells with an obstacle.
    resolution : float
        Side of a cell [m].
    robot_radius : float
        A cell is blocked when its centre is this near to the centre of an occupied cell [m].
    unknown : (rows, cols) bool, optional
        Cells that block themselves and nothing around them.

    """
    occupied = np.asarray(occupied, dtype=bool)
    rows, cols = occupied.shape
    largest = (robot_radius / resolution) ** 2 + 1e-9
    reach = min(int(np.sqrt(largest)), max(rows, cols))
    padded = np.pad(occupied, reach)
    blocked = np.zeros_like(occupied)
    for i in range(-reach, reach + 1):
        for j in range(-reach, reach + 1):
            if i**2 + j**2 <= largest:
                # Cell [row, col] is blocked by an occupied cell [row + i, col + j].
                row, col = reach + i, reach + j
                blocked |= padded[row:, col:][:rows, :cols]
    if unknown is not None:
        blocked |= np.asarray(unknown, dtype=bool)
    return blocked


def path_collisions(
    path: ArrayLike,
    blocked: ArrayLike,
    resolution: float,
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0),
    *,
    robot_radius: float = 0.0,
) -> list[str]:
    """
    Return every collision of a path with a map, in words; an empty list is a free path.

    The blocked region (with everything outside the map) is shrunk by TOLERANCE of a cell. The
    gap that this opens between two cells that share an edge stays closed, and so does the gap
    between two cells that share a corner only.

    Parameters
    ----------
    path : (m, 2) float
        Points in the map frame [m]; one point alone is checked as a point.
    blocked : (rows, cols) bool
        Cells that may not be entered; row 0 is nearest the origin.
    resolution : float
        Side of a cell [m].
    origin : (x, y, yaw)
        Pose of the outer corner of cell [0, 0] in the map frame [m, m, rad].
    robot_radius : float
        When positive, `blocked` holds the occupied cells and is first inflated by this [m].

    """
    points = np.asarray(path, dtype=float)
    if points.ndim != 2 or points.shape[1] != 2 or len(points) == 0:
        return [f'a path has the shape (m, 2) with m >= 1, this one has {points.shape}']
    blocked = np.asarray(blocked, dtype=bool)
    if robot_radius > 0.0:
        blocked = blocked_cells(blocked, resolution, robot_radius)
    x, y, yaw = origin
    cos, sin = np.cos(yaw), np.sin(yaw)
    away = points - (x, y)
    cells = away @ np.array([[cos, -sin], [sin, cos]]) / resolution

    found, obstacles = [], _obstacles(blocked)
    for index in range(max(len(points) - 1, 1)):
        last = min(index + 1, len(points) - 1)
        for what in _segment(cells[index], cells[last], obstacles):
            where = f'segment {index} from {_words(points[index])} to {_words(points[last])}'
            found.append(f'{where} {what}')
    return found


def chord_by_search(
    blocked: ArrayLike,
    point: ArrayLike,
    direction: ArrayLike,
    resolution: float = 1.0,
    origin: tuple[float, float] = (0.0, 0.0),
) -> tuple[Fraction, Fraction]:
    """
    Return the chord of a grid around a point, exactly: (lower, upper) in units of |direction|.

    Every float is taken as the rational number that it is. Blocked squares are closed, the map
    is open; a point that is not free has the chord (0, 0).

    Parameters
    ----------
    blocked : (rows, cols) bool
        Cells that may not be entered; row 0 is nearest the origin.
    point, direction : (2,) float
        The line, in the frame of `origin` (no yaw).
    resolution : float
        Side of a cell.
    origin : (x, y)
        Outer corner of cell [0, 0].

    """
    blocked = np.asarray(blocked, dtype=bool)
    rows, cols = blocked.shape
    start = [
        (Fraction(float(p)) - Fraction(float(o))) / Fraction(float(resolution))
        for p, o in zip(np.asarray(point), origin, strict=True)
    ]
    step = [Fraction(float(u)) / Fraction(float(resolution)) for u in np.asarray(direction)]
    if step == [0, 0]:
        raise ValueError('a direction of length zero has no chord')

    inside_map = 0 < start[0] < cols and 0 < start[1] < rows
    if not inside_map:
        return Fraction(0), Fraction(0)
    map_cut = _cut(start, step, (0, cols), (0, rows))
    assert map_cut is not None
    lower, upper = map_cut
    for row, col in np.argwhere(blocked).tolist():
        cut = _cut(start, step, (col, col + 1), (row, row + 1))
        if cut is None:
            continue
        first, last = cut
        if first <= 0 <= last:
            return Fraction(0), Fraction(0)
        if first > 0:
            upper = min(upper, first)
        else:
            lower = max(lower, last)
    return lower, upper


def _cut(
    start: list[Fraction],
    step: list[Fraction],
    x_range: tuple[int, int],
    y_range: tuple[int, int],
) -> tuple[Fraction, Fraction] | None:
    """Return the parameters at which a line enters and leaves a closed box, None for a miss."""
    entries: list[Fraction] = []
    exits: list[Fraction] = []
    for at, speed, (low, high) in zip(start, step, (x_range, y_range), strict=True):
        if speed == 0:
            if not low <= at <= high:
                return None
            continue
        ends = sorted(((low - at) / speed, (high - at) / speed))
        entries.append(ends[0])
        exits.append(ends[1])
    first, last = max(entries), min(exits)
    return (first, last) if first <= last else None


class _Obstacles(NamedTuple):
    """What a path may meet; the outside is a ring of blocked cells, so that indices are 1 more."""

    #: Shape of the map, without the ring.
    shape: tuple[int, int]
    #: For each size (height, width): whether the rectangle with its lowest cell here is blocked.
    #: Those larger than a cell close the gaps between shrunk neighbours.
    rectangles: dict[tuple[int, int], NDArray[np.bool_]]
    #: For each slope of the bar between them: whether the corner at the upper right of a cell is
    #: shared by two diagonal obstacles only.
    corners: dict[float, NDArray[np.bool_]]


def _obstacles(blocked: NDArray[np.bool_]) -> _Obstacles:
    """Return all rectangles of blocked cells, and all corners of diagonal ones."""
    ringed = np.pad(blocked, 1, constant_values=True)
    lower_left, lower_right = ringed[:-1, :-1], ringed[:-1, 1:]
    upper_left, upper_right = ringed[1:, :-1], ringed[1:, 1:]
    return _Obstacles(
        blocked.shape,
        {size: _all_blocked(ringed, *size) for size in ((1, 1), (1, 2), (2, 1), (2, 2))},
        {
            1.0: lower_left & upper_right & ~lower_right & ~upper_left,
            -1.0: lower_right & upper_left & ~lower_left & ~upper_right,
        },
    )


def _segment(a: NDArray, b: NDArray, obstacles: _Obstacles) -> list[str]:
    """Return what one segment, given in cells, collides with."""
    if not (np.isfinite(a).all() and np.isfinite(b).all()):
        return ['is not finite']
    rows, cols = obstacles.shape
    lowest, highest = np.minimum(a, b), np.maximum(a, b)
    if (lowest < -TOLERANCE).any() or (highest > np.array([cols, rows]) + TOLERANCE).any():
        return ['leaves the map']

    # The cells near it, in the ring's indices; nothing beyond them comes near.
    left, bottom = np.maximum(np.floor(lowest).astype(int) - 1, 0).tolist()
    right, top = np.minimum(np.floor(highest).astype(int) + 4, (cols + 2, rows + 2)).tolist()
    lots = []
    for (height, width), full in obstacles.rectangles.items():
        last_row, last_col = top - height + 1, right - width + 1
        row, col = np.nonzero(full[bottom:last_row, left:last_col])
        lots.append([row, col, np.full(len(row), height), np.full(len(row), width)])
    row, col, height, width = np.concatenate(lots, axis=1)
    row, col = row + (bottom - 1), col + (left - 1)
    low = np.stack([col, row], axis=1) + TOLERANCE
    high = np.stack([col + width, row + height], axis=1) - TOLERANCE
    met = np.flatnonzero(_meets_boxes(a, b, low, high))
    found = [_entered(row[k], col[k], height[k], width[k]) for k in met]
    last_row, last_col = top - 1, right - 1
    for slope, corners in obstacles.corners.items():
        for row_near, col_near in np.argwhere(corners[bottom:last_row, left:last_col]):
            corner = row_near + bottom, col_near + left
            if _squeezes(a, b, *corner, slope):
                found.append(
                    'squeezes between two diagonal blocked cells '
                    f'at the corner of row {corner[0]}, column {corner[1]}'
                )
    return found


def _all_blocked(cells: NDArray[np.bool_], height: int, width: int) -> NDArray[np.bool_]:
    """Return for every window of the given size whether all its cells are blocked."""
    rows, cols = cells.shape
    rows_left, cols_left = rows - height + 1, cols - width + 1
    full = np.ones((rows_left, cols_left), dtype=bool)
    for i in range(height):
        for j in range(width):
            full &= cells[i:, j:][:rows_left, :cols_left]
    return full


def _meets_boxes(a: NDArray, b: NDArray, low: NDArray, high: NDArray) -> NDArray[np.bool_]:
    """
    Return for every closed box whether the closed segment a-b meets it.

    A segment and a box are apart exactly when one of three directions separates them: the two
    axes, and the normal of the segment.
    """
    apart = (np.maximum(a, b) < low).any(axis=1) | (np.minimum(a, b) > high).any(axis=1)
    normal = np.array([a[1] - b[1], b[0] - a[0]])
    height = ((low + high) / 2 - a) @ normal
    reach = ((high - low) / 2) @ np.abs(normal)
    return ~(apart | (np.abs(height) > reach))


def _squeezes(a: NDArray, b: NDArray, row: int, col: int, slope: float) -> bool:
    """Return whether a segment goes through a corner that two diagonal obstacles share."""
    # The bar from one obstacle to the other lies on y = slope * x seen from the corner.
    (ax, ay), (bx, by) = a - (col, row), b - (col, row)
    a_side, b_side = ay - slope * ax, by - slope * bx
    if a_side * b_side > 0.0:
        return False
    if a_side == b_side:
        crossed = sorted((ax, bx))
    else:
        crossed = [ax + (bx - ax) * a_side / (a_side - b_side)] * 2
    # Somewhat longer than the gap, so that nothing slips in between bar and square.
    return crossed[0] <= 2 * TOLERANCE and crossed[1] >= -2 * TOLERANCE


def _entered(row: int, col: int, height: int, width: int) -> str:
    """Return the words for a rectangle of blocked cells that a segment meets."""
    if (height, width) == (1, 1):
        return f'enters the blocked cell at row {row}, column {col}'
    last = f'row {row + height - 1}, column {col + width - 1}'
    return f'runs between the blocked cells from row {row}, column {col} to {last}'


def _words(point: NDArray) -> str:
    """Return a point for a message."""
    return f'({point[0]:.9g}, {point[1]:.9g}) m'
