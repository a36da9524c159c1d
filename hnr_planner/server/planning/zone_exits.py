"""Ways out of keepout zones: where a start inside one is led, and the path from there."""

from dataclasses import replace
import math

from hnr_planner.core import PlannerStatus, PlanResult
from hnr_planner.core.checks import Floats
from hnr_planner.core.planning.ends import led_from
from hnr_planner.server.map.keepout import nearest_exit
from hnr_planner.server.map.map_store import MapSnapshot
from hnr_planner.server.requests.plan_request import PlanRequest
import numpy as np


def zone_exit(request: PlanRequest, snapshot: MapSnapshot) -> Floats | None:
    """
    Return the free point (2,) [m] to which the start of a request is led out of a zone.

    It is None where the start is in no zone, or no straight segment leads out.
    """
    start, goal = np.array(request.start.point), np.array(request.goal.point)
    outside = snapshot.outside_zones
    if outside is None or not snapshot.is_in_zone(request.start.point):
        return None
    return nearest_exit(snapshot.space, outside, start, goal)


def led_out(result: PlanResult, start: tuple[float, float], exit_point: Floats) -> PlanResult:
    """
    Return the result of a search from ``exit_point`` (2,) [m] as one from ``start``.

    Where it is solved, all paths begin with the segment from the start, and the lengths include
    it; ``escape`` is its length. The message states the exit in any case.
    """
    escape = math.dist(start, exit_point)
    message = f'{result.message}; the start is in a keepout zone and was led out by {escape:.4g} m'
    result = replace(result, message=message)
    if result.status is not PlannerStatus.SOLVED:
        return result
    return led_from(result, np.array(start), escape)
