"""Where a grid lies in the map: between metres of the map frame and cells of the kernel frame."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
import math
from typing import ClassVar

from hnr_planner.core.checks import check_real, Floats
from hnr_planner.core.errors import SpaceError
import numpy as np

#: Coordinates must resolve this part of a cell, or free and blocked cannot be told apart.
FINEST = 1e-6


@dataclass(frozen=True)
class GridFrame:
    """
    Frame of a grid: origin and yaw are applied here and nowhere else.

    The kernel frame has one unit for one cell. It starts one cell before the grid, at the corner
    of a rim of blocked cells, so that every ray ends inside the arrays.

    Attributes
    ----------
    resolution : float
        Side of a cell [m].
    origin : (x, y, yaw)
        Pose of the outer corner of cell [0, 0] in the map frame [m, m, rad].
    shape : (rows, columns)
        Cells of the grid, without the rim.

    """

    resolution: float
    origin: tuple[float, float, float]
    shape: tuple[int, int]

    RIM: ClassVar[int] = 1

    @classmethod
    def checked(
        cls, resolution: float, origin: Iterable[float], shape: tuple[int, ...]
    ) -> 'GridFrame':
        """Build a frame from a caller's numbers, or raise SpaceError naming the wrong one."""
        resolution = check_real('resolution', resolution, SpaceError)
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
        """Spacing of the floating-point numbers at the far end of the map, in cells."""
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
    def _corner(self) -> Floats:
        return np.array(self.origin[:2])

    def to_kernel(self, points: Floats) -> Floats:
        """Bring points (..., 2) [m] of the map frame into the kernel frame."""
        return self.turn_to_kernel(points - self._corner) / self.resolution + self.RIM

    def from_kernel(self, cells: Floats) -> Floats:
        """Bring points (..., 2) of the kernel frame into the map frame [m]."""
        return _turned((cells - self.RIM) * self.resolution, self.origin[2]) + self._corner

    def turn_to_kernel(self, directions: Floats) -> Floats:
        """Turn directions (..., 2) of the map frame into the grid's frame."""
        return _turned(directions, -self.origin[2])


def _turned(points: Floats, angle: float) -> Floats:
    """Turn points (..., 2) by ``angle`` [rad]; one point or many, the same to the last bit."""
    if angle == 0.0:
        return points
    cos, sin = math.cos(angle), math.sin(angle)
    turned = np.empty_like(points)
    x, y = points[..., 0], points[..., 1]
    turned[..., 0] = x * cos - y * sin
    turned[..., 1] = x * sin + y * cos
    return turned
