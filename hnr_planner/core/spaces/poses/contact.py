"""
The first contact of a moving footprint with blocked cells, exactly and without small steps.

A footprint that moves along a constant twist first touches a cell in one of two ways:

1. a convex vertex of the footprint, one that does not trail behind the motion, enters a cell: the
   vertex moves along a line or an arc, whose first exit from the free cells is found cell by cell;
2. a corner of the blocked cells meets a side of the footprint that leads the motion. Only corners
   where one of four cells is blocked, or two that lie across, can do so: a straight wall is met by
   a vertex first. The area that a side sweeps is searched for corners row by row, in pieces of the
   motion that are skipped where no corner is near; for each corner the contact is the root of a
   quadratic equation.

Where a footprint is not convex, its outer boundary is all that counts, and no vertex at which it
is not convex touches first. All lengths are in cells, in the kernel frame of a grid.
"""

import math

from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.spaces.grid.curves import first_exit_of_arc
from hnr_planner.core.spaces.grid.traversal import traverse
from hnr_planner.core.spaces.poses.motion import carried
from hnr_planner.core.spaces.poses.overlap import with_span

#: Distance [cells] at which a corner counts as touching a side: above rounding, and below the
#: slack with which a single pose is tested, so that a motion from a free pose can begin.
CLOSE = 1e-10
#: Longest piece of a motion that is searched for corners at once: how far a point of the side
#: moves [cells], and how far the footprint turns [rad].
PIECE, PIECE_TURN = 8.0, 0.25
#: Least distance [cells] that is skipped where no corner is near.
LEAST_SKIP = 2.0
#: Deviation from a line within the map [cells] up to which an arc is followed as a line.
STRAIGHT = 1e-13
#: Speed towards the outside, as a fraction of the speed, up to which a side or vertex trails.
TRAILS = 1e-12


@kernel
def first_contact(
    free_distance, corner_distance, edges, circle, x, y, yaw, vx, vy, omega, horizon
):
    """
    Return the time of the first contact of a footprint that moves along a twist; inf for none.

    Parameters
    ----------
    free_distance : (rows, columns) uint8
        Chebyshev distance [cells] to the nearest blocked cell; 0 on the rim.
    corner_distance : (rows + 1, columns + 1) uint8
        Chebyshev distance from each grid point to the nearest corner of the blocked cells.
    edges : (n, 6)
        Sides of the footprint (``Footprint``).
    circle : (3,)
        Circle around the footprint (``Footprint``).
    x, y, yaw : float
        The pose at time 0, which has to be free.
    vx, vy, omega : float
        The twist, in the robot's frame.
    horizon : float
        Time up to which the motion is followed; at most one turn is followed.

    """
    rows, columns = free_distance.shape
    if abs(omega) * (rows + columns) * (rows + columns) <= STRAIGHT * math.hypot(vx, vy):
        omega = 0.0
    end = min(horizon, 2.0 * math.pi / abs(omega)) if omega != 0.0 else horizon
    cos, sin = math.cos(yaw), math.sin(yaw)
    begin = _free_time(free_distance, circle, x, y, cos, sin, vx, vy, omega, end)
    if begin >= end:
        return math.inf
    x, y, cos, sin = carried(x, y, cos, sin, vx, vy, omega, begin)
    latest, end = end, end - begin
    first, n = math.inf, len(edges)
    for k in range(n):
        if edges[k, 5] == 0.0:
            continue
        bx, by = edges[k, 0], edges[k, 1]
        wx, wy = vx - omega * by, vy + omega * bx
        speed = math.hypot(wx, wy)
        before = k - 1 if k > 0 else n - 1
        outwards = max(
            edges[k, 3] * wx - edges[k, 2] * wy, edges[before, 3] * wx - edges[before, 2] * wy
        )
        # On a line, a vertex that moves along its own side only follows the vertex before it.
        trails = TRAILS * speed if omega == 0.0 else -TRAILS * speed
        if speed == 0.0 or outwards <= trails:
            continue
        at_x, at_y = x + cos * bx - sin * by, y + sin * bx + cos * by
        dx, dy = cos * wx - sin * wy, sin * wx + cos * wy
        entry = _vertex_contact(free_distance, at_x, at_y, dx, dy, omega, speed, min(end, first))
        first = min(first, entry)
    for k in range(n):
        met = _edge_contact(
            corner_distance,
            edges[k, 0],
            edges[k, 1],
            edges[k, 2],
            edges[k, 3],
            edges[k, 4],
            x,
            y,
            cos,
            sin,
            vx,
            vy,
            omega,
            min(end, first),
        )
        first = min(first, met)
    return min(begin + first, latest) if first < math.inf else math.inf


