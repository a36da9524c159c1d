"""
Connections: the cheapest sequences of motions that a drive can make from one pose to another.

A connection is a list of up to five motions, each a twist that is held for one unit of time. A car
has the words of Reeds and Shepp, or those of Dubins where it must not drive backwards; a
differential drive turns, drives straight and turns again; an omnidirectional drive moves by one
twist, or turns before or after a straight line.

Obstacles play no role here: ``connection_is_free`` tests a connection afterwards.
"""

import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.planning.poses.reeds_shepp import (
    least_cost,
    N_DUBINS,
    N_FORMULAS,
    N_SYMMETRIES,
    word,
    WordPrices,
)
from hnr_planner.core.spaces.poses.data import first_contact_of
from hnr_planner.core.spaces.poses.drive import CAR, DIFFERENTIAL
from hnr_planner.core.spaces.poses.motion import moved, wrapped
from hnr_planner.core.spaces.poses.overlap import overlaps
import numpy as np
from numpy.typing import NDArray

#: Most motions of a connection, and number of connections that are kept, the cheapest first.
N_MOTIONS, N_KEPT = 5, 4
#: Length [cells] and angle [rad] below which a motion is left out.
TINY = 1e-9
#: Distance between the poses of a motion that are tested first, in strides.
PROBE = 1.0
GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0


class Prices(NamedTuple):
    """
    What a motion costs besides its length [cells].

    Attributes
    ----------
    reverse_penalty : float
        Factor on the length driven backwards.
    change : float
        Cost of each change between driving ahead and backwards [cells].
    turn : float
        Cost of turning in place, and the least of turning while moving [cells / rad].

    """

    reverse_penalty: float
    change: float
    turn: float


class Connections(NamedTuple):
    """
    The cheapest connections between two poses, in order of their costs.

    Attributes
    ----------
    twists : (N_KEPT + 1, N_MOTIONS, 3)
        Motions of each connection; the last row is a work array.
    sizes : (N_KEPT + 1,) int64
        Number of motions of each.
    costs : (N_KEPT + 1,)
        Cost of each [cells]; inf for none.
    lengths, bends : (N_MOTIONS,)
        Work arrays for a word.

    """

    twists: Floats
    sizes: NDArray[np.int64]
    costs: Floats
    lengths: Floats
    bends: Floats


def empty_connections() -> Connections:
    """Return the arrays for the connections between two poses."""
    return Connections(
        np.zeros((N_KEPT + 1, N_MOTIONS, 3)),
        np.zeros(N_KEPT + 1, dtype=np.int64),
        np.full(N_KEPT + 1, math.inf),
        np.zeros(N_MOTIONS),
        np.zeros(N_MOTIONS),
    )


@inlined
def motion_cost(prices, vx, vy, omega, driven):
    """
    Return the cost [cells] of a motion, changes of direction aside.

    It is the price of its length, or that of its turn where that is more: a turn does not become
    free by a move, however short. ``driven`` is -1 where the motion is driven the other way round,
    else 1.
    """
    factor = prices.reverse_penalty if vx * driven < 0.0 and vy == 0.0 else 1.0
    return max(factor * math.hypot(vx, vy), prices.turn * abs(omega))


@kernel
def cost_of(prices, twists, n, driven):
    """Return the cost [cells] of the first n motions of ``twists`` (n, 3), changes included."""
    cost, direction = 0.0, 0.0
    for k in range(n):
        vx, vy, omega = twists[k, 0], twists[k, 1], twists[k, 2]
        cost += motion_cost(prices, vx, vy, omega, driven)
        if vx != 0.0 and vy == 0.0:
            if vx * direction < 0.0:
                cost += prices.change
            direction = vx
    return cost


@kernel
def connect(space, prices, a, b, driven, found):
    """
    Write the cheapest connections from pose ``a`` to pose ``b`` (3,) to ``found``.

    With ``driven`` -1 the motions lead from ``a`` to ``b``, and the robot drives them the other
    way round, from ``b`` to ``a``: then costs, and what a drive without reverse can do, are those
    of the way back.
    """
    connect_below(space, prices, a, b, driven, math.inf, found)


