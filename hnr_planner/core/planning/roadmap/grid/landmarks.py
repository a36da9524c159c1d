"""
Landmarks: corners from which the lengths of the shortest paths to all corners are known.

By the triangle inequality the difference of two points' distances from a landmark is a lower bound
on the distance between them. A search that uses these bounds visits little more than the path that
it finds. Source: Goldberg and Harrelson, "Computing the shortest path: A* search meets graph
theory", SODA 2005.
"""

import math

from hnr_planner.core.cancellation import Event, in_chunks
from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.planning.roadmap.grid.corners import (
    Corners,
    state_along,
    STEP_X,
    STEP_Y,
    X,
    Y,
)
from hnr_planner.core.planning.roadmap.grid.edges import Edges
from hnr_planner.core.planning.roadmap.grid.labels import (
    end_of_taut,
    make_labels,
    pop_state,
    set_label,
)
from hnr_planner.core.planning.roadmap.grid.sweep import make_sweep, see_in_quadrant
from hnr_planner.core.spaces.grid.slabs import Slabs
from hnr_planner.core.trees import NONE
import numpy as np
from numpy.typing import NDArray

#: Number of landmarks in each component of free space.
N_LANDMARKS = 8


def measure_landmarks(
    slabs: Slabs,
    corners: Corners,
    edges: Edges,
    last_edges: Edges,
    components: NDArray[np.int32],
    cancel: Event | None,
) -> Floats:
    """
    Return the distance (n, N_LANDMARKS) [cells] of each corner from each landmark.

    Each component of free space has its own landmarks; the next one is always the corner farthest
    from those before. ``components`` (n,) are the components that hold the corners.

    Raises
    ------
    Cancelled
        When ``cancel`` was set.

    """
    distances = np.empty((len(components), N_LANDMARKS))
    nearest = np.full(len(components), np.inf)
    for column in in_chunks(N_LANDMARKS, cancel, rows=1):
        by_component = np.lexsort((nearest, components))
        last = np.flatnonzero(np.diff(components[by_component], append=-1))
        sources = by_component[last]
        distances[:, column.start] = _distances_from(slabs, corners, edges, last_edges, sources)
        nearest = np.minimum(nearest, distances[:, column.start])
    return distances


@kernel
def _distances_from(slabs, corners, edges, last_edges, sources):
    """
    Return the distance (n,) of each corner from the one of ``sources`` (k,) in its component.

    Dijkstra's algorithm (1959) over the states, and from each state over its last edges.
    """
    slabs, corners, sources = borrowed(slabs), borrowed(corners), borrowed(sources)
    edges, last_edges, places = borrowed(edges), borrowed(last_edges), borrowed(corners.places)
    labels, sweep = make_labels(edges), make_sweep(corners)
    distances = np.full(len(places), np.inf)
    for source in sources:
        distances[source] = 0.0
        for state in (2 * source, 2 * source + 1):
            set_label(labels, state, state, 0.0, 0.0)
        _leave_into_the_open(slabs, corners, source, labels, sweep, distances)
    state = pop_state(labels)
    while state != NONE:
        corner, before, length = state // 2, labels.before[state] // 2, labels.length[state]
        x, y = places[corner, X], places[corner, Y]
        dx, dy = x - places[before, X], y - places[before, Y]
        distances[corner] = min(distances[corner], length)
        for k in range(edges.first[state], end_of_taut(places, edges, state, dx, dy)):
            other = edges.to[k]
            further = length + _distance_to(places, other // 2, x, y)
            if further < labels.length[other]:
                set_label(labels, other, state, further, further)
        for k in range(last_edges.first[state], end_of_taut(places, last_edges, state, dx, dy)):
            other = last_edges.to[k] // 2
            distances[other] = min(distances[other], length + _distance_to(places, other, x, y))
        state = pop_state(labels)
    return distances


@kernel
def _leave_into_the_open(slabs, corners, source, labels, sweep, distances):
    """Label what is visible from a landmark in the quadrant across from its blocked cell."""
    places = corners.places
    x, y = places[source, X], places[source, Y]
    right, up = int(places[source, STEP_X]), int(places[source, STEP_Y])
    for k in range(see_in_quadrant(slabs, corners, source, right, up, sweep)):
        other = sweep.seen[k]
        length = _distance_to(places, other, x, y)
        distances[other] = min(distances[other], length)
        state = state_along(places, other, places[other, X] - x, places[other, Y] - y)
        if state != NONE and length < labels.length[state]:
            set_label(labels, state, 2 * source, length, length)


@kernel
def _distance_to(places, corner, x, y):
    """Return the straight distance from a corner to (x, y)."""
    dx, dy = places[corner, X] - x, places[corner, Y] - y
    return math.sqrt(dx * dx + dy * dy)