@kernel
def _free_time(free_distance, circle, x, y, cos, sin, vx, vy, omega, end):
    """
    Return a time, up to ``end`` at least, before which the circle around a footprint is free.

    The circle's centre is followed in steps within the free squares around it.
    """
    wx, wy = vx - omega * circle[1], vy + omega * circle[0]
    speed = math.hypot(wx, wy)
    at_x = x + cos * circle[0] - sin * circle[1]
    at_y = y + sin * circle[0] + cos * circle[1]
    s = 0.0
    while s < end:
        here_x, here_y, _, _ = carried(at_x, at_y, cos, sin, wx, wy, omega, s)
        skip = free_distance[math.floor(here_y), math.floor(here_x)] - 1.0 - circle[2]
        if skip <= LEAST_SKIP:
            return s
        s += skip / speed
    return s


@kernel
def _vertex_contact(free_distance, x, y, dx, dy, omega, speed, end):
    """
    Return the time up to ``end`` at which a vertex at (x, y) enters a blocked cell; inf for none.

    (dx, dy) is the vertex's velocity in the kernel frame, and ``speed`` the length of that.
    """
    if omega == 0.0:
        entry = traverse(free_distance, x, y, dx, dy, 0.0, end)
        return entry if entry <= end else math.inf
    dx, dy, curvature = dx / speed, dy / speed, omega / speed
    return first_exit_of_arc(free_distance, x, y, dx, dy, curvature, end * speed) / speed


