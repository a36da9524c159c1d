"""
Corners of a grid, where shortest paths bend, and the states in which a path can pass them.

A corner is a grid point at which exactly one of the four cells is blocked; it is one end of
exactly one portal between slabs. The step of a corner, entries +1 or -1, leads away from the
blocked cell to the cell across. A path is *tangent* to a corner where its line does not enter the
quadrant of the blocked cell. Then it moves in one of two quadrants: (step x, -step y), sense 0
around the obstacle, or (-step x, step y), sense 1. A shortest path that comes in one quadrant
leaves in the same quadrant, turned towards the obstacle if at all. So shortest paths are paths
over *states*, pairs of a corner and a sense; the number of a state is 2 corner + sense.
"""

from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.spaces.grid.slabs import LEFT, RIGHT, Slabs
from hnr_planner.core.trees import NONE
import numpy as np
from numpy.typing import NDArray

#: Columns of ``Corners.places``: the grid point, and the step away from the blocked cell.
X, Y, STEP_X, STEP_Y = range(4)


class Corners(NamedTuple):
    """
    The corners of a grid, ordered by height, then from left to right.

    Attributes
    ----------
    at : (n_portals, 2) int32
        Index of the corner at the left and right end of each portal, NONE (-1) where the end lies
        on a straight wall.
    ends : (n,) int32
        Number of the portal's end at each corner: 2 portal + side.
    places : (n, 4)
        Grid point and step of each corner, kernel frame; columns ``X`` to ``STEP_Y``.

    """

    at: NDArray[np.int32]
    ends: NDArray[np.int32]
    places: Floats


def find_corners(slabs: Slabs) -> Corners:
    """Return the corners of the grid that has these slabs."""
    is_corner = slabs.steps[:, :, 0] != 0
    portals, sides = np.nonzero(is_corner)
    at = np.full(is_corner.shape, NONE, dtype=np.int32)
    at[is_corner] = np.arange(len(portals))
    points = slabs.portals[portals, sides], slabs.portals[portals, 2]
    places = np.column_stack([*points, slabs.steps[portals, sides]]).astype(np.float64)
    return Corners(at, (2 * portals + sides).astype(np.int32), places)


@inlined
def state_along(places, corner, dx, dy):
    """
    Return the state in which a path of direction (dx, dy) passes a corner.

    It is NONE (-1) where the path is not tangent to the corner.
    """
    step_x, step_y = places[corner, STEP_X], places[corner, STEP_Y]
    if dx * dy * step_x * step_y > 0.0:
        return NONE
    return 2 * corner if dx * step_x - dy * step_y > 0.0 else 2 * corner + 1


@inlined
def turn_of(places, state):
    """Return the sense in which paths turn in a state: 1 counter-clockwise, -1 clockwise."""
    turn = places[state // 2, STEP_X] * places[state // 2, STEP_Y]
    return turn if state % 2 == 1 else -turn


@kernel
def corner_beside(slabs, corners, state):
    """
    Return the next corner that a path out of ``state`` along the horizontal grid line meets.

    It is NONE (-1) where a wall is met first.
    """
    portal, side = corners.ends[state // 2] // 2, corners.ends[state // 2] % 2
    if state % 2 == 0:
        return corners.at[portal, 1 - side]
    if slabs.steps[portal, side, 1] > 0:
        edge = slabs.below[slabs.portals[portal, 4]]
    else:
        edge = slabs.above[slabs.portals[portal, 3]]
    other = portal - 1 if side == LEFT else portal + 1
    if other < edge[0] or other >= edge[1]:
        return NONE
    return corners.at[other, RIGHT if side == LEFT else LEFT]
