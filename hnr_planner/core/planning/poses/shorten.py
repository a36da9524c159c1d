"""
Shorten a path of poses: replace sections by cheaper connections between two of its poses.

A section runs between two poses along the path. Long ones are replaced while the path is still
rough; later gains come from short ones, above all around changes of direction. A section is
replaced where a connection between its ends lowers the cost of the whole path: its length, what
driving backwards costs, and a price for each change of direction.
"""

import math

from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import uniform
from hnr_planner.core.planning.poses.connections import (
    connect_below,
    connection_is_free,
    cost_of,
    is_seen_blocked,
    motion_cost,
    N_KEPT,
    N_MOTIONS,
)
from hnr_planner.core.spaces.poses.motion import moved, wrapped

#: Probability that an end of a section is a vertex, where the motion changes.
AT_VERTEX = 0.3
#: Probability that a section is short rather than of any length, and then, that it lies around a
#: change of direction.
LOCAL, AT_CHANGE = 0.7, 0.3
#: Least decrease of the cost, as a fraction of it.
LEAST_GAIN = 1e-4
#: Motions that a replaced section may add, and rows at the end of the work arrays.
SPARE_ROWS = N_MOTIONS + 5
#: Difference of directions, relative, up to which two motions that follow each other are one.
ALIKE = 1e-12


@kernel
def shorten_path(space, prices, poses, twists, n, spare_poses, spare_twists, found, rng, n_tries):
    """
    Try to replace sections of a path in place; return its number of motions.

    Parameters
    ----------
    space, prices
        The compiled space of poses, and the ``Prices`` of motions.
    poses, twists : (m + 1, 3), (m, 3)
        The path, with room for ``SPARE_ROWS`` motions more than n.
    n : int
        Number of its motions.
    spare_poses, spare_twists
        Work arrays of the same shapes.
    found : Connections
        Work arrays for connections.
    rng : (4,) uint64
        Random stream.
    n_tries : int
        Number of sections to try.

    """
    space, poses, twists = borrowed(space), borrowed(poses), borrowed(twists)
    spare_poses, spare_twists = borrowed(spare_poses), borrowed(spare_twists)
    found, rng = borrowed(found), borrowed(rng)
    room = len(twists) - SPARE_ROWS
    cost = cost_of(prices, twists, n, 1.0)
    for _ in range(n_tries):
        if n > room:
            return n
        i, f, j, g = _draw_section(space, twists, n, rng)
        if j == i and (g <= f or (f > 0.0 and g < 1.0)):
            continue
        begin, end = spare_poses[len(twists)], spare_poses[len(twists) - 1]
        _write_pose(poses, twists, i, f, begin)
        _write_pose(poses, twists, j, g, end)
        limit = cost - _cost_of_rest(prices, twists, n, i, f, j, g)
        if math.hypot(end[0] - begin[0], end[1] - begin[1]) >= limit:
            continue
        connect_below(space, prices, begin, end, 1.0, limit, found)
        for k in range(N_KEPT):
            if not found.costs[k] < limit:
                break
            m = _replaced(poses, twists, n, i, f, j, g, found, k, spare_poses, spare_twists)
            lower = cost_of(prices, spare_twists, m, 1.0)
            if (
                lower < (1.0 - LEAST_GAIN) * cost
                and not is_seen_blocked(space, begin, found.twists[k], found.sizes[k])
                and connection_is_free(space, begin, found.twists[k], found.sizes[k])
            ):
                cost, n = lower, m
                for row in range(n):
                    for c in range(3):
                        twists[row, c] = spare_twists[row, c]
                        poses[row + 1, c] = spare_poses[row + 1, c]
                break
    return n


@kernel
def _cost_of_rest(prices, twists, n, i, f, j, g):
    """
    Return what a path of n motions costs outside a section, changes at its ends aside.

    The section begins after the share f of motion i, and ends after the share g of motion j.
    """
    cost = f * motion_cost(prices, twists[i, 0], twists[i, 1], twists[i, 2], 1.0)
    cost += (1.0 - g) * motion_cost(prices, twists[j, 0], twists[j, 1], twists[j, 2], 1.0)
    behind = j + 1
    return (
        cost + cost_of(prices, twists, i, 1.0) + cost_of(prices, twists[behind:], n - behind, 1.0)
    )


@kernel
def _draw_section(space, twists, n, rng):
    """
    Return a section: the motion in which it begins, the share of it before, and both of its end.

    Its length is uniform, or as often short as long: then it lies around a change of direction, or
    anywhere.
    """
    total = 0.0
    for k in range(n):
        total += _extent(space, twists, k)
    begin, end = uniform(rng) * total, uniform(rng) * total
    if uniform(rng) < LOCAL:
        if uniform(rng) < AT_CHANGE:
            begin = _draw_change(space, twists, n, begin, rng)
        length = space.stride * max(total / space.stride, 1.0) ** uniform(rng)
        begin -= length * uniform(rng)
        end = begin + length
    i, f = _place(space, twists, n, min(begin, end), rng)
    j, g = _place(space, twists, n, max(begin, end), rng)
    return i, f, j, g