@kernel
def connect_below(space, prices, a, b, driven, limit, found):
    """
    Write the cheapest connections from ``a`` to ``b`` to ``found``, as ``connect`` does.

    Those that cost ``limit`` [cells] or more may be missing: most are left out before all of their
    motions are known.
    """
    for k in range(N_KEPT + 1):
        found.costs[k] = math.inf
    cos, sin = math.cos(a[2]), math.sin(a[2])
    dx, dy, turn = b[0] - a[0], b[1] - a[1], wrapped(b[2] - a[2])
    x, y = cos * dx + sin * dy, cos * dy - sin * dx
    if space.drive == CAR:
        _connect_car(space, prices, x, y, turn, driven, limit, found)
    elif space.drive == DIFFERENTIAL:
        _connect_differential(space, prices, x, y, turn, driven, found)
        _connect_car(space, prices, x, y, turn, driven, limit, found)
    else:
        _connect_omnidirectional(prices, x, y, turn, found)


@inlined
def arc_curvature(space):
    """Return the curvature [1 / cells] of the arcs that connections are made of."""
    return space.max_curvature if space.drive == CAR else 1.0 / space.reach


@kernel
def _connect_car(space, prices, x, y, turn, driven, limit, found):
    """Keep the cheapest words from (0, 0, 0) to (x, y, turn) that cost less than ``limit``."""
    curvature = arc_curvature(space)
    forwards = not space.reverse
    # What is driven ahead on the way back is driven backwards on the way there: a car that is
    # turned round drives it ahead.
    side = driven if forwards else 1.0
    x, y = side * x * curvature, side * y * curvature
    cos, sin = math.cos(turn), math.sin(turn)
    ahead, back = 1.0, prices.reverse_penalty
    if driven < 0.0 and not forwards:
        ahead, back = back, ahead
    word_prices = WordPrices(ahead, back, prices.change * curvature)
    for formula in range(N_DUBINS if forwards else N_FORMULAS):
        least = least_cost(formula, forwards, word_prices, x, y, turn) / curvature
        for symmetry in range(N_SYMMETRIES):
            if forwards and (symmetry & 5) != 0:
                continue
            if symmetry >= 4 and formula != 2 and formula != 5 and formula != 6:
                continue  # the pieces turned round are a word of the same formula
            most = min(limit, found.costs[N_KEPT - 1])
            if least >= most:
                break
            n = word(
                formula,
                symmetry,
                forwards,
                x,
                y,
                turn,
                cos,
                sin,
                word_prices,
                most * curvature,
                found.lengths,
                found.bends,
            )
            size = 0
            for k in range(n):
                length, bend = found.lengths[k], found.bends[k]
                if abs(length) > TINY:
                    motion = found.twists[N_KEPT, size]
                    motion[0], motion[1] = side * length / curvature, 0.0
                    motion[2] = bend * length
                    size += 1
            if n > 0:
                _keep(prices, size, driven, found)


@kernel
def _connect_differential(space, prices, x, y, turn, driven, found):
    """Keep the cheapest ways to turn, drive straight and turn again."""
    distance = math.hypot(x, y)
    for variant in range(8):
        is_back, is_far, is_far_again = variant & 1, variant & 2, variant & 4
        if not space.reverse and (is_back == 1) != (driven < 0.0):
            continue
        first = wrapped(math.atan2(y, x) + (math.pi if is_back else 0.0))
        if distance <= TINY:
            first = 0.0
        last = wrapped(turn - first)
        if is_far:
            first -= math.copysign(2.0 * math.pi, first)
        if is_far_again:
            last -= math.copysign(2.0 * math.pi, last)
        size = _add(found, 0, 0.0, 0.0, first)
        size = _add(found, size, -distance if is_back else distance, 0.0, 0.0)
        _keep(prices, _add(found, size, 0.0, 0.0, last), driven, found)


