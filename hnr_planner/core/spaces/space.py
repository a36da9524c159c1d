"""
What a space is: an open, bounded set of free points that answers for points and for chords.

Everything else is built on these answers. A Hit-and-Run step draws on a chord; a motion is free
when the chord reaches beyond its end. The rules at the boundary are the same for every space:

- obstacles are closed, free space is open: a point that touches an obstacle is not free;
- ``lower < 0 < upper`` exactly when the point is free, otherwise the chord is ``Chord(0, 0)``;
- what has to stop at a chord's end stops ``margin`` before it.
"""

from abc import ABC, abstractmethod
from typing import Any, NamedTuple

from hnr_planner.core.checks import check_direction, check_point, check_points, Floats
from hnr_planner.core.spaces.primitives import (
    are_free,
    chord,
    first_blocked_segment,
    segment_is_free,
)
import numpy as np
from numpy.typing import ArrayLike

#: How far before the end of a chord one stops, as a fraction of the bounds' diagonal.
MARGIN = 1e-9


class Chord(NamedTuple):
    """Largest free interval of the line ``point + t direction`` around ``t = 0``."""

    lower: float
    upper: float


class Space(ABC):
    """
    An open, bounded set of free points in R^dim.

    A space keeps what its kernels need in ``data``, in the *kernel frame*: the caller's, unless a
    space says otherwise, then a rigid motion and a scaling away. Searches run there; points cross
    over at the door, by ``to_kernel`` and ``from_kernel``.

    Attributes
    ----------
    dim : int
        Dimension of the points.
    data : NamedTuple
        The compiled space: arrays, in the kernel frame.

    """

    dim: int
    data: Any

    @property
    @abstractmethod
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,) of a box around the free points, caller's frame."""

    @property
    def part(self) -> Any:
        """The compiled space in the caller's frame: what composed spaces are made of."""
        return self.data

    def covers_box(self, lower: Floats, upper: Floats) -> bool:
        """Say whether the closure is known to hold all of the box between two corners (dim,)."""
        return False

    @property
    def scale(self) -> float:
        """Caller's units [m] in one unit of the kernel frame."""
        return 1.0

    @property
    def kernel_bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,) of a box around the free points, kernel frame."""
        return self.bounds

    @property
    def margin(self) -> float:
        """Distance from a chord's end at which one stops, kernel frame."""
        lower, upper = self.kernel_bounds
        return MARGIN * float(np.linalg.norm(upper - lower))

    @property
    def typical_clearance(self) -> float:
        """
        Distance from a free point to the boundary, roughly and on average, kernel frame.

        Unless a space knows better, that of a cube with the shortest side of the bounds.
        """
        lower, upper = self.kernel_bounds
        return float((upper - lower).min()) / (2.0 * (self.dim + 1))

    @property
    def walls(self) -> Any:
        """What kernels measure the distance to walls in; None for a space without clearance."""
        return None

    @property
    def island_points(self) -> Floats | None:
        """A point (k, dim) in each obstacle that a path can go round; None where unknown."""
        return None

    def to_kernel(self, points: Floats) -> Floats:
        """Bring points (..., dim) of the caller's frame into the kernel frame, in a new array."""
        return np.array(points, order='C')

    def from_kernel(self, points: Floats) -> Floats:
        """Bring points (..., dim) of the kernel frame into the caller's frame; likewise."""
        return np.array(points, order='C')

    def turn_to_kernel(self, directions: Floats) -> Floats:
        """Turn directions (..., dim) into the kernel frame, without scaling them; likewise."""
        return np.array(directions, order='C')

    def why_not_free(self, point: ArrayLike) -> str:
        """Say in words why ``point`` (dim,) is not free."""
        return 'not in the space'

    def region_reachable(self, start: ArrayLike, goal: ArrayLike, radius: float) -> bool:
        """Say whether a path leads into the ball around ``goal``; True where that is not known."""
        return True

    def rough_path(self, start: Floats, goal: Floats) -> Floats | None:
        """
        Return a free path (m, dim) that takes a short way round obstacles, kernel frame.

        It may wander on the way. None where the space knows none.
        """
        return None

    def contains(self, points: ArrayLike) -> Any:
        """
        Say which points are free.

        Parameters
        ----------
        points : (k, dim) or (dim,)
            Points in the caller's frame.

        Returns
        -------
        (k,) bool or bool

        """
        points = check_points('points', points, self.dim)
        free = are_free(self.data, self.to_kernel(np.atleast_2d(points)))
        return bool(free[0]) if points.ndim == 1 else free

    def chord(self, point: ArrayLike, direction: ArrayLike) -> Chord:
        """
        Return the chord through a point: the oracle of the paper (Assumption 1).

        Parameters
        ----------
        point, direction : (dim,)
            Caller's frame. The ends count in units of ``|direction|``.

        Raises
        ------
        RequestError
            When the point is not finite, or the direction is zero or not finite.

        """
        point = check_point('point', point, self.dim)
        direction = check_direction('direction', direction, self.dim)
        # A power of two brings the direction near length 1 without changing one bit of it.
        _, exponent = np.frexp(np.abs(direction).max())
        near_unit = self.turn_to_kernel(np.ldexp(direction, -exponent))
        lower, upper = chord(self.data, self.to_kernel(point), near_unit)
        return Chord(*(float(np.ldexp(s * self.scale, -exponent)) for s in (lower, upper)))

    def is_motion_valid(self, start: ArrayLike, end: ArrayLike) -> bool:
        """Say whether every point of the closed segment from ``start`` to ``end`` is free."""
        a = self.to_kernel(check_point('start', start, self.dim))
        b = self.to_kernel(check_point('end', end, self.dim))
        return bool(segment_is_free(self.data, a, b))

    def first_blocked_segment(self, path: ArrayLike) -> int | None:
        """Return the index of the first segment of a path (m, dim) that is not free, if any."""
        points = self.to_kernel(check_points('path', path, self.dim))
        k = first_blocked_segment(self.data, points)
        return None if k < 0 else int(k)

    def is_path_free(self, path: Floats) -> bool:
        """Say whether every segment of a path (m, dim) of finite numbers is free."""
        return bool(first_blocked_segment(self.data, self.to_kernel(path)) < 0)
