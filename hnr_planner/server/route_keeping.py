"""The parameter ``keep_route``: the result of a search, or the last path where that is kept."""

from hnr_planner.core import GridSpace, PlannerStatus, PlanResult
from hnr_planner.core.kernels.streams import stream
from hnr_planner.core.planning.limits import Budget
from hnr_planner.core.planning.postprocessing.clearance import increase_clearance
from hnr_planner.core.planning.postprocessing.simplify import shorten
from hnr_planner.server.kept_route import Route, with_kept_route
from hnr_planner.server.limits import RequestLimits
from hnr_planner.server.route_class import detour, route_class
from hnr_planner.server.settings import Settings
import numpy as np
from numpy.typing import NDArray

Path = NDArray[np.float64]


def keep_route(
    result: PlanResult,
    last: Route | None,
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
    last : Route, optional
        The last route to the same goal; None where there is none.
    space : GridSpace
        Where the path has to be free.
    settings, limits
        The parameters in force, and the limits of the request.

    """
    ratio, seed = settings.keep_route, result.seed
    if ratio == 0.0 or result.status is not PlannerStatus.SOLVED:
        return result, ''
    exact = result.escape == result.goal_offset == settings.goal_radius == 0.0
    if last is None or not exact or not np.array_equal(last.path[-1], result.path[-1]):
        return result, 'new'

    rng = stream(seed)
    budget = Budget(limits.deadline, cancel=limits.cancel)

    def keep() -> tuple[PlanResult, str]:
        islands = last.landmarks.on(space)

        def around(path: Path) -> Path | None:
            way = detour(space, islands, path, limits.time_left, limits.cancel)
            if way is not None and settings.clearance > 0.0:
                way = increase_clearance(space, way, settings.clearance, budget, islands)
            return way

        def shortened(path: Path) -> Path:
            # Shortening would take away the clearance that the path has.
            if not settings.simplify or settings.clearance > 0.0:
                return path
            return shorten(space, path, rng, budget, islands=islands)

        return with_kept_route(
            result,
            last.path,
            space,
            ratio,
            lambda path: route_class(space, islands, path),
            around,
            shortened,
        )

    kept = limits.within(keep, None)
    return (result, 'new') if kept is None else kept
