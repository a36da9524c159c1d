"""Data of a roadmap: draws, rays, nodes, visibility, shortest paths and exits."""

from dataclasses import dataclass

from hnr_planner.core.checks import Floats
from hnr_planner.core.planning.roadmap.exits import Exits, exits_of
from hnr_planner.core.planning.roadmap.visibility import empty_paths, ShortestPaths, Visibility
from hnr_planner.core.spaces.space import Space
import numpy as np

#: Rays from each draw: Hit-and-Run steps.
N_RAYS = 32


@dataclass(frozen=True, eq=False)
class RoadmapData:
    """
    All data that a roadmap has computed for its space; points are in the kernel frame.

    Attributes
    ----------
    space : Space
        The space for which the data hold.
    n_draws : int
        Number of slots for draws; none is filled in a space without free points.
    age : int
        Number of times that the data were built, updated or grown.
    draws : (k, dim)
        Uniform points of free space, one for each slot.
    rays : (k, N_RAYS, dim)
        Ends of the ``N_RAYS`` Hit-and-Run steps from each draw.
    nodes : (n, dim)
        Corners of obstacles, moved a little into free space.
    visibility : (n, n), guide_visibility (g, n)
        Visibility (HIDDEN, VISIBLE or UNKNOWN) of the nodes, as columns, from each node, and from
        each of the first g draws, the *guides*.
    shortest_paths : ShortestPaths
        Shortest paths between the nodes.
    exits : Exits
        Nodes over which shortest paths leave each of the guides.

    """

    space: Space
    n_draws: int
    age: int
    draws: Floats
    rays: Floats
    nodes: Floats
    visibility: Visibility
    guide_visibility: Visibility
    shortest_paths: ShortestPaths
    exits: Exits


def empty_roadmap(space: Space) -> RoadmapData:
    """Return the data of a roadmap of ``space`` that has no draws and no nodes yet."""
    none, no_pairs = np.empty((0, space.dim)), np.empty((0, 0), dtype=np.uint8)
    exits = exits_of(none, no_pairs.astype(bool), *space.kernel_bounds)
    rays = np.empty((0, N_RAYS, space.dim))
    return RoadmapData(space, 0, 0, none, rays, none, no_pairs, no_pairs, empty_paths(0), exits)
