"""``tour``: the order in which the sum of the shortest paths from stop to stop is least."""

import math
from typing import NamedTuple

from hnr_planner.core.cancellation import Event
from hnr_planner.core.checks import check_number
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.clock import working_time
from hnr_planner.core.planning.batch.distances import distances
from hnr_planner.core.planning.batch.order import length_in_order, shortest_order
from hnr_planner.core.planning.batch.plan_many import check_many
from hnr_planner.core.planning.limits import Budget
from hnr_planner.core.spaces.grid.grid_space import GridSpace
import numpy as np
from numpy.typing import ArrayLike, NDArray

#: Largest number of stops.
STOPS_MAX = 200


class Tour(NamedTuple):
    """
    An order of stops, and the length of the way through them.

    Attributes
    ----------
    order : (k,) int64
        Rows of the stops in the order of the tour; row 0 comes first.
    length : float
        Sum of the lengths of the shortest paths from stop to stop [m]; inf where a stop cannot be
        reached from the others. Then the order is that of the rows.

    """

    order: NDArray[np.int64]
    length: float


def tour(
    space: GridSpace,
    points: ArrayLike,
    *,
    closed: bool = False,
    time_limit: float = math.inf,
    cancel: Event | None = None,
    n_jobs: int | None = None,
) -> Tour:
    """
    Order stops on a grid, the first one fixed, so that the way through all of them is short.

    It is the shortest of all orders for at most 13 stops. For more it is the best that a search
    finds by exchanging parts of the order (``order``); the same stops give the same order.

    Parameters
    ----------
    space : GridSpace
        Where the paths have to be free.
    points : (k, 2)
        At most 200 free points, caller's frame [m]; the tour begins at the first one.
    closed : bool
        Whether the tour returns to the first stop; else it may end at any other.
    time_limit : float
        Seconds for the whole call. It ends with the best order by then, or as if a stop could not
        be reached where not all lengths are known yet.
    cancel : threading.Event, optional
        Event that ends the call once the event is set, as the time limit does.
    n_jobs : int, optional
        Number of threads; as many as there are cores when left out.

    Returns
    -------
    Tour
        The order, and its length.

    Raises
    ------
    RequestError
        When an argument is malformed, or a point is not free.

    """
    points = check_many('points', points)
    if not 0 < len(points) <= STOPS_MAX:
        raise RequestError(f'points must be 1 to {STOPS_MAX} stops, got {len(points)}')
    limit = check_number('time_limit', time_limit, 0.0)
    budget = Budget(working_time() + limit, cancel=cancel)
    lengths = distances(space, points, time_limit=limit, cancel=cancel, n_jobs=n_jobs)
    order = np.arange(len(points))
    if np.isfinite(lengths).all():
        order = shortest_order(lengths, closed=closed, budget=budget)
    return Tour(order, length_in_order(lengths, order, closed=closed))
