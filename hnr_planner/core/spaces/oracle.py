"""A space that is known by a user's function only."""

from collections.abc import Callable
import math
from typing import Any, NamedTuple

from hnr_planner.core.checks import check_real, check_vector, Floats
from hnr_planner.core.errors import SpaceError
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.lengths import norm
from hnr_planner.core.spaces.bounds import check_bounds, within
from hnr_planner.core.spaces.callbacks import address, ask, callback, OracleError
from hnr_planner.core.spaces.primitives import contains, first_entry, first_exit, touches
from hnr_planner.core.spaces.space import MARGIN, Space
from numba import njit
from numba.core.dispatcher import Dispatcher
import numpy as np
from numpy.typing import ArrayLike

#: An end of a chord is closed in on to this part of the margin.
CLOSENESS = 1e-3


class OracleData(NamedTuple):
    """
    A compiled space that asks a function.

    Attributes
    ----------
    lower, upper : (dim,)
        Bounds: what lies outside is not asked for.
    resolution : float
        Distance between two points of a line that are asked for.
    closeness : float
        How near the end of a chord is found.
    membership : int
        Address of the function that says whether a point is free.
    chord : int
        Address of the function that says how far a line is free; 0 for none.

    """

    lower: Floats
    upper: Floats
    resolution: float
    closeness: float
    membership: int
    chord: int


class OracleSpace(Space):
    """
    The points of a box that a function says are free.

    Lines are searched: a point is asked for at every ``resolution`` of the way, and where the
    answer changes the place is closed in on. So a gap or a wall that is thinner than the
    resolution along a line may be missed, and a path may lead through it. Whether the boundary is
    free is what the function says.

    A function compiled by ``numba.njit`` is called as fast as any compiled code. One in Python
    costs some microseconds for each point; it is called from many threads, one at a time, and what
    it raises comes out as the cause of an ``OracleError``.

    Parameters
    ----------
    contains : callable
        Says of a point (dim,), which it must not change, whether it is free.
    lower, upper : (dim,)
        Corners of a box: nothing outside is free.
    resolution : float
        Distance between two points of a line that are asked for, above 0.

    Raises
    ------
    SpaceError
        When the numbers are not those of a box, or the function gives no truth value.

    Attributes
    ----------
    resolution : float

    """

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
        Build the space whose chords a function knows.

        Parameters
        ----------
        chord : callable
            From a point (dim,) and a direction (dim,) to the parameter above 0, in units of the
            direction, where the ray leaves the space; 0 where the point is not free.
        lower, upper : (dim,)
            Corners of a box: nothing outside is free.
        resolution : float
            Walks and planners do not search. This is the distance between points that are asked
            for where a line comes in from outside: in a space that is taken away from another.

        """
        space = cls.__new__(cls)
        space._build(_is_free(chord), chord, lower, upper, resolution)
        return space

    def _build(
        self,
        contains: Callable[[Floats], Any],
        chord: Callable[[Floats, Floats], float] | None,
        lower: ArrayLike,
        upper: ArrayLike,
        resolution: float,
    ) -> None:
        begin, end = (
            check_vector(name, corner, SpaceError)
            for name, corner in (('lower', lower), ('upper', upper))
        )
        if begin.shape != end.shape:
            raise SpaceError(
                f'lower and upper must be of one dimension, got {len(begin)} and {len(end)}'
            )
        check_bounds('the box', begin, end)
        self.dim = len(begin)
        self.resolution = check_real('resolution', resolution, SpaceError)
        closeness = CLOSENESS * MARGIN * float(np.linalg.norm(end - begin))
        if not closeness < self.resolution < math.inf:
            raise SpaceError(
                f'resolution must be above {closeness:g} and finite, got {self.resolution!r}'
            )
        _try_out(contains, (begin + end) / 2.0)
        #: What compiled code calls must not be collected.
        self._called_back = callback(contains, 1), callback(chord, 2) if chord else None
        self.data = OracleData(
            begin,
            end,
            self.resolution,
            closeness,
            address(self._called_back[0]),
            address(self._called_back[1]) if chord else 0,
        )

    def __repr__(self) -> str:
        """Name the resolution: it is what the answers are good to."""
        return f'OracleSpace(dim={self.dim}, resolution={self.resolution:g})'

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,)."""
        return self.data.lower.copy(), self.data.upper.copy()

    def why_not_free(self, point: ArrayLike) -> str:
        """Say in words why ``point`` (dim,) is not free."""
        return 'outside the bounds, or the function says that it is not free'


