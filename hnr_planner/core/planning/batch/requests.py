"""
Many requests for shortest paths in one call of a kernel.

The kernel takes request after request, in arrays that it uses again for each. It returns when all
are done, when it has expanded as many cones as it was allowed to, and when an array is too short;
called again it goes on where it stopped. So one call is worth many requests, and the caller can
look at the clock between two calls.
"""

import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.copies import copy_into, copy_rows
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.lengths import path_length
from hnr_planner.core.planning.planner import Problem, reaches_goal
from hnr_planner.core.planning.planners.cone_expansion import expand
from hnr_planner.core.planning.planners.cones import (
    FINAL,
    NONE,
    open_frontier,
)
from hnr_planner.core.planning.planners.target import make_target
from hnr_planner.core.planning.planners.taut_path import taut_path
from hnr_planner.core.spaces.grid.components import nearest_in_component
from hnr_planner.core.spaces.primitives import component, first_blocked_segment
import numpy as np
from numpy.typing import NDArray

#: How a request ended; the numbers of members of ``PlannerStatus`` in ``plan_many``.
WAITING, SOLVED, INVALID_START, INVALID_GOAL, UNREACHABLE, ITERATION_LIMIT = range(6)
#: Why the kernel returned: all requests are done, or it may be called again, with longer arrays of
#: nodes or of points where it asks for them.
DONE, PAUSED, FEW_NODES, FEW_POINTS = range(4)
#: Entries of ``Progress.sizes``: requests that are done, points written, and whether the search
#: for the next request has begun.
N_DONE, N_POINTS, IS_OPEN = range(3)


class Progress(NamedTuple):
    """
    Results of the requests so far; lengths and points are in the kernel frame [cells].

    Attributes
    ----------
    status : (k,) int8
        How each request ended; ``WAITING`` while it has not.
    bounds : (k,)
        Lower bound on the length of free paths of each request by its search; 0 where there was
        none, inf where no path exists.
    iterations : (k,) int64
        Number of cones expanded for each request.
    ends : (k,) int64
        Number of points written when each request was done.
    points : (rows, 2)
        Vertices of the paths, one path after the other.
    sizes : (3,) int64
        ``N_DONE``, ``N_POINTS`` and ``IS_OPEN``.

    """

    status: NDArray[np.int8]
    bounds: Floats
    iterations: NDArray[np.int64]
    ends: NDArray[np.int64]
    points: Floats
    sizes: NDArray[np.int64]


def no_progress(n_requests: int, n_points: int) -> Progress:
    """Return the results of ``n_requests`` that have not begun, with room for points of paths."""
    return Progress(
        np.full(n_requests, WAITING, dtype=np.int8),
        np.zeros(n_requests),
        np.zeros(n_requests, dtype=np.int64),
        np.zeros(n_requests, dtype=np.int64),
        np.empty((n_points, 2)),
        np.zeros(3, dtype=np.int64),
    )


