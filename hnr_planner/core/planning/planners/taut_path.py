"""
The path of a solved search of ``polyanya``, moved off the corners at which it bends.

Free space is open, so the shortest path is a limit: its bends are corners of obstacles. The free
path beside it passes each corner at the margin.
"""

from hnr_planner.core.kernels.copies import copy_into
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.lengths import distance
from hnr_planner.core.planning.planners.cones import CORNER, NONE, PARENT, X, Y
from hnr_planner.core.spaces.primitives import first_exit
import numpy as np

#: Rows of the array of the result for each vertex of a path that is moved off corners.
GRAZED_MAX = 64


@kernel
def taut_path(problem, steps, vertices, last):
    """
    Return the path (m, 2) of a solved search, kernel frame, at the margin from its corners.

    ``steps`` are those of ``Slabs``, ``vertices`` those of the search (``Frontier``), and ``last``
    is the row of the last vertex of the path.
    """
    n, row = 0, last
    while row != NONE:
        n, row = n + 1, int(vertices[row, PARENT])
    has_goal = problem.goal_radius == 0.0
    points = np.empty((n + 1 if has_goal else n, 2))
    row = last
    for k in range(n - 1, 0, -1):
        _move_aside(steps, vertices[row], problem.margin, points[k])
        row = int(vertices[row, PARENT])
    copy_into(points[0], problem.start)
    if has_goal:
        copy_into(points[n], problem.goal)
    return step_aside(problem.space, points, problem.margin)


@kernel
def points_reached(steps, vertices, start, margin):
    """
    Return the points (k, 2) of the vertices (k, 5) of a search, kernel frame.

    They are at the ``margin`` from their corners; the first is ``start`` (2,). ``steps`` are those
    of ``Slabs``.
    """
    points = np.empty((len(vertices), 2))
    copy_into(points[0], start)
    for k in range(1, len(vertices)):
        _move_aside(steps, vertices[k], margin, points[k])
    return points


@kernel
def _move_aside(steps, vertex, margin, point):
    """Write the point (2,) of a vertex, at the ``margin`` from its corner where it is at one."""
    corner = int(vertex[CORNER])
    point[0], point[1] = vertex[X], vertex[Y]
    if corner != NONE:
        point[0] += margin * steps[corner // 2, corner % 2, 0]
        point[1] += margin * steps[corner // 2, corner % 2, 1]


@kernel
def step_aside(space, points, margin):
    """
    Return a free path (k, 2) along ``points`` (m, 2) that passes every corner at the margin.

    A segment between two points is blocked only where it grazes a corner or a wall along it,
    possibly because its ends were moved off their corners. Then the path gets another vertex at
    the margin from the corner that is grazed, or from the one at which the wall ends.
    """
    aside = np.empty((GRAZED_MAX * len(points), 2))
    copy_into(aside[0], points[0])
    n, k = 1, 1
    pending = np.empty((GRAZED_MAX * len(points), 2))
    n_pending = 0
    while k < len(points) or n_pending > 0:
        end = pending[n_pending - 1] if n_pending > 0 else points[k]
        a = aside[n - 1]
        u = end - a
        t = first_exit(space, a, u, 0.0, 1.0) if u.any() else 2.0
        if t <= 1.0 and n + n_pending + 2 < len(aside):
            corner, step = _grazed_corner(space.free_distance, np.round(a + t * u), u)
            bend = corner + margin * step
            if step.any() and distance(bend, a) > 0.0 and distance(bend, end) > 0.0:
                copy_into(pending[n_pending], bend)
                n_pending += 1
                continue
        copy_into(aside[n], end)
        n += 1
        if n_pending > 0:
            n_pending -= 1
        else:
            k += 1
    return aside[:n].copy()


@kernel
def _grazed_corner(free_distance, corner, u):
    """
    Return the corner that a segment grazes, and the direction (2,) away from its blocked cell.

    ``corner`` (2,) is the grid point where the segment along ``u`` (2,) meets a blocked cell. If
    that is a point of a straight wall, the corner is the end of the wall ahead. The direction is
    (0, 0) where there is no such corner.
    """
    along = np.zeros(2)
    axis = 0 if abs(u[0]) > abs(u[1]) else 1
    along[axis] = 1.0 if u[axis] > 0.0 else -1.0
    step = _step_from(free_distance, int(corner[0]), int(corner[1]))
    while not step.any() and _is_on_wall(free_distance, int(corner[0]), int(corner[1]), axis):
        corner = corner + along
        step = _step_from(free_distance, int(corner[0]), int(corner[1]))
    return corner, step


@kernel
def _is_on_wall(free_distance, x, y, axis):
    """Return whether a wall along x (``axis`` 0) or y (1) passes through the grid point (x, y)."""
    first, last = free_distance[y - 1, x - 1] == 0, free_distance[y, x] == 0
    if axis == 0:
        below, above = free_distance[y - 1, x] == 0, free_distance[y, x - 1] == 0
    else:
        below, above = free_distance[y, x - 1] == 0, free_distance[y - 1, x] == 0
    return first == below and last == above and first != last


@kernel
def _step_from(free_distance, x, y):
    """
    Return the direction (2,), entries +1 or -1, away from the one blocked cell at a corner.

    It is (0, 0) where not exactly one of the four cells at the grid point (x, y) is blocked.
    """
    step, n_blocked = np.zeros(2), 0
    for row, up in ((y - 1, 1.0), (y, -1.0)):
        for column, right in ((x - 1, 1.0), (x, -1.0)):
            if free_distance[row, column] == 0:
                step[0], step[1] = right, up
                n_blocked += 1
    if n_blocked != 1:
        step[0], step[1] = 0.0, 0.0
    return step
