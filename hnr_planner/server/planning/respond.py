"""
From a request to a response: ``respond(request, settings, newest_map, cancel)``.

A request is checked and planned on the newest map. If a newer map has come by the end of the
search, the path is checked on it and, where it is blocked, planned again. A request that is
refused gets a ``PlanResponse`` too; only an exception other than Refusal reaches the caller.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
import math
import threading
import time

from hnr_planner.core import PoseSpace
from hnr_planner.core.kernels.kernel import interpreted_calls
from hnr_planner.core.planning.escape import escape_point
from hnr_planner.core.planning.tiers import remark_since, tier_since
from hnr_planner.server.geometry.pose_motions import poses_on, rows_of
from hnr_planner.server.geometry.poses import MOST_POSES, pose_rows
from hnr_planner.server.map.map_store import MapSnapshot
from hnr_planner.server.map.waiting import NewestMap, wait_for_map
from hnr_planner.server.parameters.settings import Settings
from hnr_planner.server.planning.legs import LastRouteOf, LegPlanner, PlannerFor
from hnr_planner.server.planning.zone_exits import zone_exit
from hnr_planner.server.requests.limits import RequestLimits
from hnr_planner.server.requests.outcomes import Outcome, Refusal
from hnr_planner.server.requests.plan_request import check_request, PlanRequest, Pose
from hnr_planner.server.requests.times import Times
from hnr_planner.server.responses.plan_response import PlanResponse
from hnr_planner.server.validity.recheck import first_blocked
import numpy as np
from numpy.typing import NDArray

ToFrame = Callable[[Pose, str], Pose]

#: Time [s] that measuring the clearance of a path gets even when the time limit has passed.
MEASURING_TIME = 0.02

#: Most poses of a path, evenly along it, at which the clearance of a footprint is measured.
CLEARANCES_MAX = 200


def only_same_frame(pose: Pose, frame: str) -> Pose:
    """Return ``pose`` with ``frame`` filled in; raise Refusal (BAD_FRAME) if it names another."""
    if pose.frame not in ('', frame):
        raise Refusal(
            Outcome.BAD_FRAME,
            f"is in frame '{pose.frame}', the map in '{frame}': send it in the map's frame or "
            'leave the frame empty',
        )
    return replace(pose, frame=frame)


def planner_by_name(algorithm: str, _snapshot: MapSnapshot) -> str:
    """Return the name of the planner for an algorithm, which is the algorithm's own."""
    return algorithm


def no_last_route(_request: PlanRequest) -> None:
    """Return None: there is no last route."""


def respond(
    request: PlanRequest,
    settings: Settings,
    newest_map: NewestMap,
    cancel: threading.Event,
    to_frame: ToFrame = only_same_frame,
    arrived: float | None = None,
    planner_for: PlannerFor = planner_by_name,
    last_route: LastRouteOf = no_last_route,
) -> PlanResponse:
    """
    Plan for ``request`` and return a response that says how planning ended.

    The time limit of ``settings`` begins now, by the clock ``working_time``.

    Parameters
    ----------
    request : PlanRequest
        The request as it arrived, not checked yet.
    settings : Settings
        The parameters in force.
    newest_map : callable
        Returns the map in use, or raises Refusal; called again after the search.
    cancel : threading.Event
        Ends the work when it is set.
    to_frame : callable
        Transforms a pose into the frame whose name it is given, or raises Refusal (BAD_FRAME);
        the name of the pose is put before the words of the refusal.
    arrived : float, optional
        When the request arrived, by ``time.monotonic`` [s]; now when left out.
    planner_for : callable
        Returns the planner for the name of an algorithm and a map.
    last_route : callable
        Returns the last route to the goal of a request, or None.

    """
    arrived = time.monotonic() if arrived is None else arrived
    before, times = interpreted_calls(), Times()
    limits = RequestLimits.from_now(settings.time_limit, cancel)
    snapshot = None
    try:
        check_request(request)
        with times.phase('map'):
            snapshot = wait_for_map(newest_map, settings.patience, cancel)
        legs = LegPlanner(settings, limits, times, planner_for, last_route)
        job = _Job(settings, newest_map, to_frame, limits, times, legs)
        response = job.plan_for_newest_map(request, snapshot)
    except Refusal as refusal:
        why = refusal.why + (remark_since(before) if limits.must_end() else '')
        response = PlanResponse(refusal.outcome, why, request, snapshot=snapshot)
    elapsed = time.monotonic() - arrived
    return replace(response, elapsed=elapsed, times=times, tier=tier_since(before))


