"""
The base class of spaces: open, bounded sets of free points, with membership and chords.

Walks and planners are built on membership and chords. A Hit-and-Run step draws on a chord; a
motion is free when the chord reaches beyond its end. The rules at the boundary are the same for
every space:

- obstacles are closed, free space is open: a point that touches an obstacle is not free;
- a chord has ``lower < 0 < upper`` exactly when its point is free; else it is ``Chord(0, 0)``;
- a motion that has to stop at a chord's end stops ``margin`` before it.

The class is one contract, and so are its docstrings: hence the length of this module.
"""

from abc import ABC, abstractmethod
from functools import cached_property
import threading
from typing import Any, ClassVar, NamedTuple

from hnr_planner.core.checks import check_direction, check_point, check_points, Floats
from hnr_planner.core.errors import SpaceError
from hnr_planner.core.spaces.oracle_data import OracleFunctions
from hnr_planner.core.spaces.primitives import (
    are_free,
    chord_or_empty,
    CompiledSpace,
    first_blocked_segment,
    segment_is_free,
)
from hnr_planner.core.spaces.transformed import shifted, TransformedData
import numpy as np
from numpy.typing import ArrayLike, NDArray

#: Distance before a chord's end at which a motion stops, as a fraction of the bounds' diagonal.
MARGIN = 1e-9
#: Least distance before a chord's end, in roundings of the caller's coordinates.
MARGIN_ROUNDINGS = 8.0
#: Number of steps along the diagonal in which a line is searched for its entry into a Python
#: space.
ENTRY_STEPS = 1000
#: Error of a chord's end that is found by search, as a fraction of the margin.
CLOSENESS = 1e-3

_FUNCTIONS_LOCK = threading.Lock()


class Chord(NamedTuple):
    """
    Largest free interval (lower, upper) of ``point + t direction`` around ``t = 0``.

    The ends are parameters t. Both are 0 where the point is not free.
    """

    lower: float
    upper: float


