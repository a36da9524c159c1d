"""The cells of a grid that keep a clearance from obstacles, as a grid of their own."""

from dataclasses import replace
import math
from weakref import WeakKeyDictionary

from hnr_planner.core.spaces.grid.fields import components, free_distance, inflate
from hnr_planner.core.spaces.grid.grid_space import GridSpace
from hnr_planner.core.spaces.grid.traversal import GridData
import numpy as np

#: The last clearance [m] asked for in each space that is still in use, and the result.
_made: WeakKeyDictionary[GridSpace, tuple[float, GridSpace]] = WeakKeyDictionary()


def kept_clear(space: GridSpace, clearance: float) -> GridSpace:
    """
    Return the space of the free cells that come nowhere nearer than ``clearance`` to an obstacle.

    Cells are squares, and obstacles the occupied cells before inflation, so every path in the
    result keeps the ``clearance`` [m] above 0. The result for the last clearance in each space is
    kept: its slabs take longer to make than a search in them.
    """
    last, known = _made.get(space, (0.0, space))
    if last == clearance:
        return known
    # Squares are as far apart as the centres of all cells around one of them are from the other.
    beside = inflate(space.occupied, math.sqrt(2.0))
    reach = clearance / space.resolution
    nearer = inflate(beside, math.sqrt(max(math.ceil(reach * reach - 1e-9) - 1, 0)))
    distance = free_distance(nearer | space.blocked)
    data = GridData(distance, components(np.asarray(distance > 0)))
    made = replace(space, data=data)
    _made[space] = clearance, made
    return made