@kernel
def _draw_change(space, twists, n, otherwise, rng):
    """Return how far along the path a random change of direction is; ``otherwise`` without one."""
    found, along, direction, n_changes = otherwise, 0.0, 0.0, 0
    for k in range(n):
        if twists[k, 0] != 0.0:
            if twists[k, 0] * direction < 0.0:
                n_changes += 1
                if uniform(rng) * n_changes < 1.0:
                    found = along
            direction = twists[k, 0]
        along += _extent(space, twists, k)
    return found


@kernel
def _place(space, twists, n, along, rng):
    """Return the motion that is ``along`` the path, and the share of it before, or a vertex."""
    k = 0
    while k < n - 1 and along >= _extent(space, twists, k):
        along -= _extent(space, twists, k)
        k += 1
    share = min(max(along / _extent(space, twists, k), 0.0), 1.0)
    if uniform(rng) < AT_VERTEX:
        return k, 0.0 if share < 0.5 else 1.0
    return k, share


@kernel
def _extent(space, twists, k):
    """Return about how far [cells] the footprint moves in motion ``k``."""
    vx, vy, omega = twists[k, 0], twists[k, 1], twists[k, 2]
    return math.hypot(vx, vy) + 0.5 * space.reach * abs(omega)


@kernel
def _write_pose(poses, twists, k, share, pose):
    """Write the pose after a share of motion ``k`` to ``pose`` (3,)."""
    x, y, yaw = poses[k, 0], poses[k, 1], poses[k, 2]
    if share >= 1.0:
        x, y, yaw = poses[k + 1, 0], poses[k + 1, 1], poses[k + 1, 2]
    elif share > 0.0:
        x, y, yaw = moved(x, y, yaw, twists[k, 0], twists[k, 1], twists[k, 2], share)
    pose[0], pose[1], pose[2] = x, y, wrapped(yaw)


@kernel
def _replaced(poses, twists, n, i, f, j, g, found, k, new_poses, new_twists):
    """
    Write the path with a section replaced by connection ``k``; return its number of motions.

    The section begins after the share f of motion i, and ends after the share g of motion j.
    """
    m = 0
    for row in range(i):
        m = _append(new_poses, new_twists, m, twists, row, 1.0, poses[row + 1])
    begin, end = new_poses[len(new_twists)], new_poses[len(new_twists) - 1]
    if f > 0.0:
        m = _append(new_poses, new_twists, m, twists, i, f, begin)
    x, y, yaw = begin[0], begin[1], begin[2]
    for row in range(found.sizes[k]):
        motion = found.twists[k, row]
        x, y, yaw = moved(x, y, yaw, motion[0], motion[1], motion[2], 1.0)
        pose = new_poses[len(new_twists) - 2]
        pose[0], pose[1], pose[2] = x, y, wrapped(yaw)
        is_last = row == found.sizes[k] - 1
        m = _append(new_poses, new_twists, m, found.twists[k], row, 1.0, end if is_last else pose)
    if g < 1.0:
        m = _append(new_poses, new_twists, m, twists, j, 1.0 - g, poses[j + 1])
    for row in range(j + 1, n):
        m = _append(new_poses, new_twists, m, twists, row, 1.0, poses[row + 1])
    return m


@kernel
def _append(new_poses, new_twists, m, twists, row, share, end):
    """
    Append a share of a motion that ends at the pose ``end``; return the number of motions.

    A motion that goes on along the one before is joined with it.
    """
    vx, vy, omega = share * twists[row, 0], share * twists[row, 1], share * twists[row, 2]
    for c in range(3):
        new_poses[m + 1, c] = end[c]
    if m > 0:
        wx, wy, turn = new_twists[m - 1, 0], new_twists[m - 1, 1], new_twists[m - 1, 2]
        size = math.hypot(math.hypot(vx, vy), omega) * math.hypot(math.hypot(wx, wy), turn)
        across = abs(vx * wy - vy * wx) + abs(vx * turn - omega * wx) + abs(vy * turn - omega * wy)
        if across <= ALIKE * size and vx * wx + vy * wy + omega * turn > 0.0:
            new_twists[m - 1, 0], new_twists[m - 1, 1] = wx + vx, wy + vy
            new_twists[m - 1, 2] = turn + omega
            for c in range(3):
                new_poses[m, c] = end[c]
            return m
    new_twists[m, 0], new_twists[m, 1], new_twists[m, 2] = vx, vy, omega
    return m + 1
