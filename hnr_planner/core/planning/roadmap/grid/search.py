"""
Shortest paths between points over the edges of the corners, by A* with landmarks.

Start and goal are connected to the corners visible from them to which their segment is tangent.
"""

import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.planning.planners.heap import N_OPEN
from hnr_planner.core.planning.roadmap.grid.corners import state_along, X, Y
from hnr_planner.core.planning.roadmap.grid.edges import fit
from hnr_planner.core.planning.roadmap.grid.labels import (
    end_of_taut,
    Labels,
    make_labels,
    pop_state,
    set_label,
)
from hnr_planner.core.planning.roadmap.grid.landmarks import N_LANDMARKS
from hnr_planner.core.planning.roadmap.grid.sweep import (
    make_sweep,
    see_from_point,
    Sweep,
    TARGET,
)
from hnr_planner.core.spaces.grid.slabs import OFF_LINE
from hnr_planner.core.spaces.primitives import component
from hnr_planner.core.trees import NONE
import numpy as np
from numpy.typing import NDArray

#: Entries of ``Work.counts``: number of states labelled, number of states that see the goal, and
#: the state of the last bend of the shortest path found so far.
N_LABELLED, N_AT_GOAL, LAST = range(3)


class Work(NamedTuple):
    """
    Work arrays of searches in a graph of n corners, and what they hold of one request.

    Attributes
    ----------
    labels : Labels
        Shortest paths from the start.
    sweep : Sweep
        Arrays of the sweeps from start and goal.
    goal : (2,)
        The goal, kernel frame.
    shortest : (1,)
        Length of the shortest path to the goal found so far.
    to_goal : (2 n,)
        Straight distance to the goal from each state that sees it; inf from others.
    landmarks : (N_LANDMARKS,)
        Distances of the goal from the landmarks.
    labelled, at_goal : (2 n,) int32
        States with an entry in ``labels``, and in ``to_goal``.
    counts : (3,) int64
        ``N_LABELLED``, ``N_AT_GOAL`` and ``LAST``.

    """

    labels: Labels
    sweep: Sweep
    goal: Floats
    shortest: Floats
    to_goal: Floats
    landmarks: Floats
    labelled: NDArray[np.int32]
    at_goal: NDArray[np.int32]
    counts: NDArray[np.int64]


@kernel
def shortest_paths(graph, space, starts, goals):
    """
    Return the shortest paths for many requests; points and lengths are in the kernel frame.

    Free space is open, so a shortest path is a limit: there are free paths as little longer as
    wanted.

    Parameters
    ----------
    graph : Graph
        Graph of the grid.
    space : GridData
        The grid.
    starts, goals : (k, 2)
        Ends of the requests.

    Returns
    -------
    lengths : (k,)
        Lengths of the shortest paths; inf where no path exists or an end is not free.
    first : (k + 1,) int64
        Index in ``bends`` of the first bend of each path; the last entry is their number.
    bends : (m,) int32
        Corners at which the paths bend, path after path, each from start to goal.

    """
    graph, space = borrowed(graph), borrowed(space)
    starts, goals = borrowed(starts), borrowed(goals)
    work = _make_work(graph)
    lengths, first = np.full(len(starts), np.inf), np.zeros(len(starts) + 1, dtype=np.int64)
    bends, n = np.empty(64, dtype=np.int32), 0
    for k in range(len(starts)):
        label = component(space, starts[k])
        if label != 0 and label == component(space, goals[k]):
            _search(graph, work, starts[k], goals[k])
            lengths[k] = work.shortest[0]
            n_bends = _count_bends(work)
            bends = fit(bends, n + n_bends)
            n += n_bends
            _write_bends(work, bends[:n])
            _reset(work)
        first[k + 1] = n
    return lengths, first, bends[:n].copy()


@kernel
def _make_work(graph):
    """Return work arrays for searches in a graph, ready for a first request."""
    n_states = len(graph.edges.first) - 1
    return Work(
        make_labels(graph.edges),
        make_sweep(graph.corners),
        np.empty(2),
        np.full(1, np.inf),
        np.full(n_states, np.inf),
        np.full(N_LANDMARKS, np.inf),
        np.empty(n_states, dtype=np.int32),
        np.empty(n_states, dtype=np.int32),
        np.array([0, 0, NONE]),
    )


@kernel
def _reset(work):
    """Make the work arrays ready for the next request."""
    counts = work.counts
    for k in range(counts[N_LABELLED]):
        work.labels.length[work.labelled[k]] = math.inf
    for k in range(counts[N_AT_GOAL]):
        work.to_goal[work.at_goal[k]] = math.inf
    for k in range(N_LANDMARKS):
        work.landmarks[k] = math.inf
    counts[N_LABELLED], counts[N_AT_GOAL], counts[LAST] = 0, 0, NONE
    work.labels.sizes[N_OPEN] = 0
    work.shortest[0] = math.inf


