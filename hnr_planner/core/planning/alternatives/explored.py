"""
Rough paths of many homology classes in any plane space, from samples.

Searches from the start over uniform points to the goal explore the whole component, through narrow
doors too. Their paths and further uniform points make a graph of points with free segments between
them. In it the shortest paths of different homology classes are found. A class whose way no sample
found is missing.
"""

from itertools import pairwise

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.planning.alternatives.class_graph import (
    class_graph,
    ClassGraph,
    GOAL,
    near_edges,
    shortest_classes,
    START,
)
from hnr_planner.core.planning.homology import Islands
from hnr_planner.core.planning.limits import Budget, run
from hnr_planner.core.planning.planner import Work
from hnr_planner.core.planning.planners.auto import Auto
from hnr_planner.core.planning.planners.rrt import draw_in_box
from hnr_planner.core.planning.postprocessing.simplify import skip_vertices
from hnr_planner.core.planning.request import Request
from hnr_planner.core.planning.result import PlannerStatus
from hnr_planner.core.spaces.primitives import component
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
#: Purpose of random streams, beside those of ``plan`` and of shortening.
EXPLORE = 2


def rough_paths(
    request: Request, path: Floats, islands: Islands, n_classes: int, budget: Budget
) -> tuple[list[Floats], Work]:
    """
    Return free paths of different classes with the ends of ``path`` (m, 2), and the work.

    All paths are in the caller's frame. There are at most ``n_classes``.
    """
    graph, work = _explore(request, path, budget)
    if budget.stop() is not None:
        return [], work
    paths = []
    for points in shortest_classes(graph, islands, n_classes):
        rough = request.space.from_kernel(points)
        rough[0], rough[-1] = path[0], path[-1]
        if request.space.is_path_free(rough):
            paths.append(rough)
    return paths, work


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
