"""
Reeds-Shepp and Dubins words: shortest paths of a car from the pose (0, 0, 0), radius 1.

A word is up to five pieces, each a left arc, a right arc or a straight line, with a signed length:
below 0 the car drives backwards. Eight formulas and three symmetries give all 48 words (Reeds and
Shepp, "Optimal paths for a car that goes both forwards and backwards", 1990, formulas 8.1 to
8.11); without reverse, the first three formulas with all arcs turned forwards give the words of
Dubins ("On curves of minimal length with a constraint on average curvature", 1957).
"""

import math
from typing import NamedTuple

from hnr_planner.core.kernels.kernel import kernel

#: Number of formulas, and of those that give Dubins' words.
N_FORMULAS, N_DUBINS = 8, 3
#: Symmetries of a formula: lengths negated (driven the other way round), left and right swapped,
#: and the order of the pieces turned round.
N_SYMMETRIES = 8
#: Angle [rad] by which a length may be below 0, by rounding, and counts as 0.
ROUNDING = 1e-12


class WordPrices(NamedTuple):
    """
    What a unit of length costs ahead and backwards, and what each change between them does.

    Attributes
    ----------
    ahead, back, change : float
        Prices; radius 1.

    """

    ahead: float
    back: float
    change: float


@kernel
def least_cost(formula, forwards, prices, x, y, yaw):
    """
    Return a cost that no word of a formula to (x, y, yaw) is below, whatever its symmetry.

    No word is shorter than the straight way, or turns by less than ``yaw``. All but the first two
    formulas change direction, unless ``forwards``: a word of theirs in which a piece has the
    length 0, and which does not, is a word of those two as well.
    """
    least = min(prices.ahead, prices.back) * max(math.hypot(x, y), abs(yaw))
    return least if forwards or formula < 2 else least + prices.change


