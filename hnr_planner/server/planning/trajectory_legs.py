"""Legs of a request for a robot with inertia, which is at rest at the start."""

from collections.abc import Callable
from dataclasses import replace
import math

from hnr_planner.core import plan_trajectory, PlannerStatus, TrajectoryResult
from hnr_planner.core.checks import Floats
from hnr_planner.server.geometry.trajectories import trajectory_path
from hnr_planner.server.map.map_store import MapSnapshot
from hnr_planner.server.parameters.arguments import system_of, trajectory_arguments
from hnr_planner.server.parameters.settings import Settings
from hnr_planner.server.requests.limits import RequestLimits
from hnr_planner.server.requests.outcomes import Outcome
from hnr_planner.server.requests.plan_request import PlanRequest
from hnr_planner.server.responses.plan_response import PlanResponse
from numpy.typing import ArrayLike


def plan_trajectory_leg(
    request: PlanRequest,
    snapshot: MapSnapshot,
    settings: Settings,
    limits: RequestLimits,
    add_times: Callable[[TrajectoryResult], None],
) -> PlanResponse:
    """
    Plan for a robot with inertia, and turn a trajectory that is found into a path as well.

    Where the goal is blocked or unreachable and the tolerance is above 0, the search is repeated
    for the reachable point nearest the goal within the tolerance, if there is one; ``why`` of the
    response states this.

    Parameters
    ----------
    request : PlanRequest
        The request, in the map's frame; poses on the way are not looked at.
    snapshot : MapSnapshot
        The map to plan on.
    settings, limits
        The parameters in force, and the limits of the request.
    add_times : callable
        Called with the result of each search.

    """

    def search(goal: ArrayLike, *, moved: bool) -> TrajectoryResult:
        """Search a trajectory to ``goal`` (2,) [m], which ``moved`` says is not that requested."""
        result = plan_trajectory(
            snapshot.space,
            system_of(settings),
            (*request.start.point, 0.0, 0.0),
            goal,
            algorithm=request.algorithm,
            time_limit=limits.time_left,
            cancel=limits.cancel,
            **trajectory_arguments(settings, request.algorithm, goal_is_moved=moved),
        )
        add_times(result)
        return result

    result = search(request.goal.point, moved=False)
    why = result.message
    missed = result.status in (PlannerStatus.INVALID_GOAL, PlannerStatus.UNREACHABLE)
    if missed and request.tolerance > 0.0:
        nearest = _nearest_reachable(request, snapshot, limits)
        if nearest is None:
            why += f'; nothing within {request.tolerance:g} m of it can be reached'
        else:
            result = search(nearest, moved=True)
            offset = math.dist(nearest, request.goal.point)
            why = f'{result.message}; the goal was moved by {offset:.4g} m because {why}'
    trajectory = result.trajectory
    if trajectory is not None:
        with limits.enforced():
            path = trajectory_path(trajectory, snapshot.space, limits.check)
        result = replace(result, path=path)
    outcome = Outcome[result.status.name]
    return PlanResponse(outcome, why, request, result, trajectory=trajectory, snapshot=snapshot)


def _nearest_reachable(
    request: PlanRequest, snapshot: MapSnapshot, limits: RequestLimits
) -> Floats | None:
    """Return the reachable point (2,) [m] nearest the goal within the tolerance, or None."""
    with limits.enforced():
        return snapshot.space.nearest_reachable(
            request.start.point, request.goal.point, request.tolerance
        )