@kernel
def _edge_contact(corner_distance, ax, ay, tx, ty, length, x, y, cos, sin, vx, vy, omega, end):
    """
    Return the time up to ``end`` at which a corner meets a side of the footprint; inf for none.

    The side begins at (ax, ay) in the robot's frame and has the unit direction (tx, ty).
    """
    # The speed at which a point of the side moves outwards falls by omega for each unit along it.
    wx, wy = vx - omega * ay, vy + omega * ax
    outwards = ty * wx - tx * wy
    begin, rest = 0.0, length
    if omega > 0.0:
        rest = min(rest, outwards / omega)
    elif omega < 0.0:
        begin = max(begin, outwards / omega)
    wx_end, wy_end = wx - omega * length * ty, wy + omega * length * tx
    speed = max(math.hypot(wx, wy), math.hypot(wx_end, wy_end))
    if rest <= begin or max(outwards, outwards - omega * length) <= TRAILS * speed:
        return math.inf
    first_x, first_y = ax + begin * tx, ay + begin * ty
    last_x, last_y = ax + rest * tx, ay + rest * ty
    half = (rest - begin) / 2.0
    longest = PIECE / speed
    if omega != 0.0:
        longest = min(longest, PIECE_TURN / abs(omega))
    rows, columns = corner_distance.shape
    s, x0, y0, cos0, sin0 = 0.0, x, y, cos, sin
    while s < end:
        p0x, p0y = x0 + cos0 * first_x - sin0 * first_y, y0 + sin0 * first_x + cos0 * first_y
        q0x, q0y = x0 + cos0 * last_x - sin0 * last_y, y0 + sin0 * last_x + cos0 * last_y
        row = min(max(math.floor((p0y + q0y) / 2.0 + 0.5), 0), rows - 1)
        column = min(max(math.floor((p0x + q0x) / 2.0 + 0.5), 0), columns - 1)
        # The middle of the side is within half a cell of this grid point.
        skip = corner_distance[row, column] - 1.0 - half
        if skip > LEAST_SKIP:
            s += skip / speed
            x0, y0, cos0, sin0 = carried(x, y, cos, sin, vx, vy, omega, s)
            continue
        piece = min(longest, end - s)
        x1, y1, cos1, sin1 = carried(x, y, cos, sin, vx, vy, omega, s + piece)
        p1x, p1y = x1 + cos1 * first_x - sin1 * first_y, y1 + sin1 * first_x + cos1 * first_y
        q1x, q1y = x1 + cos1 * last_x - sin1 * last_y, y1 + sin1 * last_x + cos1 * last_y
        # An arc leaves its chord by an eighth of speed times turn; the sides' crossing, if the
        # centre of rotation is near the side, is twice as far from the nearest arc.
        rim = 0.375 * speed * abs(omega) * piece * piece + 10.0 * CLOSE
        least = math.inf
        lowest = min(min(p0y, q0y), min(p1y, q1y)) - rim
        highest = max(max(p0y, q0y), max(p1y, q1y)) + rim
        row, top_row = max(math.ceil(lowest), 0), min(math.floor(highest), rows - 1)
        while row <= top_row:
            bottom, top = row - rim, row + rim
            left, right = with_span(p0x, p0y, q0x, q0y, bottom, top, math.inf, -math.inf)
            left, right = with_span(p1x, p1y, q1x, q1y, bottom, top, left, right)
            left, right = with_span(p0x, p0y, p1x, p1y, bottom, top, left, right)
            left, right = with_span(q0x, q0y, q1x, q1y, bottom, top, left, right)
            if left > right:
                row += 1
                continue
            column = max(math.ceil(left - rim), 0)
            last_column = min(math.floor(right + rim), columns - 1)
            while column <= last_column:
                distance = corner_distance[row, column]
                if distance == 0:
                    dx, dy = column - x0, row - y0
                    met = _corner_contact(
                        cos0 * dx + sin0 * dy - ax,
                        cos0 * dy - sin0 * dx - ay,
                        ax,
                        ay,
                        tx,
                        ty,
                        length,
                        vx,
                        vy,
                        omega,
                    )
                    least = min(least, met)
                    column += 1
                else:
                    column += int(distance)
            row += 1
        if least < math.inf:
            if omega != 0.0:
                least = math.atan(omega * least / 2.0) * 2.0 / omega
            if least <= piece * (1.0 + 1e-9) + 1e-12:
                return min(s + least, end)
        s, x0, y0, cos0, sin0 = s + piece, x1, y1, cos1, sin1
    return math.inf


@inlined
def _corner_contact(dx, dy, ax, ay, tx, ty, length, vx, vy, omega):
    """
    Return when a corner at (dx, dy) from the begin of a side meets the side; inf for never.

    The corner is seen from the robot: it moves by the inverse twist. The result is
    ``2 / omega tan(omega s / 2)`` for the time s at which it passes from the outside to the
    inside, which is the time itself for a twist that does not turn.
    """
    # Velocity of the corner, and that turned by a right angle, along the normal and the side.
    wx, wy = omega * (ay + dy) - vx, -omega * (ax + dx) - vy
    above = ty * dx - tx * dy - CLOSE
    approach, bend = ty * wx - tx * wy, -(ty * -wy - tx * wx)
    # above (1 + (omega m / 2)^2) + approach m + omega bend m^2 / 2 = 0
    square = above * omega * omega / 4.0 + bend * omega / 2.0
    root = approach * approach - 4.0 * square * above
    if root < 0.0:
        return math.inf
    root = math.sqrt(root)
    if approach < 0.0:
        m = 2.0 * above / (root - approach)
    elif square < 0.0:
        m = -(approach + root) / (2.0 * square)
    else:
        return math.inf
    if m < 0.0:
        return math.inf
    turn = omega * m / 2.0
    slide = tx * wx + ty * wy, -(tx * -wy + ty * wx)
    along = (
        tx * dx + ty * dy + (slide[0] * m + slide[1] * omega * m * m / 2.0) / (1.0 + turn * turn)
    )
    return m if -CLOSE <= along <= length + CLOSE else math.inf
