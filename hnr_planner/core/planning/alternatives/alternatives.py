"""
Find alternative paths, none of which can be deformed into another past an obstacle.

Searches from the start over uniform points to the goal explore the whole component, through narrow
doors too. Their paths and further uniform points make a graph of points with free segments between
them. In it the shortest paths of different homology classes are found, and each is shortened
within its class.
"""

from dataclasses import replace
from itertools import pairwise

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
from hnr_planner.core.planning.homology import islands_at, signature
from hnr_planner.core.planning.limits import Budget, run
from hnr_planner.core.planning.planner import Work
from hnr_planner.core.planning.planners.auto import Auto
from hnr_planner.core.planning.planners.rrt import draw_in_box
from hnr_planner.core.planning.postprocessing.clearance import increase_clearance
from hnr_planner.core.planning.postprocessing.simplify import shorten, skip_vertices
from hnr_planner.core.planning.request import Request
from hnr_planner.core.planning.result import PlannerStatus, PlanResult
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
    paths, more_work = _find(request, result.path, n_paths, budget)
    work = Work(result.iterations, result.counts).plus(more_work)
    lengths = ', '.join(f'{path_length(path):.6g}' for path in paths)
    return replace(
        result,
        message=f'{len(paths)} of {n_paths} paths, of {lengths} m, after {work.iterations} '
        'transitions',
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
) -> tuple[list[Floats], Work]:
    """
    Find the shortest paths of up to ``n_paths`` homology classes with the ends of ``path`` (m, 2).

    ``path`` is in the caller's frame and takes part for its class, unless a shorter one is found
    in that class. A limit of the budget ends the search early, with the paths found so far.
    Returns the paths, caller's frame, the shortest first, and the work of all searches.
    """
    space = request.space
    if np.array_equal(path[0], path[-1]):
        return [path], Work(0, {})
    islands = islands_at(np.asarray(space.island_points))
    graph, work = _explore(request, path, budget)
    shortest = {signature(islands, space.to_kernel(path)): path}
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
        rng = request.stream(number, EXPLORE, 0)
        shortened = shorten(space, rough, rng, budget, islands=islands)
        if request.clearance > 0.0:
            shortened = increase_clearance(space, shortened, request.clearance, budget, islands)
        points = space.to_kernel(shortened)
        if is_simple(points):
            among = signature(islands, points)
            shortest[among] = min(shortest.get(among, shortened), shortened, key=path_length)
    return sorted(shortest.values(), key=path_length)[:n_paths], work


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
