"""A space whose kernel frame is that of a grid: metres for the caller, cells for kernels."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

from hnr_planner.core.checks import Floats
from hnr_planner.core.spaces.grid.frame import GridFrame
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.spaces.transformed import TransformedData
import numpy as np
from numpy.typing import ArrayLike


@dataclass(frozen=True, eq=False, repr=False)
class FramedSpace(Space):
    """
    A space of points (x, y) [m] in the map frame, whose kernels count in the cells of a grid.

    A subclass defines which points are free by a field ``data``, the compiled space in cells.

    Attributes
    ----------
    frame : GridFrame
        Resolution, origin and shape of the grid.

    """

    frame: GridFrame

    dim = 2

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of rows and columns of the grid, without the rim."""
        return self.frame.shape

    @property
    def resolution(self) -> float:
        """Side of a cell [m]."""
        return self.frame.resolution

    @property
    def origin(self) -> tuple[float, float, float]:
        """Pose (x, y, yaw) of the outer corner of cell [0, 0] in the map frame [m, m, rad]."""
        return self.frame.origin

    @property
    def scale(self) -> float:
        """Metres in one unit of the kernel frame, which is one cell."""
        return self.frame.resolution

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (2,) [m] of a box around the grid, in the map frame."""
        corners = self.from_kernel(self.frame.corners)
        return corners.min(axis=0), corners.max(axis=0)

    @cached_property
    def kernel_bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (2,) of the grid in the kernel frame [cells]."""
        return self.frame.corners[0], self.frame.corners[2]

    @property
    def _rounding(self) -> float:
        """Rounding [cells] of the coordinates of points in the map frame."""
        return self.frame.rounding

    def compiled_at(self, origin: Floats | None) -> TransformedData:
        """
        Return the compiled space in metres from ``origin``, along the axes of the map frame.

        ``origin`` (2,) [m] is a point of the map frame; None keeps the origin of the map frame.
        """
        matrix, offset = self.frame.to_cells
        if origin is not None:
            offset = self.frame.to_kernel(origin)
        return TransformedData(self.data, matrix, offset)

    @cached_property
    def compiled(self) -> Any:
        """The compiled space in the map frame."""
        return self.compiled_at(None)

    def to_kernel(self, points: Floats) -> Floats:
        """Convert points (..., 2) [m] of the map frame to the kernel frame [cells]."""
        return self.frame.to_kernel(points)

    def from_kernel(self, points: Floats) -> Floats:
        """Convert points (..., 2) of the kernel frame [cells] to the map frame [m]."""
        return self.frame.from_kernel(points)

    def turn_to_kernel(self, directions: Floats) -> Floats:
        """Rotate directions (..., 2) of the map frame into the kernel frame, unscaled."""
        return self.frame.turn_to_kernel(directions)

    def to_cells(self, points: Floats) -> Floats:
        """
        Convert points (..., 2) [m] of the map frame to (column, row) [cells] from cell [0, 0].

        They are counted from the outer corner of that cell, without the rim.
        """
        return self.frame.to_kernel(points) - self.frame.RIM

    def from_cells(self, cells: Floats) -> Floats:
        """
        Convert (column, row) (..., 2) [cells] to points (..., 2) [m] of the map frame.

        They are counted from the outer corner of cell [0, 0], without the rim.
        """
        return self.frame.from_kernel(cells + self.frame.RIM)

    def cell_centres(self, rows: ArrayLike, columns: ArrayLike) -> Floats:
        """Return the centres (k, 2) [m] of cells at ``rows`` and ``columns`` (k,), map frame."""
        cells = np.stack([np.asarray(columns), np.asarray(rows)], axis=-1)
        return self.frame.from_kernel(cells + (self.frame.RIM + 0.5))