@kernel
def _search(graph, work, start, goal):
    """Find the shortest path from ``start`` to ``goal`` (2,); it is stored in ``work``."""
    places, edges, labels = graph.corners.places, graph.edges, work.labels
    x, y = start[0], _off_line(start[1])
    work.goal[0], work.goal[1] = goal[0], _off_line(goal[1])
    _connect_goal(graph, work)
    _connect_start(graph, work, x, y)
    while labels.sizes[N_OPEN] > 0 and labels.estimates[0] < work.shortest[0]:
        state = pop_state(labels)
        if state == NONE:
            break
        before, length = labels.before[state], labels.length[state]
        here_x, here_y = places[state // 2, X], places[state // 2, Y]
        dx, dy = here_x - x, here_y - y
        if before != NONE:
            dx, dy = here_x - places[before // 2, X], here_y - places[before // 2, Y]
        for k in range(edges.first[state], end_of_taut(places, edges, state, dx, dy)):
            other = edges.to[k]
            step = _length(places[other // 2, X] - here_x, places[other // 2, Y] - here_y)
            _label(graph, work, other, state, length + step)


@kernel
def _connect_goal(graph, work):
    """Store the states that see the goal, and the goal's distances from the landmarks."""
    places, x, y = graph.corners.places, work.goal[0], work.goal[1]
    landmarks, of_goal = graph.landmarks, work.landmarks
    for k in range(see_from_point(graph.slabs, graph.corners, x, y, -1.0, -1.0, work.sweep)):
        corner = work.sweep.seen[k]
        dx, dy = x - places[corner, X], y - places[corner, Y]
        length = _length(dx, dy)
        for i in range(N_LANDMARKS):
            of_goal[i] = min(of_goal[i], landmarks[corner, i] + length)
        state = state_along(places, corner, dx, dy)
        if state != NONE:
            work.to_goal[state] = length
            work.at_goal[work.counts[N_AT_GOAL]] = state
            work.counts[N_AT_GOAL] += 1


@kernel
def _connect_start(graph, work, x, y):
    """
    Label the states at corners visible from the start (x, y), kernel frame.

    If the goal itself is visible, store the straight path as the shortest one instead.
    """
    places, goal = graph.corners.places, work.goal
    n_seen = see_from_point(graph.slabs, graph.corners, x, y, goal[0], goal[1], work.sweep)
    for k in range(n_seen):
        corner = work.sweep.seen[k]
        if corner == TARGET:
            work.shortest[0], work.counts[LAST] = _length(goal[0] - x, goal[1] - y), NONE
            return
    for k in range(n_seen):
        corner = work.sweep.seen[k]
        dx, dy = places[corner, X] - x, places[corner, Y] - y
        state = state_along(places, corner, dx, dy)
        if state != NONE:
            _label(graph, work, state, NONE, _length(dx, dy))


@inlined
def _label(graph, work, state, before, length):
    """
    Label a state with a path over the state ``before`` if that is shorter than the path known.

    It gets no label where no path over it can be shorter than the shortest path to the goal.
    """
    labels, counts = work.labels, work.counts
    if length >= labels.length[state]:
        return
    estimate = length + _least_rest(graph, work, state // 2)
    if estimate >= work.shortest[0]:
        return
    if labels.length[state] == math.inf:
        work.labelled[counts[N_LABELLED]] = state
        counts[N_LABELLED] += 1
    set_label(labels, state, before, length, estimate)
    if length + work.to_goal[state] < work.shortest[0]:
        work.shortest[0], counts[LAST] = length + work.to_goal[state], state


@inlined
def _least_rest(graph, work, corner):
    """Return a lower bound on the length of paths from a corner to the goal."""
    places, landmarks, of_goal = graph.corners.places, graph.landmarks, work.landmarks
    rest = _length(work.goal[0] - places[corner, X], work.goal[1] - places[corner, Y])
    for i in range(N_LANDMARKS):
        rest = max(rest, abs(landmarks[corner, i] - of_goal[i]))
    return rest


@kernel
def _count_bends(work):
    """Return the number of bends of the shortest path."""
    n, state = 0, work.counts[LAST]
    while state != NONE:
        n, state = n + 1, work.labels.before[state]
    return n


@kernel
def _write_bends(work, bends):
    """Write the corners at which the shortest path bends to the end of ``bends`` (m,)."""
    k, state = len(bends) - 1, work.counts[LAST]
    while state != NONE:
        bends[k] = state // 2
        k, state = k - 1, work.labels.before[state]


@inlined
def _off_line(y):
    """Return the height ``y``, moved up by ``OFF_LINE`` where it is that of a grid line."""
    return y + OFF_LINE if y == math.floor(y) else y


@inlined
def _length(dx, dy):
    """Return the length of a vector."""
    return math.sqrt(dx * dx + dy * dy)