@dataclass(frozen=True)
class _Job:
    """
    The work for one request.

    ``limits`` hold for all its searches and checks together, which add to ``times``; ``legs``
    plans on one map.
    """

    settings: Settings
    newest_map: NewestMap
    to_frame: ToFrame
    limits: RequestLimits
    times: Times
    legs: LegPlanner

    def plan_for_newest_map(self, request: PlanRequest, snapshot: MapSnapshot) -> PlanResponse:
        """
        Plan on ``snapshot``, and anew on each newer map that blocks the path just found.

        When the time limit passes before a path is found that the newest map leaves free, raise
        Refusal (MAP_CHANGED).
        """
        first = snapshot
        while True:
            response = self.legs.plan(self._in_frame(request, snapshot.frame), snapshot)
            if response.outcome is Outcome.TIMEOUT and snapshot is not first:
                raise self._map_changed()
            if not response.solved:
                return response
            with self.times.phase('map'):
                newer = self.newest_map()
                same = newer.number == snapshot.number or self._is_still_free(response, newer)
            if same:
                with self.times.phase('message'):
                    return self._finished(replace(response, snapshot=newer), newer)
            if self.limits.time_is_up:
                raise self._map_changed()
            snapshot = newer

    def _finished(self, response: PlanResponse, snapshot: MapSnapshot) -> PlanResponse:
        """
        Return a solved response with its clearance and its poses added.

        A path of more than ``MOST_POSES`` vertices raises Refusal (ITERATION_LIMIT).
        """
        path, spacing = response.path, self.settings.pose_spacing
        space = snapshot.pose_space if response.has_footprint else None
        if len(path) > MOST_POSES:
            raise Refusal(
                Outcome.ITERATION_LIMIT,
                f'the path that was found has {len(path)} vertices, and no more than {MOST_POSES} '
                'are sent',
            )
        if spacing < 0.0:
            spacing = snapshot.occupancy.resolution
        if space is not None:
            poses = poses_on(*response.motions, spacing)
            clearance = self._clearance_of_poses(poses, space)
            return replace(response, clearance=clearance, poses=rows_of(poses))
        orientation = response.goal_orientation
        return replace(
            response,
            clearance=self._clearance(path, snapshot),
            poses=pose_rows(path, spacing, orientation),
            other_poses=tuple(
                pose_rows(other, spacing, orientation)
                for other in response.others
                if self._is_free(other, response.escape, snapshot)
            ),
        )

    def _clearance(self, path: NDArray[np.float64], snapshot: MapSnapshot) -> float:
        """Return the clearance of a path (m, 2) [m]; NaN where the limits leave no time for it."""
        space = snapshot.space
        return self.limits.within(
            lambda: float(space.path_clearance(path)), math.nan, MEASURING_TIME
        )

    def _clearance_of_poses(self, poses: NDArray[np.float64], space: PoseSpace) -> float:
        """Return the least clearance [m] of a footprint at poses (n, 3); NaN at a limit."""
        rows = np.unique(np.linspace(0, len(poses) - 1, CLEARANCES_MAX).astype(int))
        return self.limits.within(
            lambda: float(space.clearance(poses[rows]).min()), math.nan, MEASURING_TIME
        )

    def _is_still_free(self, response: PlanResponse, newer: MapSnapshot) -> bool:
        """Return whether a newer map leaves a path free; False when the limits cut the check."""
        return self.limits.within(lambda: _is_still_free(response, newer), False)

    def _is_free(self, path: NDArray[np.float64], escape: float, snapshot: MapSnapshot) -> bool:
        """Return whether a path (m, 2) [m] is free from its escape on; False at a limit."""
        free = path[1:] if escape > 0.0 else path
        return self.limits.within(
            lambda: snapshot.space.first_blocked_segment(free) is None, False, MEASURING_TIME
        )

    def _map_changed(self) -> Refusal:
        """Return the refusal (MAP_CHANGED) for a blocked path and no time left to find another."""
        return Refusal(
            Outcome.MAP_CHANGED,
            'a newer map blocks the path that was found, and the time limit of '
            f'{self.settings.time_limit:g} s left no time to find another',
        )

    def _in_frame(self, request: PlanRequest, frame: str) -> PlanRequest:
        """
        Return the request with all poses transformed to ``frame``, the frame of the map.

        Raise Refusal (BAD_FRAME), with the name of the pose, where one cannot be transformed.
        """

        def transform(name: str, pose: Pose) -> Pose:
            try:
                return self.to_frame(pose, frame)
            except Refusal as refusal:
                raise Refusal(refusal.outcome, f'the {name} {refusal.why}') from refusal

        with self.times.phase('map'):
            start, *via, goal = (transform(name, pose) for name, pose in request.named_poses)
        return replace(request, start=start, via=tuple(via), goal=goal)


def _is_still_free(response: PlanResponse, newer: MapSnapshot) -> bool:
    """
    Return whether the path of ``response`` is one on the map ``newer`` as well.

    It has to be free there, and a first segment out of a start that is not free has to lead to
    the same point as it would on ``newer``.
    """
    if response.has_footprint is (newer.poses is None):
        return False  # the footprint was changed meanwhile
    if first_blocked(response, response.frame, newer) is not None:
        return False
    # The way out of a blocked start must still be the shortest one.
    if response.escape == 0.0:
        return True
    start, goal = np.array(response.request.start.point), np.array(response.request.goal.point)
    exit_point = zone_exit(response.request, newer)
    if exit_point is not None:
        return np.array_equal(exit_point, response.path[1])
    outside = escape_point(newer.space, start, goal, 2.0 * response.escape)
    return outside is not None and np.array_equal(outside, response.path[1])
