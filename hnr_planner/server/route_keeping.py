"""The parameter ``keep_route``: the result of a search, or the last path where that is kept."""

from hnr_planner.core import GridSpace, plan, PlannerStatus, PlanResult, simplify
from hnr_planner.server.kept_route import with_kept_route
from hnr_planner.server.limits import RequestLimits
from hnr_planner.server.settings import Settings
import numpy as np
from numpy.typing import NDArray

Path = NDArray[np.float64]

#: Number of further searches for a shorter path around what blocks the last one. The first finds
#: the shortest; a number, unlike a clock, gives the same path on a busy machine.
MENDING_SEARCHES = 1


def keep_route(
    result: PlanResult,
    last: Path | None,
    space: GridSpace,
    settings: Settings,
    limits: RequestLimits,
) -> tuple[PlanResult, str]:
    """
    Return the result to send, and where its path comes from: 'kept', 'mended' or 'new'.

    It is ``result``, and the origin is empty, where ``settings`` keep no route or nothing was
    found. A route is kept only where both paths have the ends that were requested.

    Parameters
    ----------
    result : PlanResult
        Result of a search that knew nothing of the last path.
    last : (m, 2), optional
        The last path to the same goal [m]; None where there is none.
    space : GridSpace
        Where the path has to be free.
    settings, limits
        The parameters in force, and the limits of the request.

    """
    ratio, seed = settings.keep_route, result.seed
    if ratio == 0.0 or result.status is not PlannerStatus.SOLVED:
        return result, ''
    exact = result.escape == result.goal_offset == settings.goal_radius == 0.0
    if last is None or not exact or not np.array_equal(last[-1], result.path[-1]):
        return result, 'new'

    def connect(start: Path, goal: Path) -> Path | None:
        between = plan(
            space,
            start,
            goal,
            seed=seed,
            optimize_iterations=MENDING_SEARCHES,
            time_limit=limits.time_left,
            cancel=limits.cancel,
        )
        return between.path if between.status is PlannerStatus.SOLVED else None

    def shorten(path: Path) -> Path:
        # Shortening would take away the clearance that the last path has.
        if not settings.simplify or settings.clearance > 0.0:
            return path
        return simplify(space, path, seed=seed, time_limit=limits.time_left)

    kept = limits.within(
        lambda: with_kept_route(result, last, space, ratio, connect, shorten), None
    )
    return (result, 'new') if kept is None else kept
