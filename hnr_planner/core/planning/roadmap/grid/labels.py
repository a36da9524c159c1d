"""
Labels: the shortest path found so far to each state, and the heap of states to continue from.

A path out of a state continues over those of its edges that turn towards the obstacle, or straight
on. They are the first ones in the order of ``Edges``.
"""

from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.planning.planners.heap import N_OPEN, pop, push
from hnr_planner.core.planning.roadmap.grid.corners import turn_of, X, Y
from hnr_planner.core.planning.roadmap.grid.sweep import cross
from hnr_planner.core.trees import NONE
import numpy as np
from numpy.typing import NDArray

#: Turns of less than this to the wrong side count as straight on, as a cross product [cells^2]: it
#: is more than rounding, and less than any turn between three corners.
STRAIGHT = 1e-4


class Labels(NamedTuple):
    """
    Labels of the states of n corners; the heap has the fields that those of ``cones`` have.

    Attributes
    ----------
    length : (2 n,)
        Length of the shortest path found to each state [cells]; inf where none is found yet.
    before : (2 n,) int32
        State before each state on that path; NONE (-1) where the path comes from its start.
    estimate : (2 n,)
        Estimate of each state when it was pushed on the heap last.
    estimates, heap : (rows,)
        Binary heap of states, the least estimate first; a state may be in it several times.
    sizes : (4,) int64
        Number of entries in the heap, in the entry ``N_OPEN``.

    """

    length: Floats
    before: NDArray[np.int32]
    estimate: Floats
    estimates: Floats
    heap: NDArray[np.int64]
    sizes: NDArray[np.int64]


@kernel
def make_labels(edges):
    """Return labels without a path yet."""
    n_states = len(edges.first) - 1
    # Every edge, and every visible corner of a start, can push a state.
    rows = len(edges.to) + 2 * n_states + 2
    return Labels(
        np.full(n_states, np.inf),
        np.empty(n_states, dtype=np.int32),
        np.empty(n_states),
        np.empty(rows),
        np.empty(rows, dtype=np.int64),
        np.zeros(4, dtype=np.int64),
    )


@inlined
def set_label(labels, state, before, length, estimate):
    """Store the path to a state over the state ``before``, and push the state on the heap."""
    labels.length[state], labels.before[state] = length, before
    labels.estimate[state] = estimate
    push(labels, estimate, state)


@inlined
def pop_state(labels):
    """Remove and return the state of the least estimate; NONE (-1) where the heap is empty."""
    while labels.sizes[N_OPEN] > 0:
        estimate, state = labels.estimates[0], labels.heap[0]
        pop(labels)
        if estimate == labels.estimate[state]:  # else a shorter path to it was found later
            return state
    return NONE


@inlined
def end_of_taut(places, edges, state, dx, dy):
    """
    Return the index after the last edge of a state that continues a path of direction (dx, dy).

    All earlier edges of the state continue it too. A direction of (0, 0) continues everywhere.
    """
    corner, turn = state // 2, turn_of(places, state)
    low, high = edges.first[state], edges.first[state + 1]
    while low < high:
        middle = (low + high) // 2
        other = edges.to[middle] // 2
        ahead_x, ahead_y = (
            places[other, X] - places[corner, X],
            places[other, Y] - places[corner, Y],
        )
        if turn * cross(dx, dy, ahead_x, ahead_y) < -STRAIGHT:
            high = middle
        else:
            low = middle + 1
    return low
