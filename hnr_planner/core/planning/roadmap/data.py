"""What a roadmap knows of its space."""

from dataclasses import dataclass

from hnr_planner.core.checks import Floats
from hnr_planner.core.planning.roadmap.exits import Exits, exits_of
from hnr_planner.core.planning.roadmap.visibility import no_ways, Sights, Ways
from hnr_planner.core.spaces.space import Space
import numpy as np

#: Looks around from each draw.
LOOKS = 32


@dataclass(frozen=True, eq=False)
class Knowledge:
    """
    What is known of a space, kernel frame.

    Attributes
    ----------
    space : Space
    n_draws : int
        Slots; a space without free points fills none.
    age : int
        How often it was mended.
    draws : (k, dim)
        Uniform draws, one for each slot.
    looks : (k, LOOKS, dim)
        Where Hit-and-Run steps from each led.
    nodes : (n, dim)
        Corners.
    sights : (n, n), guide_sights (g, n)
        Which nodes the nodes see, and the first g draws.
    ways : Ways
        Shortest ways between the nodes.
    exits : Exits
        Where shortest paths leave the first g draws.

    """

    space: Space
    n_draws: int
    age: int
    draws: Floats
    looks: Floats
    nodes: Floats
    sights: Sights
    guide_sights: Sights
    ways: Ways
    exits: Exits


def nothing_known(space: Space) -> Knowledge:
    """Return what is known of a space before a first draw."""
    none, no_sights = np.empty((0, space.dim)), np.empty((0, 0), dtype=np.uint8)
    exits = exits_of(none, no_sights.astype(bool), *space.kernel_bounds)
    looks = np.empty((0, LOOKS, space.dim))
    return Knowledge(space, 0, 0, none, looks, none, no_sights, no_sights, no_ways(0), exits)
