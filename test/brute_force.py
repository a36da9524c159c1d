"""
An independent checker of paths and chords: slow, and obviously right.

It shares no code with the planner. A path is compared with every blocked cell that a segment
comes near; a chord is found in exact fractions, by cutting the line with every blocked square.
"""

from fractions import Fraction

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

    found = []
    for index in range(max(len(points) - 1, 1)):
        last = min(index + 1, len(points) - 1)
        where = f'segment {index} from {_words(points[index])} to {_words(points[last])}'
        found += [f'{where} {what}' for what in _segment(cells[index], cells[last], blocked)]
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


def _segment(a: NDArray, b: NDArray, blocked: NDArray[np.bool_]) -> list[str]:
    """Return what one segment, given in cells, collides with."""
    if not (np.isfinite(a).all() and np.isfinite(b).all()):
        return ['is not finite']
    rows, cols = blocked.shape
    lowest, highest = np.minimum(a, b), np.maximum(a, b)
    if (lowest < -TOLERANCE).any() or (highest > np.array([cols, rows]) + TOLERANCE).any():
        return ['leaves the map']

    # The outside is a ring of blocked cells: the cell [row, col] is ringed[row + 1, col + 1].
    ringed = np.pad(blocked, 1, constant_values=True)
    first_col, first_row = np.maximum(np.floor(lowest).astype(int) - 2, -1)
    last_col, last_row = np.minimum(np.floor(highest).astype(int) + 2, (cols, rows))
    top, right = last_row + 2, last_col + 2
    bottom, left = first_row + 1, first_col + 1
    near = ringed[bottom:top, left:right]

    found = []
    for height, width in ((1, 1), (1, 2), (2, 1), (2, 2)):
        # Rectangles of blocked cells: the larger ones close the gaps between shrunk neighbours.
        full = _all_blocked(near, height, width)
        row, col = np.argwhere(full).T + [[first_row], [first_col]]
        low = np.stack([col, row], axis=1) + TOLERANCE
        high = np.stack([col + width, row + height], axis=1) - TOLERANCE
        for k in np.flatnonzero(_meets_boxes(a, b, low, high)):
            found.append(_entered(row[k], col[k], height, width))
    return found + _squeezes(a, b, near, first_row, first_col)


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


def _squeezes(
    a: NDArray, b: NDArray, near: NDArray[np.bool_], first_row: int, first_col: int
) -> list[str]:
    """Return the corners, shared by two diagonal obstacles only, that a segment goes through."""
    lower_left, lower_right = near[:-1, :-1], near[:-1, 1:]
    upper_left, upper_right = near[1:, :-1], near[1:, 1:]
    rising = lower_left & upper_right & ~lower_right & ~upper_left
    falling = lower_right & upper_left & ~lower_left & ~upper_right
    found = []
    for corners, slope in ((rising, 1.0), (falling, -1.0)):
        for row, col in np.argwhere(corners) + (first_row + 1, first_col + 1):
            # The bar from one obstacle to the other lies on y = slope * x seen from the corner.
            (ax, ay), (bx, by) = a - (col, row), b - (col, row)
            a_side, b_side = ay - slope * ax, by - slope * bx
            if a_side * b_side > 0.0:
                continue
            if a_side == b_side:
                crossed = sorted((ax, bx))
            else:
                crossed = [ax + (bx - ax) * a_side / (a_side - b_side)] * 2
            # Somewhat longer than the gap, so that nothing slips in between bar and square.
            if crossed[0] <= 2 * TOLERANCE and crossed[1] >= -2 * TOLERANCE:
                found.append(
                    'squeezes between two diagonal blocked cells '
                    f'at the corner of row {row}, column {col}'
                )
    return found


def _entered(row: int, col: int, height: int, width: int) -> str:
    """Return the words for a rectangle of blocked cells that a segment meets."""
    if (height, width) == (1, 1):
        return f'enters the blocked cell at row {row}, column {col}'
    last = f'row {row + height - 1}, column {col + width - 1}'
    return f'runs between the blocked cells from row {row}, column {col} to {last}'


def _words(point: NDArray) -> str:
    """Return a point for a message."""
    return f'({point[0]:.9g}, {point[1]:.9g}) m'
