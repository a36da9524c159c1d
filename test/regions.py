"""
Sets that walks are tested on: membership and chords by arithmetic of their own.

It shares no code with the package, works on many points at once, and knows one more thing than a
space does: how to draw exactly uniform points, by throwing away what lies outside.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from math import prod

import numba
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

Points = NDArray[np.float64]

#: A point may lie so far outside before it has left the region: rounding of the caller's.
ROUNDING = 1e-9


class Region(ABC):
    """
    An open, bounded set in R^dim, cut into cells by a grid over its bounds.

    Attributes
    ----------
    lower, upper : (dim,)
        Corners of a box around it.
    bins : (dim,) ints
        Parts that each side of that box is cut into.

    """

    lower: Points
    upper: Points
    bins: tuple[int, ...]

    @abstractmethod
    def depth(self, points: Points) -> Points:
        """Return a number for each point (n, dim): above 0 inside, below outside."""

    @abstractmethod
    def chords(self, points: Points, directions: Points) -> tuple[Points, Points]:
        """Return the ends (n,) of the chords through points along directions (both (n, dim))."""

    @property
    def dim(self) -> int:
        """Dimension of the points."""
        return len(self.lower)

    @property
    def n_cells(self) -> int:
        """Number of cells, empty ones included."""
        return prod(self.bins)

    def uniform(self, n: int, rng: np.random.Generator) -> Points:
        """Draw exactly uniform points (n, dim)."""
        points = np.empty((0, self.dim))
        while len(points) < n:
            more = rng.uniform(self.lower, self.upper, (n, self.dim))
            points = np.concatenate([points, more[self.depth(more) > 0.0]])
        return points[:n]

    def cell_of(self, points: Points) -> NDArray[np.int64]:
        """Return the number of the cell of each point; every point must lie in the region."""
        assert (self.depth(points) > -ROUNDING).all(), 'a point has left the region'
        places = (points - self.lower) / (self.upper - self.lower) * self.bins
        inside = np.clip(places.astype(int), 0, np.array(self.bins) - 1)
        return np.ravel_multi_index(tuple(inside.T), self.bins)


@dataclass(frozen=True)
class CellRegion(Region):
    """The largest component of the free cells (rows, cols) of a grid, one unit to a cell."""

    occupied: NDArray[np.bool_]

    @cached_property
    def lower(self) -> Points:
        """Corner of cell [0, 0]."""
        return np.zeros(2)

    @cached_property
    def upper(self) -> Points:
        """Corner beyond the last cell."""
        return np.array(self.occupied.shape[::-1], dtype=float)

    @cached_property
    def bins(self) -> tuple[int, ...]:
        """Columns and rows."""
        return self.occupied.shape[::-1]

    @cached_property
    def inside(self) -> NDArray[np.bool_]:
        """Say which cells are part of it (rows, cols), in a frame of cells that are not."""
        labels, _ = ndimage.label(~self.occupied)
        return np.pad(labels == np.bincount(labels[labels > 0]).argmax(), 1)

    def depth(self, points: Points) -> Points:
        """Return 1 inside, -1 outside."""
        column, row = np.clip(np.floor(points).astype(int) + 1, 0, np.array(self.bins) + 1).T
        return np.where(self.inside[row, column], 1.0, -1.0)

    def chords(self, points: Points, directions: Points) -> tuple[Points, Points]:
        """Cut every line with every obstacle, one unit square after the other."""
        rows, cols = self.occupied.shape
        return _chords_past_squares(points, directions, np.argwhere(self.occupied), rows, cols)


@dataclass(frozen=True)
class PolytopeRegion(Region):
    """The points with ``normals x < offsets`` outside of balls."""

    lower: Points
    upper: Points
    bins: tuple[int, ...]
    normals: Points
    offsets: Points
    centres: Points
    radii: Points

    def depth(self, points: Points) -> Points:
        """Return the least of the slacks and of the distances to the balls."""
        depth = (self.offsets - points @ self.normals.T).min(axis=1)
        for centre, radius in zip(self.centres, self.radii, strict=True):
            depth = np.minimum(depth, np.linalg.norm(points - centre, axis=1) - radius)
        return depth

    def chords(self, points: Points, directions: Points) -> tuple[Points, Points]:
        """Cut every line with every plane and every sphere."""
        return _chords_past_balls(
            points, directions, self.normals, self.offsets, self.centres, self.radii
        )


@dataclass(frozen=True)
class UnionRegion(Region):
    """The points in any of some boxes and balls."""

    lower: Points
    upper: Points
    bins: tuple[int, ...]
    corners: Points
    centres: Points
    radii: Points

    def depth(self, points: Points) -> Points:
        """Return the largest depth in any of the pieces."""
        boxes = [np.minimum(points - low, high - points).min(axis=1) for low, high in self.corners]
        balls = [
            radius - np.linalg.norm(points - centre, axis=1)
            for centre, radius in zip(self.centres, self.radii, strict=True)
        ]
        return np.max(boxes + balls, axis=0)

    def chords(self, points: Points, directions: Points) -> tuple[Points, Points]:
        """Cut every line with every piece, and join the intervals that overlap."""
        first, last = self.pieces(points, directions)
        lower, upper = np.zeros(len(points)), np.zeros(len(points))
        for _ in range(first.shape[1]):
            upper = np.where((first <= upper[:, None]) & (last > 0), last, upper[:, None]).max(1)
            lower = np.where((last >= lower[:, None]) & (first < 0), first, lower[:, None]).min(1)
        return lower, upper

    def pieces(self, points: Points, directions: Points) -> tuple[Points, Points]:
        """Return the interval (n, k) of every line in every piece: (inf, -inf) for none."""
        return _cuts(points, directions, self.corners, self.centres, self.radii)


@dataclass(frozen=True)
class PolygonRegion(Region):
    """The points inside of closed rings, those that an odd number of rings surround."""

    lower: Points
    upper: Points
    bins: tuple[int, ...]
    rings: tuple[Points, ...]

    @cached_property
    def edges(self) -> Points:
        """Ends (k, 2, 2) of all edges."""
        return np.concatenate([np.stack([ring, np.roll(ring, -1, 0)], 1) for ring in self.rings])

    def depth(self, points: Points) -> Points:
        """Return 1 where a ray to the right crosses an odd number of edges, else -1."""
        odd = np.zeros(len(points), dtype=bool)
        x, y = points.T
        for (ax, ay), (bx, by) in self.edges:
            if ay != by:
                odd ^= ((ay > y) != (by > y)) & (x < ax + (y - ay) * (bx - ax) / (by - ay))
        return np.where(odd, 1.0, -1.0)

    def chords(self, points: Points, directions: Points) -> tuple[Points, Points]:
        """Cut every line with every edge."""
        x, u = points, directions
        lower, upper = np.full(len(points), -np.inf), np.full(len(points), np.inf)
        for a, b in self.edges:
            along = b - a
            det = u[:, 0] * along[1] - u[:, 1] * along[0]
            with np.errstate(divide='ignore', invalid='ignore'):
                s = ((a[0] - x[:, 0]) * along[1] - (a[1] - x[:, 1]) * along[0]) / det
                w = ((a[0] - x[:, 0]) * u[:, 1] - (a[1] - x[:, 1]) * u[:, 0]) / det
            hit = (w >= 0) & (w <= 1)
            upper = np.where(hit & (s > 0), np.minimum(upper, s), upper)
            lower = np.where(hit & (s < 0), np.maximum(lower, s), lower)
        return lower, upper


@dataclass(frozen=True)
class BentRegion(Region):
    """A box whose last coordinate was moved by ``bend`` times the square of the first."""

    lower: Points
    upper: Points
    bins: tuple[int, ...]
    low: Points
    high: Points
    bend: float

    def depth(self, points: Points) -> Points:
        """Return the least distance to a face of the box, once the points are moved back."""
        straight = points.copy()
        straight[:, -1] -= self.bend * points[:, 0] ** 2
        return np.minimum(straight - self.low, self.high - straight).min(axis=1)

    def chords(self, points: Points, directions: Points) -> tuple[Points, Points]:
        """Cut every line with the planes and with the two parabolas."""
        x, u = points, directions
        a = -self.bend * u[:, 0] ** 2
        b = u[:, -1] - 2 * self.bend * x[:, 0] * u[:, 0]
        c = x[:, -1] - self.bend * x[:, 0] ** 2
        cuts = []
        with np.errstate(divide='ignore', invalid='ignore'):
            for face in (self.low, self.high):
                cuts.extend(((face - x) / u)[:, :-1].T)
                q = -0.5 * (b + np.copysign(np.sqrt(b**2 - 4 * a * (c - face[-1])), b))
                cuts.extend((q / a, (c - face[-1]) / q))
            s = np.array(cuts)
            upper = np.where(s > 0, s, np.inf).min(axis=0)
            lower = np.where(s < 0, s, -np.inf).max(axis=0)
        return lower, upper


@numba.njit(cache=True)
def _chords_past_squares(points, directions, obstacles, rows, cols):
    lower, upper = np.empty(len(points)), np.empty(len(points))
    for k in range(len(points)):
        x, u = points[k], directions[k]
        lower[k], upper[k] = _cut_box(x, u, (0, 0), (cols, rows))
        for row, col in obstacles:
            first, last = _cut_box(x, u, (col, row), (col + 1, row + 1))
            if 0 < first <= last:
                upper[k] = min(upper[k], first)
            elif first <= last < 0:
                lower[k] = max(lower[k], last)
    return lower, upper


@numba.njit(cache=True)
def _chords_past_balls(points, directions, normals, offsets, centres, radii):
    lower, upper = np.full(len(points), -np.inf), np.full(len(points), np.inf)
    for k in range(len(points)):
        x, u = points[k], directions[k]
        for row in range(len(offsets)):
            slack, rate = offsets[row], 0.0
            for i in range(len(x)):
                slack -= normals[row, i] * x[i]
                rate += normals[row, i] * u[i]
            if rate > 0:
                upper[k] = min(upper[k], slack / rate)
            elif rate < 0:
                lower[k] = max(lower[k], slack / rate)
        for ball in range(len(radii)):
            first, last = _cut_ball(x, u, centres[ball], radii[ball])
            if 0 < first <= last:
                upper[k] = min(upper[k], first)
            elif first <= last < 0:
                lower[k] = max(lower[k], last)
    return lower, upper


@numba.njit(cache=True)
def _cuts(points, directions, corners, centres, radii):
    boxes, balls = len(corners), len(radii)
    first = np.empty((len(points), boxes + balls))
    last = np.empty_like(first)
    for k in range(len(points)):
        x, u = points[k], directions[k]
        for i in range(boxes):
            a, b = _cut_box(x, u, corners[i, 0], corners[i, 1])
            first[k, i], last[k, i] = (a, b) if a < b else (np.inf, -np.inf)
        for i in range(balls):
            first[k, boxes + i], last[k, boxes + i] = _cut_ball(x, u, centres[i], radii[i])
    return first, last


@numba.njit(cache=True)
def _cut_box(x, u, low, high):
    """Return the parameters at which a line enters and leaves a box: the first larger for none."""
    first, last = -np.inf, np.inf
    for i in range(len(x)):
        if u[i] != 0:
            a, b = (low[i] - x[i]) / u[i], (high[i] - x[i]) / u[i]
            first, last = max(first, min(a, b)), min(last, max(a, b))
        elif not low[i] <= x[i] <= high[i]:
            return np.inf, -np.inf
    return first, last


@numba.njit(cache=True)
def _cut_ball(x, u, centre, radius):
    """Return the parameters at which a line enters and leaves a ball: (inf, -inf) for none."""
    uu, ux, xx = 0.0, 0.0, 0.0
    for i in range(len(x)):
        uu += u[i] ** 2
        ux += u[i] * (x[i] - centre[i])
        xx += (x[i] - centre[i]) ** 2
    under_root = ux**2 - uu * (xx - radius**2)
    if under_root <= 0:
        return np.inf, -np.inf
    return (-ux - np.sqrt(under_root)) / uu, (-ux + np.sqrt(under_root)) / uu
