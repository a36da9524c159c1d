"""``distances``: the lengths of the shortest paths between all pairs of points on a grid."""

import math

from hnr_planner.core.cancellation import Event
from hnr_planner.core.checks import Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.planning.batch.plan_many import check_grid, check_many, plan_many
from hnr_planner.core.planning.request import in_words
from hnr_planner.core.spaces.grid.grid_space import GridSpace
import numpy as np
from numpy.typing import ArrayLike


def distances(
    space: GridSpace,
    points: ArrayLike,
    *,
    time_limit: float = math.inf,
    cancel: Event | None = None,
    n_jobs: int | None = None,
) -> Floats:
    """
    Return the lengths (k, k) [m] of the shortest paths between all pairs of points on a grid.

    Parameters
    ----------
    space : GridSpace
        Where the paths have to be free.
    points : (k, 2)
        Free points, caller's frame [m].
    time_limit : float
        Seconds for the whole call; lengths that are not known by then are inf.
    cancel : threading.Event, optional
        Event that ends the call once the event is set, as the time limit does.
    n_jobs : int, optional
        Number of threads; as many as there are cores when left out.

    Returns
    -------
    (k, k) float64
        Symmetric; 0 on the diagonal, inf where no path exists.

    Raises
    ------
    RequestError
        When an argument is malformed, or a point is not free.

    """
    check_grid('distances', space)
    points = check_many('points', points)
    for row in np.flatnonzero(~np.asarray(space.contains(points), dtype=bool)):
        where = f'row {row} of points, {in_words(points[row])},'
        raise RequestError(f'{where} is {space.why_not_free(points[row])}')
    rows, columns = np.triu_indices(len(points), 1)
    batch = plan_many(
        space,
        points[rows],
        points[columns],
        time_limit=time_limit,
        cancel=cancel,
        n_jobs=n_jobs,
    )
    lengths = np.zeros((len(points), len(points)))
    lengths[rows, columns] = lengths[columns, rows] = batch.length
    return lengths
