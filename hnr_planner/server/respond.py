"""
From a request to a response: ``respond(request, settings, newest_map, cancel)``.

A request is checked, planned on the newest map, and its path is checked on the map that is newest
then. Whatever happens, the caller gets a ``PlanResponse``.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
import math
import threading
import time

from hnr_planner.core import (
    plan,
    plan_trajectory,
    PlannerStatus,
    PlanResult,
    RequestError,
    TrajectoryResult,
)
from hnr_planner.core.kernels.kernel import interpreted_calls
from hnr_planner.core.planning.escape import escape_point
from hnr_planner.core.planning.tiers import remark_since, tier_since
from hnr_planner.server.limits import RequestLimits
from hnr_planner.server.map_store import MapSnapshot
from hnr_planner.server.outcomes import Outcome, Refusal
from hnr_planner.server.path_validity import first_blocked_pose
from hnr_planner.server.poses import MOST_POSES, pose_rows
from hnr_planner.server.requests import check_request, PlanRequest, Pose
from hnr_planner.server.responses import PlanResponse
from hnr_planner.server.settings import Settings
from hnr_planner.server.trajectories import trajectory_path
from hnr_planner.server.waiting import NewestMap, wait_for_map
from hnr_planner.server.waypoints import joined
import numpy as np
from numpy.typing import ArrayLike, NDArray

ToFrame = Callable[[Pose, str], Pose]

#: Time [s] that measuring the clearance of a path gets at least, even when the time is up.
MEASURING_TIME = 0.02


def only_same_frame(pose: Pose, frame: str) -> Pose:
    """Return ``pose`` in ``frame``, or raise Refusal (BAD_FRAME): no transforms are known."""
    if pose.frame not in ('', frame):
        raise Refusal(
            Outcome.BAD_FRAME,
            f"is in frame '{pose.frame}', the map in '{frame}': send it in the map's frame or "
            'leave the frame empty',
        )
    return replace(pose, frame=frame)


def respond(
    request: PlanRequest,
    settings: Settings,
    newest_map: NewestMap,
    cancel: threading.Event,
    to_frame: ToFrame = only_same_frame,
) -> PlanResponse:
    """
    Plan for ``request`` and return how that ended.

    Parameters
    ----------
    request : PlanRequest
        The request as it arrived.
    settings : Settings
        The parameters in force.
    newest_map : callable
        Returns the map in use, or raises Refusal; called again after the search.
    cancel : threading.Event
        Ends the work when it is set.
    to_frame : callable
        Transforms a pose into a frame, or raises Refusal (BAD_FRAME) with words that follow on
        the name of the pose.

    """
    began, before = time.monotonic(), interpreted_calls()
    limits = RequestLimits.from_now(settings.time_limit, cancel)
    snapshot = None
    try:
        check_request(request)
        snapshot = wait_for_map(newest_map, settings.patience, cancel)
        job = _Job(settings, newest_map, to_frame, limits)
        response = job.plan_for_newest_map(request, snapshot)
    except Refusal as refusal:
        why = refusal.why + (remark_since(before) if limits.hold() else '')
        response = PlanResponse(refusal.outcome, why, request, snapshot=snapshot)
    return replace(response, elapsed=time.monotonic() - began, tier=tier_since(before))


@dataclass(frozen=True)
class _Job:
    """The circumstances of one request; the limits are for all of it."""

    settings: Settings
    newest_map: NewestMap
    to_frame: ToFrame
    limits: RequestLimits

    def plan_for_newest_map(self, request: PlanRequest, snapshot: MapSnapshot) -> PlanResponse:
        """Plan on ``snapshot``, and again as long as a newer map blocks the path just found."""
        first = snapshot
        while True:
            response = self._plan_legs(self._in_frame(request, snapshot.frame), snapshot)
            if response.outcome is Outcome.TIMEOUT and snapshot is not first:
                raise self._map_changed()
            if not response.solved:
                return response
            newer = self.newest_map()
            if newer.number == snapshot.number or self._is_still_free(response, newer):
                return self._finished(replace(response, snapshot=newer), newer)
            if self.limits.time_is_up:
                raise self._map_changed()
            snapshot = newer

    def _finished(self, response: PlanResponse, snapshot: MapSnapshot) -> PlanResponse:
        """Return a solved response with its clearance and its poses."""
        path, spacing = response.path, self.settings.pose_spacing
        if len(path) > MOST_POSES:
            raise Refusal(
                Outcome.ITERATION_LIMIT,
                f'the path that was found has {len(path)} vertices, and no more than {MOST_POSES} '
                'are sent',
            )
        if spacing < 0.0:
            spacing = snapshot.occupancy.resolution
        return replace(
            response,
            clearance=self._clearance(path, snapshot),
            poses=pose_rows(path, spacing, response.goal_orientation),
        )

    def _clearance(self, path: NDArray[np.float64], snapshot: MapSnapshot) -> float:
        """Return the clearance of a path [m]; NaN where the limits leave no time to measure it."""
        space = snapshot.space
        return self.limits.within(
            lambda: float(space.path_clearance(path)), math.nan, MEASURING_TIME
        )

    def _is_still_free(self, response: PlanResponse, newer: MapSnapshot) -> bool:
        """Return whether a path found on one map is known to be one on a newer map."""
        return self.limits.within(lambda: _is_still_free(response, newer), False)

    def _map_changed(self) -> Refusal:
        """Return the refusal for a path that a newer map has blocked."""
        return Refusal(
            Outcome.MAP_CHANGED,
            'a newer map blocks the path that was found, and the time limit of '
            f'{self.settings.time_limit:g} s left no time to find another',
        )

    def _in_frame(self, request: PlanRequest, frame: str) -> PlanRequest:
        """Return the request in the frame of the map, or raise Refusal (BAD_FRAME)."""

        def transform(name: str, pose: Pose) -> Pose:
            try:
                return self.to_frame(pose, frame)
            except Refusal as refusal:
                raise Refusal(refusal.outcome, f'the {name} {refusal.why}') from refusal

        start, *via, goal = (transform(name, pose) for name, pose in request.named_poses)
        return replace(request, start=start, via=tuple(via), goal=goal)

    def _plan_legs(self, request: PlanRequest, snapshot: MapSnapshot) -> PlanResponse:
        """Plan on one map, from each pose to the next; a leg that fails ends it, in its name."""
        if not request.via:
            return self._plan(request, snapshot)
        legs: list[PlanResponse] = []
        start, ends = request.start, (*request.via, request.goal)
        for number, end in enumerate(ends, 1):
            leg = self._plan(replace(request, start=start, via=(), goal=end), snapshot)
            if not leg.solved:
                return replace(leg, why=f'leg {number} of {len(ends)}: {leg.why}')
            legs.append(leg)
            x, y = leg.path[-1].tolist()
            start = replace(end, position=(x, y, 0.0))
        result = joined([leg.result for leg in legs if isinstance(leg.result, PlanResult)])
        why = '; '.join(f'leg {number}: {leg.why}' for number, leg in enumerate(legs, 1))
        return replace(legs[0], why=why, request=request, result=result)

    def _plan(self, request: PlanRequest, snapshot: MapSnapshot) -> PlanResponse:
        """Plan on one map, from the start to the goal."""
        try:
            if request.has_inertia:
                return self._plan_trajectory(request, snapshot)
            result = plan(
                snapshot.space,
                request.start.point,
                request.goal.point,
                algorithm=request.algorithm,
                goal_tolerance=request.tolerance,
                time_limit=self.limits.time_left,
                cancel=self.limits.cancel,
                **self.settings.plan_arguments,
            )
        except RequestError as error:
            raise Refusal(Outcome.BAD_REQUEST, str(error)) from error
        return PlanResponse(
            Outcome[result.status.name],
            result.message,
            request,
            result,
            escape=result.escape,
            snapshot=snapshot,
        )

    def _plan_trajectory(self, request: PlanRequest, snapshot: MapSnapshot) -> PlanResponse:
        """
        Plan for a robot with inertia, at rest at the start.

        A goal that is blocked or unreachable gives way to the nearest point that the robot can
        reach within the tolerance; ``why`` states it.
        """
        goal = request.goal.point
        result = self._search_trajectory(request, snapshot, goal, moved=False)
        why = result.message
        missed = result.status in (PlannerStatus.INVALID_GOAL, PlannerStatus.UNREACHABLE)
        if missed and request.tolerance > 0.0:
            with self.limits.enforced():
                nearest = snapshot.space.nearest_reachable(
                    request.start.point, goal, request.tolerance
                )
            if nearest is None:
                why += f'; nothing within {request.tolerance:g} m of it can be reached'
            else:
                result = self._search_trajectory(request, snapshot, nearest, moved=True)
                offset = math.dist(nearest, goal)
                why = f'{result.message}; the goal was moved by {offset:.4g} m because {why}'
        outcome, trajectory = Outcome[result.status.name], result.trajectory
        if trajectory is not None:
            with self.limits.enforced():
                path = trajectory_path(trajectory, snapshot.space, self.limits.check)
            result = replace(result, path=path)
        return PlanResponse(
            outcome, why, request, result, trajectory=trajectory, snapshot=snapshot
        )

    def _search_trajectory(
        self, request: PlanRequest, snapshot: MapSnapshot, goal: ArrayLike, *, moved: bool
    ) -> TrajectoryResult:
        """Search a trajectory from the start of ``request`` to a point (2,) [m]."""
        return plan_trajectory(
            snapshot.space,
            self.settings.system,
            (*request.start.point, 0.0, 0.0),
            goal,
            algorithm=request.algorithm,
            time_limit=self.limits.time_left,
            cancel=self.limits.cancel,
            **self.settings.trajectory_arguments(request.algorithm, goal_is_moved=moved),
        )


def _is_still_free(response: PlanResponse, newer: MapSnapshot) -> bool:
    """Return whether a path found on one map is a path on a newer one."""
    if first_blocked_pose(response.free_path, response.frame, newer) is not None:
        return False
    # The way out of a blocked start must still be the shortest one.
    if response.escape == 0.0:
        return True
    start, goal = np.array(response.request.start.point), np.array(response.request.goal.point)
    outside = escape_point(newer.space, start, goal, 2.0 * response.escape)
    return outside is not None and np.array_equal(outside, response.path[1])
