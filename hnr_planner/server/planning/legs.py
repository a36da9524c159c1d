"""
Legs of a request: one search from each pose to the next, on one map.

A request without poses on the way has one leg. The search of a leg is ``plan``, or
``plan_trajectory`` for a robot with inertia; its result becomes a ``PlanResponse``.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

from hnr_planner.core import (
    plan,
    PlannerStatus,
    PlanResult,
    PoseSpace,
    RequestError,
)
from hnr_planner.core.planning.planner import Planner
from hnr_planner.server.geometry.orientations import quaternion_of
from hnr_planner.server.map.map_store import MapSnapshot
from hnr_planner.server.parameters.arguments import (
    plan_arguments,
)
from hnr_planner.server.parameters.settings import Settings
from hnr_planner.server.planning.pose_legs import plan_pose_leg
from hnr_planner.server.planning.stop_order import in_short_order
from hnr_planner.server.planning.trajectory_legs import plan_trajectory_leg
from hnr_planner.server.planning.waypoints import joined
from hnr_planner.server.planning.zone_exits import led_out, zone_exit
from hnr_planner.server.requests.limits import RequestLimits
from hnr_planner.server.requests.outcomes import Outcome, Refusal
from hnr_planner.server.requests.plan_request import PlanRequest, Pose
from hnr_planner.server.requests.times import Times
from hnr_planner.server.responses.plan_response import PlanResponse
from hnr_planner.server.routes.keep_route import keep_route
from hnr_planner.server.routes.last_routes import Route

PlannerFor = Callable[[str, MapSnapshot], str | Planner]
LastRouteOf = Callable[[PlanRequest], Route | None]


@dataclass(frozen=True)
class LegPlanner:
    """
    Planner of the legs of one request.

    Attributes
    ----------
    settings : Settings
        The parameters in force.
    limits : RequestLimits
        Limits on all legs together.
    times : Times
        Times of the phases of the request, to which planning adds.
    planner_for : callable
        Returns the planner for the name of an algorithm and a map.
    last_route : callable
        Returns the last route to the goal of a request, or None.

    """

    settings: Settings
    limits: RequestLimits
    times: Times
    planner_for: PlannerFor
    last_route: LastRouteOf

    def plan(self, request: PlanRequest, snapshot: MapSnapshot) -> PlanResponse:
        """
        Plan one leg from each pose to the next, on one map, and return them joined.

        Each leg starts where the leg before it ended. The first leg that fails ends the work, and
        ``why`` names it: its response is returned, or with ``allow_partial_planning`` and after a
        leg that did not fail, those of the legs before it, with the last pose reached as the goal.
        """
        if not request.via:
            return self._plan(request, snapshot)
        request, order = self._ordered(request, snapshot)
        in_order = f'poses in the order {", ".join(map(str, order))}; ' if order else ''
        legs: list[PlanResponse] = []
        start, ends = request.start, (*request.via, request.goal)
        for number, end in enumerate(ends, 1):
            leg = self._plan(replace(request, start=start, via=(), goal=end), snapshot, n_paths=1)
            if not leg.solved:
                failed = f'{in_order}leg {number} of {len(ends)}: {leg.why}'
                partial = self.settings.allow_partial_planning and not self.limits.cancel.is_set()
                if not (partial and legs):
                    return replace(leg, why=failed)
                why = f'the path ends at pose {number - 1} on the way, as allowed, since {failed}'
                request = replace(request, via=ends[: number - 2], goal=ends[number - 2])
                return replace(self._joined(request, legs), why=why, n_reached=len(legs))
            legs.append(leg)
            start = _reached(leg, end)
        response = self._joined(request, legs)
        return replace(response, why=in_order + response.why)

    @staticmethod
    def _joined(request: PlanRequest, legs: list[PlanResponse]) -> PlanResponse:
        """Return the responses to solved legs as the response to ``request``."""
        result = joined([leg.result for leg in legs if isinstance(leg.result, PlanResult)])
        why = '; '.join(f'leg {number}: {leg.why}' for number, leg in enumerate(legs, 1))
        return replace(legs[0], why=why, request=request, result=result)

    def _ordered(
        self, request: PlanRequest, snapshot: MapSnapshot
    ) -> tuple[PlanRequest, list[int]]:
        """
        Return the request with its poses in a short order, and that order, where it may be any.

        Without the parameter ``any_order`` it is the request as it came, and an empty list.
        """
        as_it_came: tuple[PlanRequest, list[int]] = request, []
        if not self.settings.any_order:
            return as_it_came
        return self.limits.within(
            lambda: in_short_order(
                request,
                snapshot.space,
                self.settings.escape_radius,
                self.limits.time_left,
                self.limits.cancel,
            ),
            as_it_came,
        )

    def _plan(
        self, request: PlanRequest, snapshot: MapSnapshot, n_paths: int | None = None
    ) -> PlanResponse:
        """
        Plan from the start to the goal on one map; the poses of ``via`` are not looked at.

        ``n_paths`` is the number of alternatives, by default that of the parameters.
        """
        try:
            if snapshot.pose_space is not None:
                return self._plan_poses(request, snapshot, snapshot.pose_space)
            if request.has_inertia:
                return plan_trajectory_leg(
                    request, snapshot, self.settings, self.limits, self.times.add_planning
                )
            return self._plan_path(request, snapshot, n_paths)
        except RequestError as error:
            raise Refusal(Outcome.BAD_REQUEST, str(error)) from error

    def _plan_path(
        self, request: PlanRequest, snapshot: MapSnapshot, n_paths: int | None
    ) -> PlanResponse:
        """Plan for a robot that is a circle and has no inertia."""
        arguments = plan_arguments(self.settings)
        if n_paths is not None:
            arguments['alternatives'] = n_paths
        start, exit_point = request.start.point, zone_exit(request, snapshot)
        result = plan(
            snapshot.space,
            start if exit_point is None else exit_point,
            request.goal.point,
            algorithm=self.planner_for(request.algorithm, snapshot),
            goal_tolerance=request.tolerance,
            time_limit=self.limits.time_left,
            cancel=self.limits.cancel,
            **arguments,
        )
        self.times.add_planning(result)
        if exit_point is not None:
            result = led_out(result, start, exit_point)
        with self.times.phase('shortening'):
            result, route = keep_route(
                result, self.last_route(request), snapshot.space, self.settings, self.limits
            )
        return PlanResponse(
            Outcome[result.status.name],
            result.message + _about_zones(request, snapshot, result),
            request,
            result,
            escape=result.escape,
            route=route,
            snapshot=snapshot,
        )

    def _plan_poses(
        self, request: PlanRequest, snapshot: MapSnapshot, space: PoseSpace
    ) -> PlanResponse:
        """Plan for a robot with a footprint."""
        result = plan_pose_leg(
            request, snapshot, space, self.settings, self.limits, self.times.add_planning
        )
        outcome = Outcome[result.status.name]
        return PlanResponse(outcome, result.message, request, result, snapshot=snapshot)


def _reached(leg: PlanResponse, end: Pose) -> Pose:
    """Return where a solved leg to the pose ``end`` has ended: the start of the next leg."""
    x, y, *heading = leg.path[-1].tolist()
    reached = replace(end, position=(x, y, 0.0))
    return replace(reached, orientation=quaternion_of(heading[0])) if heading else reached


def _about_zones(request: PlanRequest, snapshot: MapSnapshot, result: PlanResult) -> str:
    """Return what keepout zones have to do with a result, as the end of its message."""
    ends = {
        PlannerStatus.INVALID_START: ('start', request.start),
        PlannerStatus.INVALID_GOAL: ('goal', request.goal),
    }
    if result.status in ends:
        name, pose = ends[result.status]
        return f'; the {name} is in a keepout zone' if snapshot.is_in_zone(pose.point) else ''
    return ''