class Space(ABC):
    """
    An open, bounded set of free points in R^dim.

    A space stores the data of its kernels in ``data``, in the *kernel frame*: the caller's frame,
    or one that differs from it by a rigid motion and a scaling (a grid counts in cells, a space
    far from the origin from its own middle). Searches run there; ``to_kernel`` and ``from_kernel``
    convert points at the boundary of the package.

    A subclass in plain Python sets ``dim`` and overrides ``bounds``, ``contains`` and ``chord``,
    and ``is_motion_valid`` if the chord from the start does not decide whether a motion is free.
    Kernels then call these methods, from many threads, but one at a time.

    Attributes
    ----------
    dim : int
        Dimension of the points.
    data : NamedTuple
        The compiled space: arrays, in the kernel frame.

    """

    dim: int

    #: Whether the line through ``x`` along ``u`` is ``x + s u``; false for orbits of twists.
    has_straight_lines: ClassVar[bool] = True

    #: Point (dim,) of the caller's frame that is the origin of the kernel frame; None for 0.
    _kernel_origin: Floats | None = None

    @property
    @abstractmethod
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,) of a box around the free points, caller's frame."""

    @cached_property
    def data(self) -> Any:
        """The compiled space of a subclass in plain Python, whose kernels call the methods."""
        # Kernels call by address: a second set of functions must not replace the first.
        with _FUNCTIONS_LOCK:
            return self._functions.data

    @cached_property
    def _functions(self) -> OracleFunctions:
        """The methods of a subclass in plain Python, as functions that kernels call by address."""
        kind = type(self)
        if kind.contains is Space.contains or kind.chord is Space.chord:
            raise SpaceError(
                f'a space in Python must define contains and chord, which {kind.__name__} does '
                f'not: OracleSpace makes a space of a function alone'
            )
        lower, upper = self.bounds
        diagonal = float(np.linalg.norm(upper - lower))
        return OracleFunctions(
            lower,
            upper,
            diagonal / ENTRY_STEPS,
            CLOSENESS * MARGIN * diagonal,
            contains=self.contains,
            chord=lambda x, u: self.chord(x, u)[1],
            is_motion_valid=(
                None if kind.is_motion_valid is Space.is_motion_valid else self.is_motion_valid
            ),
        )

    def __repr__(self) -> str:
        """Name the kind of space and its dimension."""
        return f'{type(self).__name__}(dim={self.dim})'

    def __getstate__(self) -> dict[str, Any]:
        """Leave out cached properties: they may hold addresses of functions in this process."""
        kind, state = type(self), self.__dict__.copy()
        assigned = {'data'} if kind.data is Space.data and '_functions' not in state else set()
        for name in self.__dict__.keys() - assigned:
            if isinstance(getattr(kind, name, None), cached_property):
                del state[name]
        return state

    def compiled_at(self, origin: Floats | None) -> CompiledSpace:
        """
        Return the compiled space, its coordinates along the caller's axes from ``origin``.

        ``origin`` (dim,) is a point of the caller's frame; None keeps the caller's own origin.
        """
        return shifted(self.data, self._kernel_origin, origin)

    def transformed(self, matrix: Floats, origin: Floats) -> CompiledSpace:
        """
        Return the compiled space in coordinates y with ``x = origin + matrix y``, x kernel frame.

        ``matrix`` (kernel_dim, kernel_dim) is invertible. The result may be smaller than the space
        by as much as the map rounds.
        """
        return TransformedData(self.data, np.ascontiguousarray(matrix), origin.copy())

    @property
    def compiled(self) -> CompiledSpace:
        """The compiled space in the caller's frame."""
        return self.compiled_at(None)

    def covers_box(self, lower: Floats, upper: Floats) -> bool:
        """
        Return whether the closure is known to contain the box between two corners (dim,).

        The corners are in the caller's frame. False also means that the answer is unknown, as it
        is by default: a space overrides this method if it can compute the answer.
        """
        return False

    @property
    def is_rigid(self) -> bool:
        """Whether lengths in the kernel frame, times ``scale``, are those of the caller's."""
        return True

    @property
    def kernel_dim(self) -> int:
        """Dimension of the kernel frame: ``dim``, unless equations hold for all points."""
        return self.dim

    @property
    def scale(self) -> float:
        """Caller's units [m] in one unit of the kernel frame."""
        return 1.0

    @cached_property
    def kernel_bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,) of a box around the free points, kernel frame."""
        if self._kernel_origin is None:
            return self.bounds
        lower, upper = self.bounds
        return lower - self._kernel_origin, upper - self._kernel_origin

    @cached_property
    def margin(self) -> float:
        """
        Distance before a chord's end at which a motion stops, kernel frame.

        A fraction ``MARGIN`` of the bounds' diagonal, and at least ``MARGIN_ROUNDINGS`` times
        the rounding of the caller's coordinates.
        """
        lower, upper = self.kernel_bounds
        fraction = MARGIN * float(np.linalg.norm(upper - lower))
        return max(fraction, MARGIN_ROUNDINGS * self._rounding)

    @property
    def _rounding(self) -> float:
        """
        Rounding of the caller's coordinates, kernel frame, where it matters beside the margin.

        It is 0 in a space near the origin, where a fraction of the diagonal is far above it, and
        else the spacing of floats at the largest coordinate of the bounds.
        """
        if self._kernel_origin is None:
            return 0.0
        return float(np.spacing(np.abs(self.bounds).max()))

    @property
    def zero_length(self) -> float:
        """Length up to which a chord counts as zero in the statistics of walks, kernel frame."""
        return self.margin

    @cached_property
    def typical_clearance(self) -> float:
        """
        Rough mean distance from a free point to the boundary, kernel frame.

        The default is the mean distance in a cube whose side is the shortest side of the bounds.
        """
        lower, upper = self.kernel_bounds
        return float((upper - lower).min()) / (2.0 * (self.dim + 1))

    @property
    def walls(self) -> NDArray[Any] | None:
        """
        Distance field (rows, cols) of a grid [cells], for clearances; None for other spaces.

        It holds the Chebyshev distance from each cell to the nearest occupied cell.
        """
        return None

    @property
    def island_points(self) -> Floats | None:
        """
        One point (k, dim) inside each obstacle that free space surrounds, kernel frame.

        None for a space that does not know its obstacles.
        """
        return None

    def to_kernel(self, points: Floats) -> Floats:
        """Convert points (..., dim) of the caller's frame to the kernel frame, in a new array."""
        if self._kernel_origin is None:
            return np.array(points, order='C')
        return np.ascontiguousarray(points - self._kernel_origin)

    def from_kernel(self, points: Floats) -> Floats:
        """Convert points (..., dim) of the kernel frame to the caller's frame, in a new array."""
        if self._kernel_origin is None:
            return np.array(points, order='C')
        return np.ascontiguousarray(points + self._kernel_origin)

    def turn_to_kernel(self, directions: Floats) -> Floats:
        """Rotate directions (..., dim) into the kernel frame, unscaled, in a new array."""
        return np.array(directions, order='C')

    def why_not_free(self, point: ArrayLike) -> str:
        """
        Return the reason why a ``point`` (dim,) that is not free is not, to follow the word 'is'.

        The result means nothing for a free point. The point is in the caller's frame.
        """
        return 'not in the space'

    def region_reachable(self, start: ArrayLike, goal: ArrayLike, radius: float) -> bool:
        """
        Return whether a path leads from ``start`` (dim,) to within ``radius`` of ``goal`` (dim,).

        True also means that the answer is unknown, as it is by default. Points and radius are in
        the caller's frame and units.
        """
        return True

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
        points = check_points('points', points, self.dim)
        free = are_free(self.data, self.to_kernel(np.atleast_2d(points)))
        return bool(free[0]) if points.ndim == 1 else free

    def chord(self, point: ArrayLike, direction: ArrayLike) -> Chord:
        """
        Return the chord through a point: the oracle of the paper (Assumption 1).

        Parameters
        ----------
        point, direction : (dim,)
            Caller's frame. The ends are parameters in units of ``|direction|``.

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
        lower, upper = chord_or_empty(self.data, self.to_kernel(point), near_unit)
        return Chord(*(float(np.ldexp(s * self.scale, -exponent)) for s in (lower, upper)))

    def is_motion_valid(self, start: ArrayLike, end: ArrayLike) -> bool:
        """Return whether every point of the closed segment from ``start`` to ``end`` is free."""
        a = self.to_kernel(check_point('start', start, self.dim))
        b = self.to_kernel(check_point('end', end, self.dim))
        return bool(segment_is_free(self.data, a, b))

    def first_blocked_segment(self, path: ArrayLike) -> int | None:
        """
        Return the index of the first segment of a path (m, dim) that is not free, or None.

        Segment k leads from point k to point k + 1. The path is in the caller's frame.
        """
        points = self.to_kernel(check_points('path', path, self.dim))
        k = first_blocked_segment(self.data, points)
        return None if k < 0 else int(k)

    def is_path_free(self, path: Floats) -> bool:
        """Return whether all segments of a finite path (m, dim), caller's frame, are free."""
        return bool(first_blocked_segment(self.data, self.to_kernel(path)) < 0)
