"""The order of the poses of a request that may be taken in any order."""

from dataclasses import replace

from hnr_planner.core import GridSpace, tour
from hnr_planner.core.cancellation import Event
from hnr_planner.core.planning.escape import escape_point
from hnr_planner.server.requests.plan_request import PlanRequest
import numpy as np
from numpy.typing import NDArray


def in_short_order(
    request: PlanRequest,
    space: GridSpace,
    escape_radius: float,
    time_limit: float,
    cancel: Event | None,
) -> tuple[PlanRequest, list[int]]:
    """
    Return the request with its poses after the start in the order of a short tour, and that order.

    Poses are numbered from 1, the goal last. The poses keep the order that they have, and the list
    is empty, where there is one pose only, where a pose is not free and may not be moved, where
    one cannot be reached, or where the limit passes.

    Parameters
    ----------
    request : PlanRequest
        The request, in the frame of the map.
    space : GridSpace
        The free space of the robot.
    escape_radius : float
        Length of the longest way from a start that is not free to free space [m].
    time_limit : float
        Time for the work [s].
    cancel : Event or None
        Event that ends the work once the event is set.

    """
    poses = (*request.via, request.goal)
    stops = _free_stops(request, space, escape_radius)
    if stops is None or not request.via:
        return request, []
    found = tour(space, stops, time_limit=time_limit, cancel=cancel)
    if not np.isfinite(found.length):
        return request, []
    order = found.order[1:].tolist()
    *via, goal = (poses[number - 1] for number in order)
    return replace(request, via=tuple(via), goal=goal), order


def _free_stops(
    request: PlanRequest, space: GridSpace, escape_radius: float
) -> NDArray[np.float64] | None:
    """Return start and poses (k, 2) [m], moved as the search will move them; None if it cannot."""
    points = [np.array(pose.point) for _, pose in request.named_poses]
    start = points[0]
    if not space.contains(start):
        outside = escape_point(space, start, points[1], escape_radius)
        if outside is None:
            return None
        start = outside
    stops = [start]
    for point in points[1:]:
        reachable = point
        if not space.connected(start, point):
            nearest = space.nearest_reachable(start, point, request.tolerance)
            if nearest is None:
                return None
            reachable = nearest
        stops.append(reachable)
    return np.array(stops)
