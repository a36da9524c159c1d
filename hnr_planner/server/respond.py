"""
What turns a request into an answer, without ROS: `answer(request, settings, newest_map, cancel)`.

Whatever happens, the caller gets a `PathReport`: the name of the outcome and why in words. A
request is checked, planned on the newest map, and the path is held against the map that is newest
then.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
import math
import threading
import time
from typing import Any

from hnr_planner.core import (
    HnrError,
    KINODYNAMIC_PLANNERS,
    plan,
    plan_trajectory,
    PlannerStatus,
)
from hnr_planner.core.planning.result import SearchResult
from hnr_planner.ros.messages.trajectories import as_path
from hnr_planner.server.escape import escape_point
from hnr_planner.server.map_store import MapSnapshot
from hnr_planner.server.outcomes import Outcome, Refusal
from hnr_planner.server.path_validity import first_blocked_pose
from hnr_planner.server.requests import check_request, PlanRequest, Pose
from hnr_planner.server.responses import PlanResponse
from hnr_planner.server.settings import Settings
from hnr_planner.server.waypoints import joined
import numpy as np

NewestMap = Callable[[], MapSnapshot]
ToFrame = Callable[[Pose, str], Pose]
SHORTEST_TIME = 1e-3
"""Time [s] that a second search gets at least, so that it can still prove a goal unreachable."""


def only_same_frame(pose: Pose, frame: str) -> Pose:
    """Return `pose` in `frame`, for those who know no transforms: in no other can it be."""
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
    Return the answer to `request`.

    Parameters
    ----------
    request : Request
        What is asked for, as it arrived.
    settings : Settings
        The parameters in force.
    newest_map : callable
        Returns the map in use, or raises Refusal; called again after the search.
    cancel : threading.Event
        Ends the search when it is set.
    to_frame : callable
        Brings a pose into a frame, or raises Refusal (BAD_FRAME) with words that follow on the
        name of the pose.

    """
    began = time.monotonic()
    snapshot = None
    try:
        check_request(request)
        snapshot = newest_map()
        job = _Job(settings, newest_map, cancel, to_frame, began + settings.time_limit)
        report = job.plan_for_newest_map(request, snapshot)
    except Refusal as refusal:
        report = PlanResponse(refusal.outcome, refusal.why, request, snapshot=snapshot)
    return replace(report, elapsed=time.monotonic() - began)


