"""The frame of a grid: between metres of the map frame and cells of the kernel frame."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
import math
from typing import ClassVar

from hnr_planner.core.checks import check_real, Floats
from hnr_planner.core.errors import SpaceError
from hnr_planner.core.kernels.kernel import inlined, kernel
import numpy as np

#: Coordinates must resolve this fraction of a cell to distinguish free cells from blocked ones.
FINEST = 1e-6


@dataclass(frozen=True)
class GridFrame:
    """
    The frame of a grid: the conversion between metres in the map frame and cells.

    One unit of the kernel frame is one cell. The frame starts one cell before the grid, at the
    corner of a rim of blocked cells, so that every ray ends inside the arrays.

    Attributes
    ----------
    resolution : float
        Side of a cell [m].
    origin : (x, y, yaw)
        Pose of the outer corner of cell [0, 0] in the map frame [m, m, rad].
    shape : (rows, columns)
        Numbers of rows and columns of the grid, without the rim.

    """

    resolution: float
    origin: tuple[float, float, float]
    shape: tuple[int, int]

    RIM: ClassVar[int] = 1

    @classmethod
    def checked(
        cls, resolution: float, origin: Iterable[float], shape: tuple[int, ...]
    ) -> 'GridFrame':
        """
        Build a frame from a caller's numbers, or raise SpaceError that names the wrong number.

        A resolution of single precision, as in a ROS message, is replaced by the decimal that it
        rounds (see ``decimal``).
        """
        resolution = decimal(check_real('resolution', resolution, SpaceError))
        if not 0.0 < resolution < math.inf:
            raise SpaceError(f'resolution must be above 0 and finite, got {resolution!r}')
        try:
            x, y, yaw = np.asarray(origin, dtype=np.float64).tolist()
        except (TypeError, ValueError, OverflowError):
            x = y = yaw = math.nan
        if not all(map(math.isfinite, (x, y, yaw))):
            raise SpaceError(f'origin must be three finite numbers (x, y, yaw), got {origin!r}')
        frame = cls(resolution, (x, y, yaw), (int(shape[0]), int(shape[1])))
        if not frame.rounding <= FINEST:
            raise SpaceError(
                f'origin {frame.origin} is too far away: coordinates there are rounded to '
                f'{frame.rounding:.2g} of a cell of {resolution:g} m, more than {FINEST:g}'
            )
        return frame

    @cached_property
    def rounding(self) -> float:
        """Spacing of floats [cells] at the largest coordinate of the map in the map frame."""
        extent = math.hypot(*self.shape) * self.resolution
        farthest = max(abs(self.origin[0]), abs(self.origin[1])) + extent
        return float(np.spacing(farthest)) / self.resolution

    @cached_property
    def corners(self) -> Floats:
        """Corners (4, 2) of the grid in the kernel frame, counter-clockwise from the origin."""
        rows, columns = self.shape
        unit = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
        return unit * np.array([columns, rows], dtype=np.float64) + self.RIM

    @cached_property
    def _turn(self) -> tuple[float, float]:
        """Cosine and sine of the yaw, exact for a yaw of 0."""
        return math.cos(self.origin[2]), math.sin(self.origin[2])

    @cached_property
    def _numbers(self) -> tuple[float, float, float, float, float, int]:
        """Origin x and y [m], cosine and sine of the yaw, resolution [m] and rim [cells]."""
        x, y, _ = self.origin
        return x, y, *self._turn, self.resolution, self.RIM

    @cached_property
    def to_cells(self) -> tuple[Floats, Floats]:
        """Matrix (2, 2) and offset (2,) from the map frame [m] to the kernel frame [cells]."""
        cos, sin = self._turn
        matrix = np.array([[cos, sin], [-sin, cos]]) / self.resolution
        return matrix, self.RIM - matrix @ np.array(self.origin[:2])

    def to_kernel(self, points: Floats) -> Floats:
        """Convert points (..., 2) [m] of the map frame to the kernel frame [cells]."""
        if points.ndim == 2 and points.flags.c_contiguous:  # the usual case, at little cost
            return _to_cells(points, *self._numbers)
        return _to_cells(_in_rows(points), *self._numbers).reshape(points.shape)

    def from_kernel(self, cells: Floats) -> Floats:
        """Convert points (..., 2) of the kernel frame [cells] to the map frame [m]."""
        if cells.ndim == 2 and cells.flags.c_contiguous:
            return _from_cells(cells, *self._numbers)
        return _from_cells(_in_rows(cells), *self._numbers).reshape(cells.shape)

    def turn_to_kernel(self, directions: Floats) -> Floats:
        """Rotate directions (..., 2) of the map frame into the kernel frame, unscaled."""
        return _to_cells(_in_rows(directions), 0.0, 0.0, *self._turn, 1.0, 0).reshape(
            directions.shape
        )


def decimal(number: float) -> float:
    """
    Return the decimal of six digits whose single-precision value is ``number``, if any.

    A ROS message carries the resolution .05 in single precision, as .05000000074505806, and ratios
    of such lengths would miss whole numbers. A decimal of six digits is determined by its value in
    single precision. A number that is no such value is returned unchanged.
    """
    short = float(f'{number:.6g}')
    with np.errstate(over='ignore', under='ignore'):
        return short if float(np.float32(short)) == number else number


def _in_rows(points: Floats) -> Floats:
    """Return points (..., 2) as (k, 2), in C order, for which kernels are compiled."""
    return np.ascontiguousarray(points).reshape(-1, 2)


@kernel
def _to_cells(points, x, y, cos, sin, resolution, rim):
    """
    Return ``points`` (k, 2) [m] in the grid's frame at (x, y) [cells], plus ``rim`` [cells].

    ``cos`` and ``sin`` are those of the yaw of the grid's frame.
    """
    cells = np.empty_like(points)
    for k in range(len(points)):
        cells[k, 0], cells[k, 1] = cell_of(
            points[k, 0], points[k, 1], x, y, cos, sin, resolution, rim
        )
    return cells


@kernel
def _from_cells(cells, x, y, cos, sin, resolution, rim):
    """Return the points (k, 2) [m] at ``cells`` (k, 2) [cells]: the inverse of ``_to_cells``."""
    points = np.empty_like(cells)
    for k in range(len(cells)):
        points[k, 0], points[k, 1] = point_of(
            cells[k, 0], cells[k, 1], x, y, cos, sin, resolution, rim
        )
    return points


@inlined
def cell_of(px, py, x, y, cos, sin, resolution, rim):
    """Return the point (px, py) [m] in the grid's frame at (x, y), plus ``rim`` [cells]."""
    dx, dy = px - x, py - y
    return (dx * cos + dy * sin) / resolution + rim, (dy * cos - dx * sin) / resolution + rim


@inlined
def point_of(cx, cy, x, y, cos, sin, resolution, rim):
    """Return the point [m] at (cx, cy) [cells]: the inverse of ``cell_of``."""
    dx, dy = (cx - rim) * resolution, (cy - rim) * resolution
    return dx * cos - dy * sin + x, dx * sin + dy * cos + y
