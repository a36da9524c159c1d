"""
Search for the shortest homotopy classes of paths on a grid, in the order of their lengths.

Of all paths that can be deformed into each other exactly one is taut: the shortest. Taut paths are
the walks over the edges between corners (``roadmap.grid.edges``) that turn towards the obstacle at
each corner. So the walks in the order of their lengths are the classes in the order of theirs, and
no class is missed. Walks are extended in the order of a lower bound on their lengths at the goal:
the length so far and the shortest walk from the last state to the goal, whatever its first turn.
So only beginnings of walks that can be among those sought are extended.

A path that passes a point twice goes round an obstacle and returns; it is left out. The beginning
of a path that passes no point twice passes none twice either, so that such beginnings are left out
as well.
"""

import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.copies import copy_into
from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.planning.planner import with_capacity
from hnr_planner.core.planning.planners.cones import length_of, side_of
from hnr_planner.core.planning.planners.heap import N_OPEN, pop, push
from hnr_planner.core.planning.planners.target import off_line
from hnr_planner.core.planning.roadmap.grid.corners import state_along, turn_of, X, Y
from hnr_planner.core.planning.roadmap.grid.labels import (
    end_of_taut,
    make_labels,
    pop_state,
    set_label,
    STRAIGHT,
)
from hnr_planner.core.planning.roadmap.grid.sweep import (
    cross,
    make_sweep,
    see_from_point,
    TARGET,
)
from hnr_planner.core.trees import NONE
import numpy as np
from numpy.typing import NDArray

#: Takes the place of a state at the goal.
AT_GOAL = -1
#: Entries of ``TautSearch.sizes``, beside that of the heap: numbers of labels and classes found.
N_LABELS, N_FOUND = 0, 1
#: A walk at most this many times as long as the straight segment is that segment.
EQUAL = 1.0 + 1e-12
#: Rows for labels at first, beside those that the corners visible from the start need.
INITIAL_ROWS = 1024


class TautSearch(NamedTuple):
    """
    State of a search, kernel frame [cells]; a label is the beginning of a walk from the start.

    Attributes
    ----------
    ends : (2, 2)
        Start and goal.
    rest : (2 n,)
        Least length of walks from each state to the goal.
    to_goal : (2 n,)
        Straight distance to the goal from each state that sees it; inf from others.
    states, parents : (rows,) int64
        State in which each label ends, or ``AT_GOAL``, and the label that it extends; NONE (-1)
        for the first segment of a walk.
    lengths : (rows,)
        Length of each label.
    estimates, heap : (rows,)
        Binary heap of labels by lower bounds on the lengths of their walks at the goal.
    found : (n_classes,) int64
        Labels at the goal, the shortest first.
    sizes : (3,) int64
        Numbers of labels, of classes found and of labels in the heap.

    """

    ends: Floats
    rest: Floats
    to_goal: Floats
    states: NDArray[np.int64]
    parents: NDArray[np.int64]
    lengths: Floats
    estimates: Floats
    heap: NDArray[np.int64]
    found: NDArray[np.int64]
    sizes: NDArray[np.int64]


def with_more_labels(search: TautSearch, rows: int) -> TautSearch:
    """Return ``search`` with arrays of at least ``rows`` rows for labels."""
    names = ('states', 'parents', 'lengths', 'estimates', 'heap')
    return search._replace(**{name: with_capacity(getattr(search, name), rows) for name in names})


@kernel
def begin(slabs, corners, edges, start, goal, n_classes):
    """
    Return a search for the ``n_classes`` shortest classes between two points (2,), kernel frame.

    The points are free and in the same component.
    """
    slabs, corners, edges = borrowed(slabs), borrowed(corners), borrowed(edges)
    places, n_states = corners.places, len(edges.first) - 1
    sweep, labels, to_goal = make_sweep(corners), make_labels(edges), np.full(n_states, np.inf)
    ends = np.empty((2, 2))
    copy_into(ends[0], start)
    copy_into(ends[1], goal)
    ends[0, 1], ends[1, 1] = off_line(ends[0, 1]), off_line(ends[1, 1])
    x, y = ends[1]
    for k in range(see_from_point(slabs, corners, x, y, -1.0, -1.0, sweep)):
        corner = sweep.seen[k]
        dx, dy = places[corner, X] - x, places[corner, Y] - y
        state = state_along(places, corner, dx, dy)
        if state != NONE:
            to_goal[_reverse(state)] = length_of(dx, dy)
            set_label(labels, state, NONE, length_of(dx, dy), length_of(dx, dy))
    rest = _lengths_to_goal(places, edges, labels)
    n_seen = see_from_point(slabs, corners, ends[0, 0], ends[0, 1], x, y, sweep)
    rows = INITIAL_ROWS + n_seen
    search = TautSearch(
        ends,
        rest,
        to_goal,
        np.empty(rows, dtype=np.int64),
        np.empty(rows, dtype=np.int64),
        np.empty(rows),
        np.empty(rows),
        np.empty(rows, dtype=np.int64),
        np.empty(n_classes, dtype=np.int64),
        np.zeros(3, dtype=np.int64),
    )
    _leave_start(places, search, sweep.seen, n_seen)
    return search


@inlined
def _reverse(state):
    """Return the state in which the same corner is passed the other way round."""
    return state ^ 1