@dataclass(frozen=True)
class _Job:
    """The circumstances under which one request is answered."""

    settings: Settings
    newest_map: NewestMap
    cancel: threading.Event
    to_frame: ToFrame
    deadline: float

    def plan_for_newest_map(self, request: PlanRequest, snapshot: MapSnapshot) -> PlanResponse:
        """Plan on `snapshot`, and again for as long as a newer map blocks the path just found."""
        first = snapshot
        while True:
            report = self._plan_legs(self._in_frame(request, snapshot.frame), snapshot)
            if report.outcome is Outcome.TIMEOUT and snapshot is not first:
                raise self._map_changed()
            if not report.solved:
                return report
            newer = self.newest_map()
            if newer.number == snapshot.number or _still_holds(report, newer):
                clearance = float(newer.space.path_clearance(report.path))
                return replace(report, snapshot=newer, clearance=clearance)
            if time.monotonic() >= self.deadline:
                raise self._map_changed()
            snapshot = newer

    def _map_changed(self) -> Refusal:
        """Return the refusal for a path that a newer map has blocked."""
        return Refusal(
            Outcome.MAP_CHANGED,
            'a newer map blocks the path that was found, and the time limit of '
            f'{self.settings.time_limit:g} s left no time to find another',
        )

    def _in_frame(self, request: PlanRequest, frame: str) -> PlanRequest:
        """Return the request in the frame of the map, or raise Refusal (BAD_FRAME)."""

        def bring(name: str, pose: Pose) -> Pose:
            try:
                return self.to_frame(pose, frame)
            except Refusal as refusal:
                raise Refusal(refusal.outcome, f'the {name} {refusal.why}') from refusal

        start, *via, goal = (bring(name, pose) for name, pose in request.named_poses)
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
        result = joined([leg.result for leg in legs if leg.result is not None])
        why = '; '.join(f'leg {number}: {leg.why}' for number, leg in enumerate(legs, 1))
        return replace(legs[0], why=why, request=request, result=result)

    def _plan(self, request: PlanRequest, snapshot: MapSnapshot) -> PlanResponse:
        """
        Plan on one map.

        A start that is not free is led out by the shortest way within the escape radius, and the
        words say so; the path still begins where it was asked to.
        """
        start = request.start.point
        result, why = self._plan_from(start, request, snapshot)
        escape, radius = 0.0, self.settings.escape_radius
        escapes = radius > 0.0 and request.algorithm not in KINODYNAMIC_PLANNERS
        if result.status is PlannerStatus.INVALID_START and escapes:
            outside = escape_point(snapshot, start, request.goal.point, radius)
            if outside is None:
                why += f'; no straight way of {radius:g} m at most leads out of there'
            else:
                escape, blocked = math.dist(start, outside), why
                result, why = self._plan_from(outside, request, snapshot)
                result = _led_out(result, start, escape)
                why += f'; the start was led out by {escape:.4g} m because {blocked}'
        outcome = Outcome[result.status.name]
        return PlanResponse(outcome, why, request, result, escape=escape, snapshot=snapshot)

    def _plan_from(
        self, start: tuple[float, float] | np.ndarray, request: PlanRequest, snapshot: MapSnapshot
    ) -> tuple[SearchResult, str]:
        """
        Plan from a point, and say how it went.

        A goal that is free and reachable is never moved; one that is not gives way to the nearest
        point that the robot can reach within the tolerance, and the words say so.
        """
        goal = request.goal.point
        arguments = self.settings.plan_arguments | {'algorithm': request.algorithm}
        begin = np.array(start)
        kinodynamic = KINODYNAMIC_PLANNERS.get(request.algorithm)
        if kinodynamic is not None:
            arguments |= self.settings.motion_arguments(request.algorithm)
            begin = np.append(begin, (0.0, 0.0))  # at rest

        def search(end: tuple[float, float] | np.ndarray) -> SearchResult:
            left = max(self.deadline - time.monotonic(), SHORTEST_TIME)
            limits: dict[str, Any] = {'time_limit': left, 'cancel': self.cancel}
            try:
                if kinodynamic is None:
                    return plan(snapshot.space, begin, end, **limits, **arguments)
                result = plan_trajectory(
                    snapshot.space, start=begin, goal=end, **limits, **arguments
                )
            except HnrError as error:
                raise Refusal(Outcome.BAD_REQUEST, str(error)) from error
            if result.trajectory is None:
                return result
            return replace(result, path=as_path(result.trajectory, snapshot.space))

        result = search(goal)
        why = result.message
        if result.status not in (PlannerStatus.INVALID_GOAL, PlannerStatus.UNREACHABLE):
            return result, why
        if request.tolerance == 0.0:
            return result, why
        nearest = snapshot.space.nearest_reachable(start, goal, request.tolerance)
        if nearest is None:
            return result, f'{why}; nothing within {request.tolerance:g} m of it can be reached'
        # The end has been moved already: a region around it would move it once more.
        if kinodynamic is None or not kinodynamic.samples_goal:
            arguments['goal_radius'] = 0.0
        result = search(nearest)
        offset = math.dist(nearest, goal)
        return result, f'{result.message}; the goal was moved by {offset:.4g} m because {why}'


def _led_out(result: SearchResult, start: tuple[float, float], escape: float) -> SearchResult:
    """Return a result whose path, if any, begins with the way out of `start`."""
    if result.status is not PlannerStatus.SOLVED:
        return result
    path = np.vstack([np.array(start), result.path])
    return replace(result, path=path, length=result.length + escape)


def _still_holds(report: PlanResponse, newer: MapSnapshot) -> bool:
    """Return whether a path found on one map is a path on a newer one."""
    if first_blocked_pose(report.free_path, report.frame, newer) is not None:
        return False
    # The way out of a blocked start must still be the shortest one.
    if report.escape == 0.0:
        return True
    start, goal = report.request.start.point, report.request.goal.point
    outside = escape_point(newer, start, goal, 2.0 * report.escape)
    return outside is not None and np.array_equal(outside, report.path[1])
