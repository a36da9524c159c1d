"""
Compiled spaces that call functions of the user: chords by search, or from a function.

A space without a chord function is searched along lines (module ``search``), in steps of
``resolution``.
"""

from collections.abc import Callable
import math
from typing import Any, NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.lengths import norm
from hnr_planner.core.spaces.bounds import box_span
from hnr_planner.core.spaces.callbacks import address, ask, callback, OracleError
from hnr_planner.core.spaces.primitives import (
    contains,
    exit_beyond,
    first_blocked,
    first_entry,
    first_exit,
    is_visible,
    segment_is_free,
    touches,
)
from hnr_planner.core.spaces.search import entry_by_search, exit_by_search, is_in, work_size
import numpy as np

#: Of the points of a ray, one of so many is tested by ``exit_beyond``: of several rays the longest
#: is found by few tests, and the others need no more (1 to 16 were tried on an arm).
COARSE = 16


class OracleData(NamedTuple):
    """
    A compiled space that calls functions of the user by address.

    Attributes
    ----------
    lower, upper : (dim,)
        Bounds, kernel frame: no point outside is free, and membership is not asked there.
    origin : (dim,)
        Origin of the kernel frame in the frame of the functions.
    resolution : float
        Distance between two consecutive points of a line that are tested.
    closeness : float
        Distance within which the end of a chord is located.
    membership : int
        Address of the function of a point that returns whether it is free.
    chord : int
        Address of the function of a point and a direction that returns the parameter at which the
        ray from that point leaves the space; 0 if there is no such function.
    motion : int
        Address of the function of two points that returns whether the segment between them is
        free; 0 if there is no such function.

    """

    lower: Floats
    upper: Floats
    origin: Floats
    resolution: float
    closeness: float
    membership: int
    chord: int
    motion: int

    @property
    def tests_points(self) -> bool:
        """Whether membership is all that there is, so that lines are searched by tests."""
        return self.chord == 0 and self.motion == 0


class OracleFunctions:
    """
    Functions that kernels call by address; keep this object for as long as its ``data`` is used.

    Parameters
    ----------
    lower, upper : (dim,)
        Bounds, in the frame of the functions.
    resolution, closeness : float
        As in ``OracleData``.
    contains : callable
        Function of a point (dim,) that returns whether it is free. Each of the three functions may
        be compiled by numba or not.
    chord : callable or None
        Function of a point (dim,) and a direction (dim,) that returns the parameter at which the
        ray leaves the space.
    is_motion_valid : callable or None
        Function of two points (dim,) that returns whether the segment between them is free.

    Attributes
    ----------
    data : OracleData
        The compiled space, in the frame of the functions.

    """

    def __init__(
        self,
        lower: Floats,
        upper: Floats,
        resolution: float,
        closeness: float,
        *,
        contains: Callable[[Floats], Any],
        chord: Callable[[Floats, Floats], Any] | None = None,
        is_motion_valid: Callable[[Floats, Floats], Any] | None = None,
    ) -> None:
        self._called_back = (
            callback(contains, 1),
            callback(chord, 2) if chord else None,
            callback(is_motion_valid, 2) if is_motion_valid else None,
        )
        addresses = (address(each) if each else 0 for each in self._called_back)
        origin = np.zeros(len(lower))
        self.data = OracleData(lower, upper, origin, resolution, closeness, *addresses)


@contains.register(OracleData)
@touches.register(OracleData)
@kernel
def _contains(oracle, x):
    """Return whether the function returns that ``x`` is free, also on the boundary."""
    return _is_in(oracle, x, x, 0.0, np.empty(len(x) + 1))


@first_exit.register(OracleData)
@kernel
def _first_exit(oracle, x, u, t, horizon):
    """Return the first exit from ``t`` on: from the chord function, or else by search."""
    work = np.empty(len(x) + 1)
    if not _is_in(oracle, x, u, t, work):
        return t
    _, last = box_span(oracle.lower, oracle.upper, x, u)
    if oracle.chord != 0:
        return min(t + _ask_chord(oracle, x, u, t), last)
    length = norm(u)
    step, closeness = oracle.resolution / length, oracle.closeness / length
    return exit_by_search(oracle, x, u, t, horizon, last, step, closeness)


@first_entry.register(OracleData)
@kernel
def _first_entry(oracle, x, u, t):
    """Return the first parameter from ``t`` on at which a search finds a free point, or inf."""
    work = np.empty(len(x) + 1)
    if _is_in(oracle, x, u, t, work):
        return t
    first, last = box_span(oracle.lower, oracle.upper, x, u)
    length = norm(u)
    step, closeness = oracle.resolution / length, oracle.closeness / length
    return entry_by_search(oracle, x, u, max(t, first), last, step, closeness)


