"""A space defined by a function of the user, which either tests points or returns chords."""

from collections.abc import Callable
import math
from typing import Any

from hnr_planner.core.checks import check_real, Floats
from hnr_planner.core.errors import SpaceError
from hnr_planner.core.spaces.bounds import check_corners, kernel_origin
from hnr_planner.core.spaces.oracle_data import OracleData, OracleFunctions
from hnr_planner.core.spaces.space import CLOSENESS, MARGIN, Space
from numba import njit
from numba.core.dispatcher import Dispatcher
import numpy as np
from numpy.typing import ArrayLike


class OracleSpace(Space):
    """
    The points of a box for which a function returns that they are free.

    Lines are searched: a point is tested at every ``resolution`` along the line, and a change of
    the result is located by bisection. So a gap or a wall that is thinner than the resolution
    along a line may be missed, and a path may lead through it. The function decides whether the
    boundary is free.

    A function compiled by ``numba.njit`` is called as fast as any compiled code. One in Python
    costs some microseconds for each point; it is called from many threads, one at a time, and an
    exception that it raises is the cause of an ``OracleError``. A space can be pickled when its
    function can.

    Parameters
    ----------
    contains : callable
        Function that returns True or False: whether a point (dim,) in the caller's frame, which it
        must not change, is free.
    lower, upper : (dim,)
        Corners of a box: nothing outside is free.
    resolution : float
        Distance between two consecutive points of a line that are tested, above 0.

    Raises
    ------
    SpaceError
        When the numbers are not those of a box, or the function returns no truth value.

    Attributes
    ----------
    resolution : float

    """

    data: OracleData

    def __init__(
        self,
        contains: Callable[[Floats], Any],
        lower: ArrayLike,
        upper: ArrayLike,
        *,
        resolution: float,
    ) -> None:
        self._build(contains, None, lower, upper, resolution)

    @classmethod
    def from_chord(
        cls,
        chord: Callable[[Floats, Floats], float],
        lower: ArrayLike,
        upper: ArrayLike,
        *,
        resolution: float,
    ) -> 'OracleSpace':
        """
        Build a space from a function that returns chords.

        Parameters
        ----------
        chord : callable
            Function of a point (dim,) and a direction (dim,) that returns the parameter above 0,
            in units of the length of the direction, at which the ray leaves the space; 0 where the
            point is not free.
        lower, upper : (dim,)
            Corners of a box: nothing outside is free.
        resolution : float
            Distance between points that are tested where a line enters from outside, which only
            happens when this space is removed from another. Chords need no search.

        """
        space = cls.__new__(cls)
        space._build(None, chord, lower, upper, resolution)
        return space

    def _build(
        self,
        contains: Callable[[Floats], Any] | None,
        chord: Callable[[Floats, Floats], float] | None,
        lower: ArrayLike,
        upper: ArrayLike,
        resolution: float,
    ) -> None:
        """Check the arguments and compile the space; either function may be None."""
        begin, end = check_corners(lower, upper)
        self.dim = len(begin)
        self.resolution = check_real('resolution', resolution, SpaceError)
        closeness = CLOSENESS * MARGIN * float(np.linalg.norm(end - begin))
        if not closeness < self.resolution < math.inf:
            raise SpaceError(
                f'resolution must be above {closeness:g} and finite, got {self.resolution!r}'
            )
        membership: Any = contains if chord is None else _membership(chord)
        _check_function(membership, begin + (end - begin) / 2.0)
        self._compiled = OracleFunctions(
            begin, end, self.resolution, closeness, contains=membership, chord=chord
        )
        self._arguments = contains, chord, begin, end, self.resolution
        self._kernel_origin = kernel_origin(begin, end)
        self.data = self.compiled_at(self._kernel_origin)

    def __getstate__(self) -> dict[str, Any]:
        """Keep the arguments only: compiled functions hold addresses of this process."""
        return {'arguments': self._arguments}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Build the space again from the pickled arguments."""
        self._build(*state['arguments'])

    def __repr__(self) -> str:
        """Name the dimension, and the resolution of the search."""
        return f'OracleSpace(dim={self.dim}, resolution={self.resolution:g})'

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,), caller's frame."""
        return self._compiled.data.lower.copy(), self._compiled.data.upper.copy()

    def compiled_at(self, origin: Floats | None) -> OracleData:
        """
        Return the compiled space, its coordinates along the caller's axes from ``origin``.

        ``origin`` (dim,) is a point of the caller's frame; None keeps the caller's own origin.
        """
        data = self._compiled.data
        if origin is None:
            return data
        return data._replace(
            lower=data.lower - origin, upper=data.upper - origin, origin=origin.copy()
        )

    def why_not_free(self, point: ArrayLike) -> str:
        """Return the reason why ``point`` (dim,) is not free."""
        return 'outside the bounds, or the function says that it is not free'


def _check_function(contains: Any, point: Floats) -> None:
    """Raise SpaceError for what is not callable, or returns no truth value for ``point``."""
    if not callable(contains):
        raise SpaceError(f'contains must be a function, got {contains!r}')
    answer = contains(point)
    if not isinstance(answer, bool | np.bool_):
        raise SpaceError(f'contains must return True or False, got {answer!r}')


def _membership(chord: Any) -> Callable[[Floats], bool]:
    """
    Return a function that tests whether the chord along the first axis is above 0 at a point.

    It is compiled by numba if ``chord`` is.
    """
    if not callable(chord):
        raise SpaceError(f'chord must be a function, got {chord!r}')

    def contains(point):
        direction = np.zeros(len(point))
        direction[0] = 1.0
        return chord(point, direction) > 0.0

    return njit(nogil=True)(contains) if isinstance(chord, Dispatcher) else contains
