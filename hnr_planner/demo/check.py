"""
Check a path for the demo: every segment against the cells of the raw map file.

The check is slow and simple on purpose, and shares no code with the planner, so that an error
in the planner cannot repeat itself in the check.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
import math

from hnr_planner.maps import OccupancyMap
import numpy as np
from numpy.typing import ArrayLike, NDArray

#: How deep a path may lie in an obstacle, because of rounding [sides of a cell].
TOLERANCE = 1e-7

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class Check:
    """
    Result of the check of a path.

    Attributes
    ----------
    problems : tuple of str
        Descriptions of the faults; empty for a path that is free.
    length, clearance : float
        Length of the path, and its least distance to an occupied cell, a square [m]. Both are inf
        where there is no path; clearance also where no cell is occupied.
    segments : int
        Number of segments checked.

    """

    problems: tuple[str, ...]
    length: float
    clearance: float
    segments: int


def check_path(
    path: Floats,
    occupancy: OccupancyMap,
    start: tuple[float, float],
    goal: tuple[float, float],
    *,
    robot_radius: float = 0.0,
    occupied_threshold: int = 65,
) -> Check:
    """
    Check a path (m, 2) [m] against a map: its ends, collisions, and its clearance.

    Ends may be at most 1e-6 m from ``start`` and ``goal``. Unknown cells, occupied cells (chance
    of at least ``occupied_threshold`` percent) and the outside of the map are obstacles. From
    occupied cells alone a clearance is required: ``robot_radius`` [m] less one diagonal of a cell,
    since the planner inflates obstacles by distances between cell centres.
    """
    if len(path) == 0:
        return Check(('there is no path',), math.inf, math.inf, 0)
    data = np.asarray(occupancy.data).astype(int)
    occupied = (data >= occupied_threshold) & (data <= 100)
    blocked = occupied | (data < 0) | (data > 100)
    points = _in_cells(path, occupancy)

    problems = [
        f'it {verb} at ({at[0]:.6g}, {at[1]:.6g}), {math.dist(at, wanted):.2g} m off'
        for verb, at, wanted in (('starts', path[0], start), ('ends', path[-1], goal))
        if not math.dist(at, wanted) <= 1e-6
    ]
    segments = list(pairwise(points)) or [(points[0], points[0])]
    for number, (a, b) in enumerate(segments):
        problem = _collision(a, b, blocked)
        if problem:
            problems.append(f'segment {number} {problem}')
    clearance = _clearance(segments, occupied) * occupancy.resolution
    promised = robot_radius - (math.sqrt(2) + TOLERANCE) * occupancy.resolution
    if clearance < promised:  # not so for NaN, which has been named already
        problems.append(f'it comes within {clearance:.3f} m of an obstacle')
    length = float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())
    return Check(tuple(problems), length, clearance, len(segments))


def _in_cells(path: Floats, occupancy: OccupancyMap) -> Floats:
    """
    Return the points (m, 2) of a path as (column, row) in the map's grid, in sides of a cell.

    (0, 0) is the outer corner of cell [0, 0]; the map's origin and yaw are taken into account.
    """
    x, y, yaw = occupancy.origin
    away = np.asarray(path, dtype=float) - (x, y)
    cos, sin = math.cos(yaw), math.sin(yaw)
    turned = np.stack(
        (cos * away[:, 0] + sin * away[:, 1], cos * away[:, 1] - sin * away[:, 0]), axis=1
    )
    return turned / occupancy.resolution


def _collision(a: Floats, b: Floats, blocked: Bools) -> str:
    """
    Return a description of the collision of a segment from ``a`` to ``b``, or an empty string.

    Both ends are (column, row) as ``_in_cells`` returns them; ``blocked`` is (rows, cols).
    """
    if not np.isfinite([a, b]).all():
        return 'is not finite'
    rows, cols = blocked.shape
    low, high = np.minimum(a, b), np.maximum(a, b)
    if (low < -TOLERANCE).any() or (high > np.array((cols, rows)) + TOLERANCE).any():
        return 'leaves the map'
    (left, bottom), window = _window(blocked, low, high, reach=1.0)
    # Squares are shrunk by the tolerance; pairs of neighbours close the seams that this opens.
    for height, width in ((1, 1), (1, 2), (2, 1)):
        full = _full(window, height, width)
        corner = np.argwhere(full)[:, ::-1] + (left, bottom)
        if _distances(a, b, corner + TOLERANCE, corner + (width, height) - TOLERANCE).min() <= 0:
            return 'runs into an obstacle'
    # Two obstacles that touch in one corner: nothing passes between them.
    ll, lr, ul, ur = window[:-1, :-1], window[:-1, 1:], window[1:, :-1], window[1:, 1:]
    pinched = (ll & ur & ~lr & ~ul) | (lr & ul & ~ll & ~ur)
    corner = np.argwhere(pinched)[:, ::-1] + (left + 1, bottom + 1)
    if _distances(a, b, corner, corner).min() <= 2 * TOLERANCE:
        return 'squeezes between two obstacles that share a corner'
    return ''


def _clearance(segments: list[tuple[Floats, Floats]], occupied: Bools) -> float:
    """
    Return the least distance, in sides of a cell, from segments to occupied cells.

    It is inf where no cell is occupied, and NaN where an end of a segment is not finite.
    """
    best = math.inf
    for a, b in segments:
        if not np.isfinite([a, b]).all():
            return math.nan
        corner, window = _window(occupied, np.minimum(a, b), np.maximum(a, b), reach=best)
        squares = np.argwhere(window)[:, ::-1] + corner
        best = min(best, float(_distances(a, b, squares, squares + 1.0).min()))
    return best


def _window(
    cells: Bools, low: Floats, high: Floats, reach: float
) -> tuple[tuple[int, int], Bools]:
    """
    Return the (column, row) of the first cell within reach of a box, and the cells from there on.

    The box is from ``low`` to ``high`` as (column, row), ``reach`` is in sides of a cell; the
    cells are a rectangular view of ``cells`` (rows, cols), with a margin of one cell where the
    grid has one.
    """
    limit = np.array(cells.shape[::-1])
    first = np.floor(np.clip(low - reach - 1, 0, limit)).astype(int)
    last = np.ceil(np.clip(high + reach + 1, 0, limit)).astype(int)
    left, bottom = first.tolist()
    right, top = last.tolist()
    return (left, bottom), cells[bottom:top, left:right]


def _full(cells: Bools, height: int, width: int) -> Bools:
    """
    Return whether every cell of a rectangle of ``height`` x ``width`` cells is set.

    Element [row, column] is about the rectangle whose first cell is [row, column]; there is one
    for every place where the rectangle lies inside ``cells``.
    """
    rows, cols = cells.shape
    up, right = max(rows - height + 1, 0), max(cols - width + 1, 0)
    full = np.ones((up, right), dtype=bool)
    for row in range(height):
        for col in range(width):
            full &= cells[row:, col:][:up, :right]
    return full


def _distances(a: Floats, b: Floats, lows: ArrayLike, highs: ArrayLike) -> Floats:
    """
    Return the distance (k,) from a segment to each of k boxes; for k = 0 one element, inf.

    The boxes are from ``lows`` to ``highs``, both (k, 2). The distance to a box that the segment
    meets is 0; else one of the two nearest points is an end of the segment or a corner of the box.
    """
    low, high = np.asarray(lows, dtype=float), np.asarray(highs, dtype=float)
    if len(low) == 0:
        return np.array([math.inf])
    ends = [np.linalg.norm(p - np.clip(p, low, high), axis=1) for p in (a, b)]
    corners = np.stack((low, np.c_[high[:, 0], low[:, 1]], high, np.c_[low[:, 0], high[:, 1]]))
    along = b - a
    t = np.clip((corners - a) @ along / max(float(along @ along), 1e-300), 0, 1)
    to_corners = np.linalg.norm(a + t[..., None] * along - corners, axis=2)
    apart = np.minimum.reduce([*ends, *to_corners])
    return np.where(_meets(a, b, low, high), 0.0, apart)


def _meets(a: Floats, b: Floats, low: Floats, high: Floats) -> Bools:
    """Return whether the segment meets each of k boxes (k,), by the test of separating axes."""
    beside = (np.maximum(a, b) < low).any(axis=1) | (np.minimum(a, b) > high).any(axis=1)
    normal = np.array((a[1] - b[1], b[0] - a[0]))
    offset = np.abs(((low + high) / 2 - a) @ normal)
    return ~beside & (offset <= ((high - low) / 2) @ np.abs(normal))