@kernel
def word(formula, symmetry, forwards, x, y, yaw, cos, sin, prices, limit, lengths, bends):
    """
    Write one word from (0, 0, 0) to (x, y, yaw), radius 1; return its number of pieces.

    The number is 0 where the word does not exist, or is seen to cost more than ``limit`` before
    all of it is known. ``cos`` and ``sin`` are those of ``yaw`` in [-pi, pi). ``lengths`` (5,) are
    the signed lengths of the pieces, and ``bends`` (5,) their curvatures: 1 to the left, -1 to the
    right, 0 straight. With ``forwards`` no length is below 0.
    """
    is_negated, is_mirrored, is_turned = symmetry & 1, symmetry & 2, symmetry & 4
    ahead, back = prices.ahead, prices.back
    if is_turned:
        # The goal seen backwards: the same pieces in the opposite order lead there.
        x, y = x * cos + y * sin, x * sin - y * cos
    if is_negated:
        x, yaw, sin = -x, -yaw, -sin
        ahead, back = back, ahead
    if is_mirrored:
        y, yaw, sin = -y, -yaw, -sin
    # A word that costs as much as the limit, but for rounding, is not left out.
    limit *= 1.0 + ROUNDING
    if formula > 1 and not forwards:
        limit -= prices.change
    n = _formula(formula, forwards, x, y, yaw, cos, sin, ahead, back, limit, lengths, bends)
    if n == 0:
        return 0
    if is_turned:
        for k in range(n // 2):
            lengths[k], lengths[n - 1 - k] = lengths[n - 1 - k], lengths[k]
            bends[k], bends[n - 1 - k] = bends[n - 1 - k], bends[k]
    for k in range(n):
        if is_negated:
            lengths[k] = -lengths[k]
        if is_mirrored:
            bends[k] = -bends[k]
    return n


@kernel
def _formula(formula, forwards, x, y, yaw, cos, sin, ahead, back, limit, lengths, bends):
    """Write the word of one formula as it stands; return its number of pieces, 0 for none."""
    # Vector between the centres of the first and the last circle, on one side or on both.
    same_x, same_y = x - sin, y - 1.0 + cos
    other_x, other_y = x + sin, y - 1.0 - cos
    same, other = math.hypot(same_x, same_y), math.hypot(other_x, other_y)
    first, last = 0.0, 0.0
    if formula == 0:  # left, straight, left
        if ahead * (same + abs(yaw)) > limit:
            return 0
        first = _angle(math.atan2(same_y, same_x), forwards)
        last = _angle(yaw - first, forwards)
        _put(lengths, bends, 0, first, 1.0)
        _put(lengths, bends, 1, same, 0.0)
        _put(lengths, bends, 2, last, 1.0)
        return 3 if first >= 0.0 and last >= 0.0 else 0
    if formula == 1:  # left, straight, right
        if other < 2.0:
            return 0
        straight = math.sqrt(other * other - 4.0)
        if ahead * (straight + abs(yaw)) > limit:
            return 0
        first = _angle(math.atan2(other_y, other_x) + math.atan2(2.0, straight), forwards)
        last = _angle(first - yaw, forwards)
        _put(lengths, bends, 0, first, 1.0)
        _put(lengths, bends, 1, straight, 0.0)
        _put(lengths, bends, 2, last, -1.0)
        return 3 if first >= 0.0 and last >= 0.0 else 0
    if formula == 2:  # left, right backwards, left
        if same > 4.0:
            return 0
        middle = -2.0 * math.asin(same / 4.0)
        if (ahead * (2.0 * math.pi + middle) if forwards else -back * middle) > limit:
            return 0
        first = _angle(math.atan2(same_y, same_x) + middle / 2.0 + math.pi, forwards)
        last = _angle(yaw - first + middle, forwards)
        if forwards:
            middle += 2.0 * math.pi
        _put(lengths, bends, 0, first, 1.0)
        _put(lengths, bends, 1, middle, -1.0)
        _put(lengths, bends, 2, last, 1.0)
        return 3 if first >= 0.0 else 0
    if formula == 3:  # left, right, left backwards, right backwards: equal arcs in the middle
        rho = (2.0 + other) / 4.0
        if rho > 1.0:
            return 0
        middle = math.acos(rho)
        if (ahead + back) * middle > limit:
            return 0
        first, last = _outer_arcs(middle, -middle, other_x, other_y, yaw)
        _put(lengths, bends, 0, first, 1.0)
        _put(lengths, bends, 1, middle, -1.0)
        _put(lengths, bends, 2, -middle, 1.0)
        _put(lengths, bends, 3, last, -1.0)
        return 4 if first >= 0.0 and last <= 0.0 else 0
    if formula == 4:  # left, right backwards, left backwards, right
        rho = (20.0 - other * other) / 16.0
        if not 0.0 <= rho <= 1.0:
            return 0
        middle = -math.acos(rho)
        if -2.0 * back * middle > limit:
            return 0
        first, last = _outer_arcs(middle, middle, other_x, other_y, yaw)
        _put(lengths, bends, 0, first, 1.0)
        _put(lengths, bends, 1, middle, -1.0)
        _put(lengths, bends, 2, middle, 1.0)
        _put(lengths, bends, 3, last, -1.0)
        return 4 if first >= 0.0 and last >= 0.0 else 0
    quarter = -math.pi / 2.0
    if formula == 5:  # left, right backwards by a quarter, straight and left backwards
        if same < 2.0:
            return 0
        root = math.sqrt(same * same - 4.0)
        if back * (root - 2.0 - quarter) > limit:
            return 0
        first = _angle(math.atan2(same_y, same_x) + math.atan2(root, -2.0), False)
        last = _angle(yaw + quarter - first, False)
        _put(lengths, bends, 0, first, 1.0)
        _put(lengths, bends, 1, quarter, -1.0)
        _put(lengths, bends, 2, 2.0 - root, 0.0)
        _put(lengths, bends, 3, last, 1.0)
        return 4 if first >= 0.0 and root >= 2.0 and last <= 0.0 else 0
    if formula == 6:  # left, right backwards by a quarter, straight and right backwards
        if other < 2.0:
            return 0
        if back * (other - 2.0 - quarter) > limit:
            return 0
        first = _angle(math.atan2(other_x, -other_y), False)
        last = _angle(first - quarter - yaw, False)
        _put(lengths, bends, 0, first, 1.0)
        _put(lengths, bends, 1, quarter, -1.0)
        _put(lengths, bends, 2, 2.0 - other, 0.0)
        _put(lengths, bends, 3, last, -1.0)
        return 4 if first >= 0.0 and last <= 0.0 else 0
    # Left, right backwards by a quarter, straight, left backwards by a quarter, right.
    if other < 2.0:
        return 0
    straight = 4.0 - math.sqrt(other * other - 4.0)
    if straight > 0.0 or -back * (straight + 2.0 * quarter) > limit:
        return 0
    first = _angle(
        math.atan2(
            (4.0 - straight) * other_x - 2.0 * other_y,
            -2.0 * other_x + (straight - 4.0) * other_y,
        ),
        False,
    )
    last = _angle(first - yaw, False)
    _put(lengths, bends, 0, first, 1.0)
    _put(lengths, bends, 1, quarter, -1.0)
    _put(lengths, bends, 2, straight, 0.0)
    _put(lengths, bends, 3, quarter, 1.0)
    _put(lengths, bends, 4, last, -1.0)
    return 5 if first >= 0.0 and last >= 0.0 else 0


@kernel
def _put(lengths, bends, k, length, bend):
    """Write piece ``k`` of a word."""
    lengths[k], bends[k] = length, bend


@kernel
def _angle(angle, forwards):
    """Return an angle in [-pi, pi), or with ``forwards`` in [0, 2 pi), up to whole turns."""
    turn = 2.0 * math.pi
    if forwards:
        angle -= turn * math.floor(angle / turn)
        return 0.0 if angle > turn - ROUNDING else angle
    angle -= turn * math.floor((angle + math.pi) / turn)
    return 0.0 if abs(angle) < ROUNDING else angle


@kernel
def _outer_arcs(second, third, x, y, yaw):
    """Return the first and the last arc of a word of four, given the two arcs between them."""
    turn = second - third
    a = math.sin(second) - math.sin(turn)
    b = math.cos(second) - math.cos(turn) - 1.0
    first = math.atan2(y * a - x * b, x * a + y * b)
    if 2.0 * (math.cos(turn) - math.cos(third) - math.cos(second)) + 3.0 < 0.0:
        first += math.pi
    first = _angle(first, False)
    return first, _angle(first - second + third - yaw, False)
