"""A space whose walks run in other coordinates, in which it is about as long in all directions."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.space import MARGIN, Space
from hnr_planner.core.spaces.transformed import multiply
import numpy as np
from numpy.typing import ArrayLike


@dataclass(frozen=True)
class Rounding:
    """
    What the rounding of a space has cost, and how far it came.

    Attributes
    ----------
    phases : int
        Number of phases.
    steps : int
        Number of steps of walks.
    seconds : float
        Processor time [s].
    ratio : float
        Largest standard deviation of the draws of the last phase over the smallest, over all
        directions; up to 2.5, the space counts as round.

    """

    phases: int
    steps: int
    seconds: float
    ratio: float


class RoundedSpace(Space):
    """
    The same points as another space; walks run in coordinates y with ``x = origin + matrix y``.

    Directions of Hit-and-Run and the axes of coordinate walks are those of y. A linear map keeps
    the uniform distribution, so that draws are uniform on the other space. Planners measure
    lengths, and take the other space itself, ``base``.

    Parameters
    ----------
    base : Space
        The space.
    matrix : (k, k)
        Invertible matrix from y to the kernel frame of the base, of dimension k.
    origin : (k,)
        The origin of y in the kernel frame of the base: a free point.
    rounding : Rounding, optional
        What the matrix has cost, if ``round_space`` has found it.

    Attributes
    ----------
    base, matrix, origin, rounding
        As above.

    """

    def __init__(
        self, base: Space, matrix: Floats, origin: Floats, rounding: Rounding | None = None
    ) -> None:
        self.rounding = rounding
        self.base, self.dim = base, base.dim
        self.matrix, self.origin = matrix.copy(), origin.copy()
        self._inverse = np.linalg.inv(self.matrix)
        self.data = base.transformed(self.matrix, self.origin)

    def __repr__(self) -> str:
        """Name the base."""
        return f'RoundedSpace(base={self.base!r})'

    @property
    def is_rigid(self) -> bool:
        """Whether the kernel frame keeps lengths: it does not."""
        return False

    @property
    def kernel_dim(self) -> int:
        """Dimension of the kernel frame: that of the base."""
        return self.base.kernel_dim

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,), caller's frame."""
        return self.base.bounds

    @cached_property
    def kernel_bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (kernel_dim,) of a box around the free points, kernel frame."""
        lower, upper = self.base.kernel_bounds
        middle = self._inverse @ ((lower + upper) / 2.0 - self.origin)
        half = np.abs(self._inverse) @ ((upper - lower) / 2.0)
        return middle - half, middle + half

    @property
    def scale(self) -> float:
        """Caller's units [m] in one unit of the kernel frame of the base."""
        return self.base.scale

    @property
    def zero_length(self) -> float:
        """Length up to which a chord counts as zero: ``MARGIN`` in coordinates of about 1."""
        return MARGIN

    @cached_property
    def typical_clearance(self) -> float:
        """Mean distance from a point of the ball of radius 1 to its boundary."""
        return 1.0 / (self.kernel_dim + 1)

    def compiled_at(self, origin: Floats | None) -> Any:
        """
        Return the compiled base, its coordinates along the caller's axes from ``origin``.

        ``origin`` (dim,) is a point of the caller's frame; None keeps the caller's own origin.
        """
        return self.base.compiled_at(origin)

    def transformed(self, matrix: Floats, origin: Floats) -> Any:
        """Return the compiled space in coordinates z with ``y = origin + matrix z``."""
        return self.base.transformed(self.matrix @ matrix, self.origin + self.matrix @ origin)

    def to_kernel(self, points: Floats) -> Floats:
        """Convert points (..., dim) of the caller's frame to the kernel frame, in a new array."""
        return np.ascontiguousarray((self.base.to_kernel(points) - self.origin) @ self._inverse.T)

    def from_kernel(self, points: Floats) -> Floats:
        """Convert points (..., kernel_dim) to the caller's frame, in a new array."""
        flat = np.ascontiguousarray(points.reshape(-1, points.shape[-1]))
        columns = np.ascontiguousarray(self.matrix.T)
        moved = _moved_points(columns, self.origin, flat).reshape(points.shape)
        return self.base.from_kernel(moved)

    def turn_to_kernel(self, directions: Floats) -> Floats:
        """Convert a direction (dim,) to the kernel frame, in a new array."""
        return np.ascontiguousarray(self._inverse @ self.base.turn_to_kernel(directions))

    def covers_box(self, lower: Floats, upper: Floats) -> bool:
        """Return whether the closure is known to contain the box between two corners (dim,)."""
        return self.base.covers_box(lower, upper)

    def contains(self, points: ArrayLike) -> Any:
        """
        Return which points are free.

        Parameters
        ----------
        points : (k, dim) or (dim,)
            Points in the caller's frame.

        Returns
        -------
        (k,) bool or bool

        """
        return self.base.contains(points)

    def chord(self, point: ArrayLike, direction: ArrayLike) -> Any:
        """
        Return the chord of the base through a point (dim,) along a direction (dim,).

        The ends are parameters in units of ``|direction|``. Raise RequestError when the point is
        not finite, or the direction is zero or not finite.
        """
        return self.base.chord(point, direction)

    def is_motion_valid(self, start: ArrayLike, end: ArrayLike) -> bool:
        """Return whether every point of the closed segment from ``start`` to ``end`` is free."""
        return self.base.is_motion_valid(start, end)

    def first_blocked_segment(self, path: ArrayLike) -> int | None:
        """
        Return the index of the first segment of a path (m, dim) that is not free, or None.

        Segment k leads from point k to point k + 1. The path is in the caller's frame.
        """
        return self.base.first_blocked_segment(path)

    def is_path_free(self, path: Floats) -> bool:
        """Return whether all segments of a finite path (m, dim), caller's frame, are free."""
        return self.base.is_path_free(path)

    def why_not_free(self, point: ArrayLike) -> str:
        """Return the reason why ``point`` (dim,) is not free."""
        return self.base.why_not_free(point)


@kernel
def _moved_points(columns, origin, points):
    """
    Return ``origin + matrix y`` for points y (n, k) and the columns (k, k) of the matrix.

    The order of operations is that of a transformed space. So a point of a chain, of which the
    transformed space said that it is free, is mapped to the very numbers that were tested.
    """
    moved = np.empty(points.shape)
    for n in range(len(points)):
        multiply(columns, points[n], moved[n])
        for i in range(len(origin)):
            moved[n, i] += origin[i]
    return moved