def _try_out(contains: Any, point: Floats) -> None:
    """Refuse what is no function, or gives no truth value."""
    if not callable(contains):
        raise SpaceError(f'contains must be a function, got {contains!r}')
    answer = contains(point)
    if not isinstance(answer, bool | np.bool_):
        raise SpaceError(f'contains must return True or False, got {answer!r}')


def _is_free(chord: Any) -> Callable[[Floats], bool]:
    """Return the function that tells a free point by its chord along the first axis."""
    if not callable(chord):
        raise SpaceError(f'chord must be a function, got {chord!r}')

    def contains(point):
        direction = np.zeros(len(point))
        direction[0] = 1.0
        return chord(point, direction) > 0.0

    return njit(nogil=True)(contains) if isinstance(chord, Dispatcher) else contains


@contains.register(OracleData)
@touches.register(OracleData)
@kernel
def _contains(oracle, x):
    return _is_in(oracle, x, x, 0.0, np.empty(len(x) + 1))


@first_exit.register(OracleData)
@kernel
def _first_exit(oracle, x, u, t, enough):
    room = np.empty(len(x) + 1)
    if not _is_in(oracle, x, u, t, room):
        return t
    _, last = within(oracle.lower, oracle.upper, x, u)
    if oracle.chord != 0:
        return min(t + _reach(oracle, x, u, t), last)
    step, before = oracle.resolution / norm(u), t
    while before <= enough:
        s = min(before + step, last)
        if s == last or not _is_in(oracle, x, u, s, room):
            return _closed_in(oracle, x, u, before, s, room)
        before = s
    return before


@first_entry.register(OracleData)
@kernel
def _first_entry(oracle, x, u, t):
    room = np.empty(len(x) + 1)
    if _is_in(oracle, x, u, t, room):
        return t
    first, last = within(oracle.lower, oracle.upper, x, u)
    step, before = oracle.resolution / norm(u), max(t, first)
    while before < last:
        s = min(before + step, last)
        if _is_in(oracle, x, u, s, room):
            return _closed_in(oracle, x, u, before, s, room)
        before = s
    return math.inf


@kernel
def _closed_in(oracle, x, u, before, after, room):
    """Return the far end of a short way on which being in begins or ends."""
    was_in, closeness = _is_in(oracle, x, u, before, room), oracle.closeness / norm(u)
    while after - before > closeness:
        middle = before + (after - before) / 2.0
        if not before < middle < after:
            break
        if _is_in(oracle, x, u, middle, room) == was_in:
            before = middle
        else:
            after = middle
    return after


@kernel
def _is_in(oracle, x, u, s, room):
    """Say whether ``x + s u`` lies within the bounds and is free; ``room`` (dim + 1,) is used."""
    n = len(x)
    for i in range(n):
        room[i] = x[i] + s * u[i] if s != 0.0 else x[i]
        if not oracle.lower[i] < room[i] < oracle.upper[i]:
            return False
    point, answer = room[:n], room[n:]
    if ask(oracle.membership, point, answer) != 0:
        raise OracleError
    return answer[0] != 0.0


@kernel
def _reach(oracle, x, u, t):
    """Ask how far the ray from ``x + t u`` is free."""
    n = len(x)
    line, answer = np.empty(2 * n), np.empty(1)
    for i in range(n):
        line[i], line[n + i] = x[i] + t * u[i], u[i]
    if ask(oracle.chord, line, answer) != 0:
        raise OracleError
    return answer[0] if answer[0] > 0.0 else 0.0