@kernel
def _lengths_to_goal(places, edges, labels):
    """
    Return the least length (2 n,) of walks from each state to the goal, by Dijkstra's algorithm.

    ``labels`` holds the states in which walks back from the goal pass the corners that it sees.
    Walks may turn anyhow, so that the lengths do not depend on how a state is reached.
    """
    state = pop_state(labels)
    while state != NONE:
        x, y = places[state // 2, X], places[state // 2, Y]
        for k in range(edges.first[state], edges.first[state + 1]):
            other = edges.to[k]
            step = length_of(places[other // 2, X] - x, places[other // 2, Y] - y)
            if labels.length[state] + step < labels.length[other]:
                length = labels.length[state] + step
                set_label(labels, other, state, length, length)
        state = pop_state(labels)
    rest = np.empty(len(labels.length))
    for state in range(len(rest)):
        rest[state] = labels.length[_reverse(state)]
    return rest


@kernel
def _leave_start(places, search, seen, n_seen):
    """Add the labels to the first ``n_seen`` of the corners ``seen`` from the start, or target."""
    x, y = search.ends[0]
    for k in range(n_seen):
        if seen[k] == TARGET:  # before all others: it has to be label 0
            length = length_of(search.ends[1, 0] - x, search.ends[1, 1] - y)
            _add_label(search, AT_GOAL, NONE, length, length)
    for k in range(n_seen):
        if seen[k] != TARGET:
            dx, dy = places[seen[k], X] - x, places[seen[k], Y] - y
            state = state_along(places, seen[k], dx, dy)
            if state != NONE:
                length = length_of(dx, dy)
                _add_label(search, state, NONE, length, length + search.rest[state])


@inlined
def _add_label(search, state, parent, length, estimate):
    """Write a label in the first free row, and push it on the heap where the goal is in reach."""
    if estimate < math.inf:
        label = search.sizes[N_LABELS]
        search.states[label], search.parents[label] = state, parent
        search.lengths[label] = length
        search.sizes[N_LABELS] += 1
        push(search, estimate, label)


@kernel
def extend(corners, edges, search, n_labels):
    """
    Extend at most ``n_labels`` labels in the order of their estimates; return how many.

    The work ends early when all classes sought are found, no label is left, or the arrays of
    ``search`` may have too few rows for the next label.
    """
    corners, edges, search = borrowed(corners), borrowed(edges), borrowed(search)
    places, sizes = corners.places, search.sizes
    for i in range(n_labels):
        if sizes[N_OPEN] == 0 or sizes[N_FOUND] == len(search.found):
            return i
        label = search.heap[0]
        state = search.states[label]
        n_edges = 0 if state == AT_GOAL else edges.first[state + 1] - edges.first[state]
        if sizes[N_LABELS] + n_edges + 1 > len(search.states):
            return i
        pop(search)
        if not _passes_no_point_twice(places, search, label):
            continue
        if state != AT_GOAL:
            _extend_label(places, edges, search, label)
        elif label == 0 or not _is_straight(search, label):
            search.found[sizes[N_FOUND]] = label
            sizes[N_FOUND] += 1
    return n_labels


@inlined
def _is_straight(search, label):
    """Return whether a label at the goal is the straight segment, label 0, over a corner on it."""
    return search.states[0] == AT_GOAL and search.lengths[label] <= EQUAL * search.lengths[0]


@inlined
def _extend_label(places, edges, search, label):
    """Add the labels that extend a label by one edge in its turn, or by the way to the goal."""
    state = search.states[label]
    x, y = _point(places, search, label)
    before_x, before_y = _point(places, search, search.parents[label])
    dx, dy = x - before_x, y - before_y
    for k in range(edges.first[state], end_of_taut(places, edges, state, dx, dy)):
        other = edges.to[k]
        step = length_of(places[other // 2, X] - x, places[other // 2, Y] - y)
        length = search.lengths[label] + step
        _add_label(search, other, label, length, length + search.rest[other])
    goal_x, goal_y = search.ends[1, 0] - x, search.ends[1, 1] - y
    if turn_of(places, state) * cross(dx, dy, goal_x, goal_y) >= -STRAIGHT:
        length = search.lengths[label] + search.to_goal[state]
        _add_label(search, AT_GOAL, label, length, length)


@inlined
def _point(places, search, label):
    """Return the point (x, y) at which a label ends; the start for NONE (-1)."""
    if label == NONE:
        return search.ends[0, 0], search.ends[0, 1]
    state = search.states[label]
    if state == AT_GOAL:
        return search.ends[1, 0], search.ends[1, 1]
    return places[state // 2, X], places[state // 2, Y]


@kernel
def _passes_no_point_twice(places, search, label):
    """Return whether the last segment of a label meets the path before only where it begins."""
    first = search.parents[label]
    if first == NONE:
        return True
    ax, ay = _point(places, search, first)
    bx, by = _point(places, search, label)
    if _is_inside(search.ends[0, 0], search.ends[0, 1], ax, ay, bx, by):
        return False
    dx, dy, later = ax, ay, first
    while later != NONE:
        earlier = search.parents[later]
        cx, cy = _point(places, search, earlier)
        if (cx == bx and cy == by) or _is_inside(bx, by, cx, cy, dx, dy):
            return False
        is_split = side_of(ax, ay, bx, by, cx, cy) * side_of(ax, ay, bx, by, dx, dy) < 0.0
        if is_split and side_of(cx, cy, dx, dy, ax, ay) * side_of(cx, cy, dx, dy, bx, by) < 0.0:
            return False
        dx, dy, later = cx, cy, earlier
    return True


@inlined
def _is_inside(px, py, ax, ay, bx, by):
    """Return whether a point lies on the segment from a to b, and is none of its ends."""
    is_on_line = side_of(ax, ay, bx, by, px, py) == 0.0
    return is_on_line and (px - ax) * (px - bx) + (py - ay) * (py - by) < 0.0
