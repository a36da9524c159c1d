"""
Find alternative paths, none of which can be deformed into another past an obstacle.

On a grid they are the shortest paths of the shortest homotopy classes, exactly and all of them.
With a clearance, each is then moved away from walls within its class. In other spaces rough paths
of different homology classes are found from samples, and each is shortened within its class.
"""

from dataclasses import replace
import math
from typing import NamedTuple

from hnr_planner.core.checks import check_count, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.clock import working_time
from hnr_planner.core.lengths import path_length
from hnr_planner.core.planning.alternatives.class_graph import is_simple
from hnr_planner.core.planning.alternatives.explored import EXPLORE, rough_paths
from hnr_planner.core.planning.alternatives.grid_classes import GridClasses, shortest_classes
from hnr_planner.core.planning.homology import Islands, islands_at, signature
from hnr_planner.core.planning.limits import Budget
from hnr_planner.core.planning.planner import Work
from hnr_planner.core.planning.postprocessing.clearance import increase_clearance
from hnr_planner.core.planning.postprocessing.simplify import shorten
from hnr_planner.core.planning.request import Request
from hnr_planner.core.planning.result import PlanResult, proof
from hnr_planner.core.spaces.grid.grid_space import GridSpace
from hnr_planner.core.spaces.space import Space
import numpy as np

#: Classes searched for each path requested where shortening or moving them off walls may change
#: their order.
CLASSES_PER_PATH = 2


def check_alternatives(space: Space, alternatives: int, simplify: bool) -> int:
    """
    Return the number of paths requested, or raise RequestError.

    More than one path needs a space with ``island_points``, and ``simplify``.
    """
    n_paths = check_count('alternatives', alternatives, 1)
    if n_paths > 1 and space.island_points is None:
        raise RequestError(
            f'alternatives must be 1 in a {type(space).__name__}, which does not compute '
            f'on which side of obstacles a path passes, got {n_paths}'
        )
    if n_paths > 1 and not simplify:
        raise RequestError(f'alternatives must be 1 when simplify is false, got {n_paths}')
    return n_paths


def with_alternatives(
    request: Request, result: PlanResult, n_paths: int, budget: Budget, began: float
) -> PlanResult:
    """
    Return the result of a solved request with up to ``n_paths`` paths of different classes.

    ``result`` is the result of ``plan`` with one path. ``began`` is the time at which the call
    began, on the clock of ``working_time`` [s].
    """
    found = _find(request, result.path, n_paths, budget)
    paths, work = found.paths, Work(result.iterations, result.counts).plus(found.work)
    lower_bound = max(result.lower_bound, found.lower_bound)
    lengths = ', '.join(f'{path_length(path):.6g}' for path in paths)
    of_first = proof(path_length(paths[0]), lower_bound, request.straight_length)
    return replace(
        result,
        message=f'{len(paths)} of {n_paths} paths, of {lengths} m, after {work.iterations} '
        f'transitions{found.proof}{of_first.replace(", ", ", the first ", 1)}',
        path=paths[0],
        others=tuple(paths[1:]),
        length=path_length(paths[0]),
        lower_bound=lower_bound,
        next_lower_bound=found.next_lower_bound,
        iterations=work.iterations,
        counts=work.counts,
        elapsed=working_time() - began,
        cut_by_time=budget.cut,
    )


class _Alternatives(NamedTuple):
    """
    Paths of different classes, and what is proved of them.

    Attributes
    ----------
    paths : list of (m, dim)
        The paths, caller's frame, the shortest first.
    work : Work
        Work of all searches.
    lower_bound, next_lower_bound : float
        Lower bounds on the length of all free paths from start to goal, and of the paths of all
        other classes [m]; 0 where nothing is proved, inf where there are no other classes.

    """

    paths: list[Floats]
    work: Work
    lower_bound: float = 0.0
    next_lower_bound: float = 0.0

    @property
    def proof(self) -> str:
        """What is proved of the paths, as part of a message."""
        if self.next_lower_bound == 0.0:
            return ''
        each = ', each the shortest that it can be deformed into, and '
        return each + ('there are no others' if self.has_all else 'no others are shorter')

    @property
    def has_all(self) -> bool:
        """Whether there is no path of another class."""
        return self.next_lower_bound == math.inf


def _find(request: Request, path: Floats, n_paths: int, budget: Budget) -> _Alternatives:
    """
    Find the shortest paths of up to ``n_paths`` classes with the ends of ``path`` (m, 2).

    ``path`` is in the caller's frame. A limit of the budget ends the search early, with the paths
    found so far, or with ``path``.
    """
    space = request.space
    if np.array_equal(path[0], path[-1]):
        return _Alternatives([path], Work(0, {}))
    if isinstance(space, GridSpace) and request.clearance == 0.0:
        return _exact(request, path, shortest_classes(space, path[0], path[-1], n_paths, budget))
    n_classes, islands = CLASSES_PER_PATH * n_paths, islands_at(np.asarray(space.island_points))
    if isinstance(space, GridSpace):
        classes = shortest_classes(space, path[0], path[-1], n_classes, budget)
        rough, work = classes.paths, Work(classes.n_labels, {})
    else:
        rough, work = rough_paths(request, path, islands, n_classes, budget)
    shortest = {signature(islands, space.to_kernel(path)): path}
    for number, each in enumerate(rough):
        if budget.stop() is not None:
            break
        improved = _improved(request, each, number, islands, budget)
        points = space.to_kernel(improved)
        if is_simple(points):
            among = signature(islands, points)
            shortest[among] = min(shortest.get(among, improved), improved, key=path_length)
    return _Alternatives(sorted(shortest.values(), key=path_length)[:n_paths], work)


def _exact(request: Request, path: Floats, classes: GridClasses) -> _Alternatives:
    """Return the shortest paths of classes of a grid, or ``path`` (m, 2) where none was found."""
    work = Work(classes.n_labels, {})
    if not classes.paths:
        return _Alternatives([path], work)
    # In a goal region other paths may end nearer to the start.
    lower_bound = classes.least_length if request.goal_radius == 0.0 else 0.0
    return _Alternatives(classes.paths, work, lower_bound, classes.lower_bound)


def _improved(
    request: Request, path: Floats, number: int, islands: Islands, budget: Budget
) -> Floats:
    """
    Return a path (k, 2) of the class of ``path`` (m, 2), shorter and off walls as requested.

    ``number`` selects the random stream. On a grid ``path`` is the shortest of its class already.
    """
    if not isinstance(request.space, GridSpace):
        rng = request.stream(number, EXPLORE, 0)
        path = shorten(request.space, path, rng, budget, islands=islands)
    if request.clearance > 0.0:
        path = increase_clearance(request.space, path, request.clearance, budget, islands)
    return path