@segment_is_free.register(OracleData)
@kernel
def _segment_is_free(oracle, a, b):
    """
    Return whether the segment from ``a`` to ``b`` is free.

    The function of two points is called if there is one, or that of chords; otherwise both ends
    and all points tested between them have to be free.
    """
    if oracle.motion != 0:
        return _ask_motion(oracle, a, b)
    return _contains(oracle, b) and _contains(oracle, a) and _is_free_between(oracle, a, b)


@is_visible.register(OracleData)
@kernel
def _is_visible(oracle, a, b):
    """Return whether the segment between two free points is free: the points are not tested."""
    if oracle.motion != 0:
        return _ask_motion(oracle, a, b)
    return _is_free_between(oracle, a, b)


@kernel
def _is_free_between(oracle, a, b):
    """Return whether a chord from ``a`` reaches beyond ``b``, or all points tested are free."""
    if oracle.chord != 0:
        u = b - a
        return not u.any() or _first_exit(oracle, a, u, 0.0, 1.0) > 1.0
    return _first_blocked_between(oracle, a, b) == math.inf


@exit_beyond.register(OracleData)
@kernel
def _exit_beyond(oracle, x, u, t):
    """
    Return about where the ray leaves the space if that is beyond ``t``; else a value up to ``t``.

    A search without a chord function tests one of ``COARSE`` points, and takes the ray for free up
    to the middle between the last free one and the next.
    """
    if oracle.chord != 0:
        return _first_exit(oracle, x, u, 0.0, math.inf)
    work = np.empty(len(x) + 1)
    if not _is_in(oracle, x, u, t, work) or _first_found(oracle, x, u, t, COARSE) < t:
        return 0.0
    _, last = box_span(oracle.lower, oracle.upper, x, u)
    stride, free = COARSE * oracle.resolution / norm(u), t
    while free + stride < last and _is_in(oracle, x, u, free + stride, work):
        free += stride
    return (free + min(free + stride, last)) / 2.0


@first_blocked.register(OracleData)
@kernel
def _first_blocked(oracle, x, y):
    """Return the fraction of the segment at which a tested point is not free, or inf."""
    return math.inf if oracle.chord != 0 else _first_blocked_between(oracle, x, y)


@kernel
def _first_blocked_between(oracle, a, b):
    """
    Return the fraction of the segment from ``a`` to ``b`` at which a test fails; inf if nowhere.

    Points are tested from the end that comes first in the order of their coordinates: the same
    in both directions.
    """
    for i in range(len(a)):
        if a[i] < b[i]:
            return _first_found(oracle, a, b - a, 1.0, 1)
        if a[i] > b[i]:
            found = _first_found(oracle, b, a - b, 1.0, 1)
            return 1.0 - found if found < math.inf else math.inf
    return math.inf


@kernel
def _first_found(oracle, x, u, end, finest):
    """
    Return the parameter of the first blocked point found on the line up to ``end``; inf if none.

    Tested are the multiples of ``finest`` steps, a power of 2, from coarse to fine: a blocked
    stretch is found by fewer tests than in order.
    """
    work, step = np.empty(len(x) + 1), oracle.resolution / norm(u)
    last = int(end / step)
    stride = finest
    while 2 * stride <= last:
        stride *= 2
    while stride >= finest:
        for k in range(stride, last + 1, 2 * stride):
            if not _is_in(oracle, x, u, k * step, work):
                return k * step
        stride //= 2
    return math.inf


@work_size.register(OracleData)
@inlined
def _work_size(oracle, dim):
    """Return the length of the work array: for a point, and for the result of the function."""
    return dim + 1


@is_in.register(OracleData)
@kernel
def _is_in(oracle, x, u, s, work):
    """
    Return whether ``x + s u`` lies within the bounds and is free.

    ``work`` (dim + 1,) is a work array for the point and the result.
    """
    n = len(x)
    for i in range(n):
        work[i] = x[i] + s * u[i] if s != 0.0 else x[i]
        if not oracle.lower[i] < work[i] < oracle.upper[i]:
            return False
        work[i] += oracle.origin[i]
    point, answer = work[:n], work[n:]
    if ask(oracle.membership, point, answer) != 0:
        raise OracleError
    return answer[0] != 0.0


@kernel
def _ask_motion(oracle, a, b):
    """Return the answer of the function of two points (dim,): whether the segment is free."""
    n = len(a)
    ends, answer = np.empty(2 * n), np.empty(1)
    for i in range(n):
        ends[i], ends[n + i] = a[i] + oracle.origin[i], b[i] + oracle.origin[i]
    if ask(oracle.motion, ends, answer) != 0:
        raise OracleError
    return answer[0] != 0.0


@kernel
def _ask_chord(oracle, x, u, t):
    """Return the free length of the ray from ``x + t u`` along ``u``, in units of ``|u|``."""
    n = len(x)
    line, answer = np.empty(2 * n), np.empty(1)
    for i in range(n):
        line[i], line[n + i] = x[i] + t * u[i] + oracle.origin[i], u[i]
    if ask(oracle.chord, line, answer) != 0:
        raise OracleError
    return answer[0] if answer[0] > 0.0 else 0.0
