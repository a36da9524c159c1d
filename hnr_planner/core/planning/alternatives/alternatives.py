"""
Find alternative paths, none of which can be deformed into another past an obstacle.

Searches from the start over uniform points to the goal explore the whole component, through narrow
doors too. Their paths and further uniform points make a graph of points with free segments between
them. In it the shortest paths of different homology classes are found, and each is shortened
within its class; on a grid to the shortest path that it can be deformed into, exactly.
"""

from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

from hnr_planner.core.checks import check_count, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.clock import working_time
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.lengths import path_length
from hnr_planner.core.planning.alternatives.class_graph import (
    class_graph,
    ClassGraph,
    GOAL,
    is_simple,
    near_edges,
    shortest_classes,
    START,
)
from hnr_planner.core.planning.alternatives.sleeve import shortest_in_class
from hnr_planner.core.planning.homology import Islands, islands_at, signature
from hnr_planner.core.planning.limits import Budget, run
from hnr_planner.core.planning.planner import Work
from hnr_planner.core.planning.planners.auto import Auto
from hnr_planner.core.planning.planners.rrt import draw_in_box
from hnr_planner.core.planning.postprocessing.clearance import increase_clearance
from hnr_planner.core.planning.postprocessing.simplify import shorten, skip_vertices
from hnr_planner.core.planning.request import Request
from hnr_planner.core.planning.result import PlannerStatus, PlanResult, proof
from hnr_planner.core.spaces.grid.grid_space import GridSpace
from hnr_planner.core.spaces.primitives import component
from hnr_planner.core.spaces.space import Space
import numpy as np

#: Number of uniform points in the graph, and of those with a search from start and goal; chosen
#: with the neighbours below for the shortest classes in little time on building maps.
N_POINTS, N_VIAS = 200, 16
#: Largest mean number of draws from the bounds for each point in the start's component.
DRAWS_FOR_A_POINT = 200
#: Nearest neighbours of each point of the graph to which segments are tested.
N_NEIGHBOURS = 20
#: Points whose neighbours are tested between two checks of the budget.
ROWS = 100
#: Classes searched for each path requested, since shortening may change their order.
CLASSES_PER_PATH = 2
#: Purpose of random streams, beside those of ``plan``.
EXPLORE = 2


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
    paths, are_shortest, more_work = _find(request, result.path, n_paths, budget)
    work = Work(result.iterations, result.counts).plus(more_work)
    lengths = ', '.join(f'{path_length(path):.6g}' for path in paths)
    return replace(
        result,
        message=f'{len(paths)} of {n_paths} paths, of {lengths} m, after {work.iterations} '
        f'transitions{_what_is_proved(request, result, paths, are_shortest)}',
        path=paths[0],
        others=tuple(paths[1:]),
        length=path_length(paths[0]),
        iterations=work.iterations,
        counts=work.counts,
        elapsed=working_time() - began,
        cut_by_time=budget.cut,
    )


def _find(
    request: Request, path: Floats, n_paths: int, budget: Budget
) -> tuple[list[Floats], bool, Work]:
    """
    Find the shortest paths of up to ``n_paths`` homology classes with the ends of ``path`` (m, 2).

    ``path`` is in the caller's frame and takes part for its class, unless a shorter one is found
    in that class. A limit of the budget ends the search early, with the paths found so far.
    Returns the paths, caller's frame, the shortest first; whether each is the shortest of those
    that it can be deformed into; and the work of all searches.
    """
    space = request.space
    if np.array_equal(path[0], path[-1]):
        return [path], False, Work(0, {})
    islands = islands_at(np.asarray(space.island_points))
    graph, work = _explore(request, path, budget)
    shortest = {signature(islands, space.to_kernel(path)): _taut(request, path)}
    found = (
        shortest_classes(graph, islands, CLASSES_PER_PATH * n_paths)
        if budget.stop() is None
        else []
    )
    for number, points in enumerate(found):
        rough = space.from_kernel(points)
        rough[0], rough[-1] = path[0], path[-1]
        if budget.stop() is not None or not space.is_path_free(rough):
            continue
        shortened = _shortened(request, rough, number, islands, budget)
        points = space.to_kernel(shortened.path)
        if is_simple(points):
            among = signature(islands, points)
            shortest[among] = min(shortest.get(among, shortened), shortened, key=_length)
    kept = sorted(shortest.values(), key=_length)[:n_paths]
    return [each.path for each in kept], all(each.is_shortest for each in kept), work


class _Found(NamedTuple):
    """A path (m, 2), caller's frame, and whether it can be deformed into no shorter one."""

    path: Floats
    is_shortest: bool


def _length(found: _Found) -> float:
    return float(path_length(found.path))


def _taut(request: Request, path: Floats) -> _Found:
    """Return the first path (m, 2), on a grid without a clearance the shortest of its class."""
    shortest = None if request.clearance > 0.0 else _shortest_in_class(request, path)
    return _Found(path, False) if shortest is None else _Found(shortest, True)


