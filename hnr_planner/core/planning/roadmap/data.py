"""Data of a roadmap."""

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
    All that a roadmap has computed of its space, kernel frame.

    Attributes
    ----------
    space : Space
    n_draws : int
        Slots; a space without free points fills none.
    age : int
        Number of times that it was built or repaired.
    draws : (k, dim)
        Uniform draws, one for each slot.
    rays : (k, N_RAYS, dim)
        Ends of Hit-and-Run steps from each draw.
    nodes : (n, dim)
        Corners of the space, a little off the obstacles.
    visibility : (n, n), guide_visibility (g, n)
        Which nodes are visible from the nodes, and from the first g draws.
    shortest_paths : ShortestPaths
        Between the nodes.
    exits : Exits
        Where shortest paths leave the first g draws.

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
    """Return the data of a space before a first draw."""
    none, no_pairs = np.empty((0, space.dim)), np.empty((0, 0), dtype=np.uint8)
    exits = exits_of(none, no_pairs.astype(bool), *space.kernel_bounds)
    rays = np.empty((0, N_RAYS, space.dim))
    return RoadmapData(space, 0, 0, none, rays, none, no_pairs, no_pairs, empty_paths(0), exits)