@kernel
def go_on(problem, slabs, ends, most, frontier, progress, n):
    """
    Work on requests for shortest paths on a grid; return why the work stopped.

    Parameters
    ----------
    problem : Problem
        What all requests share; its start and goal are not looked at.
    slabs : Slabs
        The slabs of the grid.
    ends : (k, 2, 2)
        Start and goal of each request, kernel frame.
    most : float
        Number of cones that may be expanded for one request; may be inf.
    frontier : Frontier
        Arrays of the searches.
    progress : Progress
        The results so far.
    n : int
        Number of cones that may be expanded in this call.

    """
    problem, slabs, ends = borrowed(problem), borrowed(slabs), borrowed(ends)
    frontier, progress = borrowed(frontier), borrowed(progress)
    sizes = progress.sizes
    while sizes[N_DONE] < len(ends):
        i = sizes[N_DONE]
        one = _with_ends(problem, ends[i, 0], ends[i, 1])
        if sizes[IS_OPEN] == 0:
            status = _without_search(one)
            if status != WAITING:
                if sizes[N_POINTS] + 2 > len(progress.points):
                    return FEW_POINTS
                _end_without_search(progress, one, status)
                continue
        target = make_target(slabs, one.goal, one.goal_radius, one.margin)
        if sizes[IS_OPEN] == 0:
            open_frontier(slabs, frontier, one.start, target)
            sizes[IS_OPEN] = 1
        used = expand(slabs, frontier, target, int(min(float(n), most - progress.iterations[i])))
        n -= used
        progress.iterations[i] += used
        status = ITERATION_LIMIT
        if frontier.sizes[FINAL] != NONE:
            last = frontier.sizes[FINAL]
            path, first = taut_path(one, slabs.steps, frontier.vertices, last), sizes[N_POINTS]
            last = first + len(path)
            if last > len(progress.points):
                return FEW_POINTS
            copy_rows(progress.points[first:last], path)
            sizes[N_POINTS] = last
            status = SOLVED
        elif progress.iterations[i] < most:
            return PAUSED if n <= 0 else FEW_NODES
        _end(progress, status, frontier.estimates[0])
    return DONE


@kernel
def _with_ends(problem, start, goal):
    """Return a problem with another start and goal (2,), kernel frame."""
    return Problem(
        problem.space,
        problem.lower,
        problem.upper,
        start,
        goal,
        problem.goal_radius,
        problem.margin,
        problem.typical_clearance,
        problem.scale,
    )


@kernel
def _without_search(problem):
    """Return how a request ends that needs no search; ``WAITING`` for one that needs a search."""
    space, start, goal = problem.space, problem.start, problem.goal
    start_component, goal_component = component(space, start), component(space, goal)
    if start_component == 0:
        return INVALID_START
    if reaches_goal(problem, start):
        return SOLVED
    if start_component == goal_component:
        return WAITING
    if problem.goal_radius > 0.0:
        _, offset = nearest_in_component(space.labels, start_component, goal, problem.margin)
        if offset <= problem.goal_radius:
            return WAITING
    return INVALID_GOAL if goal_component == 0 else UNREACHABLE


@kernel
def _end_without_search(progress, problem, status):
    """Write how the next request ended; a solved one has the straight path, of two points."""
    bound = math.inf
    if status == SOLVED:
        k, bound = progress.sizes[N_POINTS], 0.0
        copy_into(progress.points[k], problem.start)
        is_there = problem.goal_radius > 0.0
        copy_into(progress.points[k + 1], problem.start if is_there else problem.goal)
        progress.sizes[N_POINTS] += 2
    _end(progress, status, bound)


@kernel
def _end(progress, status, bound):
    """Write the status and the lower bound of the next request, which is done by that."""
    i = progress.sizes[N_DONE]
    progress.status[i], progress.bounds[i] = status, bound
    progress.ends[i] = progress.sizes[N_POINTS]
    progress.sizes[N_DONE], progress.sizes[IS_OPEN] = i + 1, 0


@kernel
def measure_paths(space, cells, points, ends, lengths, is_free):
    """
    Write the length of each path, and whether all of its segments are free.

    Parameters
    ----------
    space : NamedTuple
        The space as kernels take it.
    cells, points : (rows, 2)
        Vertices of the paths, one path after the other, in the kernel frame and in the caller's.
    ends : (k,)
        Number of vertices of the first path, of the first two, and so on.
    lengths, is_free : (k,)
        What is written: lengths in the caller's frame, inf for a path without vertices.

    """
    space, cells, points = borrowed(space), borrowed(cells), borrowed(points)
    first = 0
    for i in range(len(ends)):
        last = ends[i]
        lengths[i], is_free[i] = math.inf, True
        if last > first:
            lengths[i] = path_length(points[first:last])
            is_free[i] = first_blocked_segment(space, cells[first:last]) < 0
        first = last