def _shortened(
    request: Request, path: Floats, number: int, islands: Islands, budget: Budget
) -> _Found:
    """
    Return a path (m, 2) shortened within its class, and moved away from walls as requested.

    ``number`` selects the random stream for spaces other than grids.
    """
    shorter, is_shortest = _shortest_in_class(request, path), True
    if shorter is None:
        rng, is_shortest = request.stream(number, EXPLORE, 0), False
        shorter = shorten(request.space, path, rng, budget, islands=islands)
    if request.clearance > 0.0:
        clearance, is_shortest = request.clearance, False
        shorter = increase_clearance(request.space, shorter, clearance, budget, islands)
    return _Found(shorter, is_shortest)


def _shortest_in_class(request: Request, path: Floats) -> Floats | None:
    """
    Return the shortest path (k, 2) that a free path (m, 2) of a grid can be deformed into.

    Both are in the caller's frame. None where the space is no grid, or the caller's coordinates
    round the path into an obstacle.
    """
    space = request.space
    if not isinstance(space, GridSpace):
        return None
    points, _ = shortest_in_class(space.data, space.slabs, space.to_kernel(path), space.margin)
    shortest = space.from_kernel(points)
    shortest[:1], shortest[-1:] = path[0], path[-1]
    return shortest if len(shortest) > 0 and space.is_path_free(shortest) else None


def _what_is_proved(
    request: Request, result: PlanResult, paths: list[Floats], are_shortest: bool
) -> str:
    """Return what is proved of the lengths of ``paths``, the shortest first, for a message."""
    of_first = proof(path_length(paths[0]), result.lower_bound, request.straight_length)
    each = ', each the shortest that it can be deformed into' if are_shortest else ''
    return each + of_first.replace(', ', ', the first ', 1)


def _explore(request: Request, path: Floats, budget: Budget) -> tuple[ClassGraph, Work]:
    """
    Return a graph of points of the start's component, and the work of the searches made for it.

    The points are those of ``path`` (m, 2), of searches from start to goal over uniform points,
    and the uniform points themselves. The component is the connected part of free space that
    holds the start.
    """
    paths = [request.space.to_kernel(path)]
    ends = paths[0][0], paths[0][-1]
    draws = np.empty((N_POINTS, request.space.dim))
    n_draws = _draw_points(request.problem, request.stream(0, EXPLORE, 1), draws)
    work = Work(0, {})
    for number, via in enumerate(draws[: min(N_VIAS, n_draws)]):
        halves = []
        for half, (a, b) in enumerate(pairwise((ends[0], via, ends[1]))):
            problem = request.problem._replace(start=a, goal=b, goal_radius=0.0)
            rng = request.stream(number, EXPLORE, 2, half)
            search = Auto().start(problem, rng)
            if run(search, budget) is PlannerStatus.SOLVED:
                halves.append(skip_vertices(request.space, search.path, budget)[0])
            work = work.plus(Work.of(search))
        if len(halves) == 2:
            paths.append(np.concatenate([halves[0], halves[1][1:]]))
    return _linked(request, paths, draws[:n_draws], budget), work


def _linked(request: Request, paths: list[Floats], others: Floats, budget: Budget) -> ClassGraph:
    """
    Return the graph of the vertices of ``paths`` and of ``others`` (k, 2), kernel frame.

    Its edges are the segments of the paths and, while the budget lasts, the free segments from
    each point to its ``N_NEIGHBOURS`` nearest points.
    """
    nodes, edges, n_nodes = [paths[0][[0, -1]]], [], 2
    for path in paths:
        inner = path[1:-1]
        row = np.concatenate([[START], np.arange(n_nodes, n_nodes + len(inner)), [GOAL]])
        edges += [row[:-1], row[1:]]
        nodes.append(inner)
        n_nodes += len(inner)
    points = np.concatenate([*nodes, others])
    along = np.stack([np.concatenate(edges[::2]), np.concatenate(edges[1::2])], axis=1)
    all_edges = [along]
    for rows in np.array_split(np.arange(len(points)), 1 + len(points) // ROWS):
        if budget.stop() is None:
            all_edges.append(near_edges(request.space.data, points, rows, N_NEIGHBOURS))
    return class_graph(points, np.concatenate(all_edges))


@kernel
def _draw_points(problem, rng, points):
    """
    Write uniform points of the start's component to ``points`` (k, dim); return their number.

    They are fewer than k where ``DRAWS_FOR_A_POINT`` draws for each point do not yield enough.
    """
    component_of_start, n_points = component(problem.space, problem.start), 0
    for _ in range(DRAWS_FOR_A_POINT * len(points)):
        if n_points == len(points):
            break
        draw_in_box(problem.lower, problem.upper, rng, points[n_points])
        if component(problem.space, points[n_points]) == component_of_start:
            n_points += 1
    return n_points