@kernel
def _connect_omnidirectional(prices, x, y, turn, found):
    """Keep one twist, and straight lines with a turn before or after them."""
    half = turn / 2.0
    stretch = half / math.sin(half) if half != 0.0 else 1.0
    cos, sin = math.cos(half), math.sin(half)
    vx, vy = stretch * (cos * x + sin * y), stretch * (cos * y - sin * x)
    _keep(prices, _add(found, 0, vx, vy, turn), 1.0, found)
    for is_far in range(2):
        angle = turn - math.copysign(2.0 * math.pi, turn) if is_far else turn
        size = _add(found, 0, x, y, 0.0)
        _keep(prices, _add(found, size, 0.0, 0.0, angle), 1.0, found)
        cos, sin = math.cos(turn), math.sin(turn)
        size = _add(found, 0, 0.0, 0.0, angle)
        size = _add(found, size, cos * x + sin * y, cos * y - sin * x, 0.0)
        _keep(prices, size, 1.0, found)


@kernel
def _add(found, size, vx, vy, omega):
    """Add a motion to the connection in the work row, unless it is tiny; return the new size."""
    if math.hypot(vx, vy) <= TINY and abs(omega) <= TINY:
        return size
    motion = found.twists[N_KEPT, size]
    motion[0], motion[1], motion[2] = vx, vy, omega
    return size + 1


@kernel
def _keep(prices, size, driven, found):
    """Insert the connection in the work row, of ``size`` motions, in the order of costs."""
    twists, costs, sizes = found.twists, found.costs, found.sizes
    cost = cost_of(prices, twists[N_KEPT], size, driven)
    k = N_KEPT
    while k > 0 and cost < costs[k - 1]:
        k -= 1
    if k == N_KEPT:
        return
    for row in range(N_KEPT - 1, k, -1):
        costs[row], sizes[row] = costs[row - 1], sizes[row - 1]
        for m in range(sizes[row]):
            for i in range(3):
                twists[row, m, i] = twists[row - 1, m, i]
    costs[k], sizes[k] = cost, size
    for m in range(size):
        for i in range(3):
            twists[k, m, i] = twists[N_KEPT, m, i]


@kernel
def is_seen_blocked(space, a, twists, n):
    """
    Return whether the first n motions of ``twists`` from pose ``a`` (3,) pass a blocked pose.

    A few poses are tested, no more than ``PROBE`` strides apart: that costs far less than the
    exact test of the motions, and finds most of those that are blocked.
    """
    x, y, yaw = a[0], a[1], a[2]
    for k in range(n):
        vx, vy, omega = twists[k, 0], twists[k, 1], twists[k, 2]
        length = math.hypot(vx, vy) + abs(omega) * space.reach
        # Multiples of the golden ratio spread evenly from the first of them on.
        share = 1.0
        for _ in range(1 + math.floor(length / (PROBE * space.stride))):
            at_x, at_y, at_yaw = moved(x, y, yaw, vx, vy, omega, share)
            if overlaps(
                space.free_distance,
                space.pieces,
                space.piece_ends,
                space.circle,
                at_x,
                at_y,
                at_yaw,
            ):
                return True
            share = (share + GOLDEN) % 1.0
        x, y, yaw = moved(x, y, yaw, vx, vy, omega, 1.0)
    return False


@kernel
def connection_is_free(space, a, twists, n):
    """Return whether the first n motions of ``twists`` (n, 3) from pose ``a`` (3,) are free."""
    x, y, yaw = a[0], a[1], a[2]
    for k in range(n):
        vx, vy, omega = twists[k, 0], twists[k, 1], twists[k, 2]
        if not first_contact_of(space, x, y, yaw, vx, vy, omega, 1.0) > 1.0:
            return False
        x, y, yaw = moved(x, y, yaw, vx, vy, omega, 1.0)
    return True


@kernel
def first_blocked_motion(space, poses, twists):
    """Return the index of the first motion of a path that is not free; -1 for none."""
    for k in range(len(twists)):
        end = k + 1
        if not connection_is_free(space, poses[k], twists[k:end], 1):
            return k
    return -1
