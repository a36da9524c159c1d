"""The shortest homotopy classes of paths between two points of a grid, by their shortest paths."""

from typing import NamedTuple
from weakref import WeakKeyDictionary

from hnr_planner.core.checks import Floats
from hnr_planner.core.lengths import path_length
from hnr_planner.core.planning.alternatives.taut_search import (
    begin,
    extend,
    N_FOUND,
    TautSearch,
    with_more_labels,
)
from hnr_planner.core.planning.limits import Budget
from hnr_planner.core.planning.planners.heap import N_OPEN
from hnr_planner.core.planning.planners.taut_path import step_aside
from hnr_planner.core.planning.roadmap.grid.corners import Corners, find_corners, STEP_X, X
from hnr_planner.core.planning.roadmap.grid.edges import Edges, scan
from hnr_planner.core.spaces.grid.grid_space import GridSpace
from hnr_planner.core.trees import rows_to
import numpy as np

#: Corners whose edges are scanned, and labels extended, between two checks of the budget.
CORNERS_AT_ONCE, LABELS_AT_ONCE = 64, 256
#: Largest number of labels extended for each class sought. On maps of buildings tens are needed.
LABELS_PER_CLASS = 2_000


class CornerGraph(NamedTuple):
    """The corners of a grid, and the edges between them of which taut paths consist."""

    corners: Corners
    edges: Edges


class GridClasses(NamedTuple):
    """
    The shortest homotopy classes of paths between two points of a grid.

    Attributes
    ----------
    paths : list of (m, 2)
        The shortest path of each class, caller's frame, the shortest class first.
    least_length : float
        Length of the shortest free path [m], without the margins at corners; 0 where no class was
        found.
    lower_bound : float
        Lower bound on the length of paths of all other classes [m]; inf where there are none.
    n_labels : int
        Number of beginnings of paths that were extended.

    """

    paths: list[Floats]
    least_length: float
    lower_bound: float
    n_labels: int


#: The graph of each space that is still in use: it takes longer to make than a search in it.
_graphs: WeakKeyDictionary[GridSpace, CornerGraph] = WeakKeyDictionary()


def corner_graph(space: GridSpace, budget: Budget) -> CornerGraph | None:
    """Return the graph of a grid, or None where a limit of the budget is met before it is made."""
    if space in _graphs:
        return _graphs[space]
    corners, counts, ends = find_corners(space.slabs), [], []
    n_corners = len(corners.ends)
    for rows in np.array_split(np.arange(n_corners), 1 + n_corners // CORNERS_AT_ONCE):
        if budget.stop() is not None:
            return None
        counts_of_rows, ends_of_rows, _, _ = scan(space.slabs, corners, rows)
        counts.append(counts_of_rows[:, 0])
        ends.append(ends_of_rows)
    first = np.concatenate([[0], np.cumsum(np.concatenate(counts))])
    _graphs[space] = CornerGraph(corners, Edges(first, np.concatenate(ends)))
    return _graphs[space]


def shortest_classes(
    space: GridSpace, start: Floats, goal: Floats, n_classes: int, budget: Budget
) -> GridClasses:
    """
    Find the ``n_classes`` shortest classes between two points (2,) of one component.

    Classes whose shortest path passes a point twice are left out. There are fewer where no more
    exist, or where a limit of the budget or on the labels is met; those found are then the
    shortest of all just the same.
    """
    graph = corner_graph(space, budget)
    if graph is None or budget.stop() is not None:
        return GridClasses([], 0.0, 0.0, 0)
    ends = space.to_kernel(np.array((start, goal)))
    search, n_labels = begin(space.slabs, *graph, *ends, n_classes), 0
    while not _is_over(search) and n_labels < LABELS_PER_CLASS * n_classes:
        if budget.stop() is not None:
            break
        extended = extend(*graph, search, LABELS_AT_ONCE)
        n_labels += extended
        if extended < LABELS_AT_ONCE and not _is_over(search):
            search = with_more_labels(search, len(search.states) + 1)
    bound = search.estimates[0] if search.sizes[N_OPEN] > 0 else np.inf
    paths: list[Floats] = []
    for label in search.found[: search.sizes[N_FOUND]]:
        path = _path(space, graph.corners, search, label)
        path[0], path[-1] = start, goal
        if not space.is_path_free(path):  # the caller's coordinates round it into an obstacle
            bound = search.lengths[label]
            break
        paths.append(path)
    paths.sort(key=path_length)  # the margins tell apart paths that are equally long
    least = search.lengths[search.found[0]] if paths else 0.0
    return GridClasses(paths, float(least * space.scale), float(bound * space.scale), n_labels)


def _is_over(search: TautSearch) -> bool:
    """Return whether all classes sought are found, or no other exists."""
    return bool(search.sizes[N_FOUND] == len(search.found) or search.sizes[N_OPEN] == 0)


def _path(space: GridSpace, corners: Corners, search: TautSearch, label: int) -> Floats:
    """Return the path (m, 2) of a label at the goal, caller's frame, off corners by the margin."""
    states = search.states[rows_to(search.parents, label)[:-1]]  # the last one is AT_GOAL
    places = corners.places[states // 2]
    beside = places[:, X:STEP_X] + space.margin * places[:, STEP_X:]
    points = np.concatenate([search.ends[:1], beside, search.ends[1:]])
    return space.from_kernel(step_aside(space.data, points, space.margin))
