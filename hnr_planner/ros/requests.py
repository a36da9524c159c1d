"""
What turns a request into an answer, without ROS: `answer(request, settings, newest_map, cancel)`.

Whatever happens, the caller gets a `Report`: the name of the outcome and why in words. A request
is checked, planned on the newest map, and the path is held against the map that is newest then.
"""

from collections.abc import Callable
from dataclasses import dataclass
import math
import threading
import time

from hnr_planner.core import HnrError, plan, PlannerStatus, PlanResult
from hnr_planner.ros.map_store import MapSnapshot
from hnr_planner.ros.orientations import normalised, Quaternion
from hnr_planner.ros.outcomes import Outcome, Refusal
from hnr_planner.ros.settings import Settings
import numpy as np
from numpy.typing import NDArray

NewestMap = Callable[[], MapSnapshot]
LEVEL: Quaternion = (0.0, 0.0, 0.0, 1.0)
SHORTEST_TIME = 1e-3
"""Time [s] that a second search gets at least, so that it can still prove a goal unreachable."""


@dataclass(frozen=True)
class Pose:
    """A pose as it was asked for; an empty frame means the map's."""

    position: tuple[float, float, float]
    orientation: Quaternion = LEVEL
    frame: str = ''

    @property
    def point(self) -> tuple[float, float]:
        """Return (x, y)."""
        return self.position[0], self.position[1]


@dataclass(frozen=True)
class Request:
    """A path is asked for; `tolerance` [m] is how far from a blocked goal it may end."""

    start: Pose
    goal: Pose
    tolerance: float
    algorithm: str

    @property
    def omits_start(self) -> bool:
        """Return whether the start looks like one that was left out."""
        return self.start.frame == '' and self.start.point == (0.0, 0.0)


@dataclass(frozen=True)
class Report:
    """
    The answer to a request.

    Parameters
    ----------
    outcome : Outcome
        The name of what happened.
    why : str
        The same in words, with the values.
    request : Request
        What was asked for.
    elapsed : float
        Time from the request to this report [s].
    snapshot : MapSnapshot, optional
        The map that the answer holds for; None when there was none.
    result : PlanResult, optional
        What the planner returned; None when nothing was planned.
    clearance : float
        Smallest distance between the path and an obstacle [m]; NaN without a path.

    """

    outcome: Outcome
    why: str
    request: Request
    elapsed: float
    snapshot: MapSnapshot | None = None
    result: PlanResult | None = None
    clearance: float = math.nan

    @property
    def solved(self) -> bool:
        """Return whether there is a path."""
        return self.outcome is Outcome.SOLVED

    @property
    def path(self) -> NDArray[np.float64]:
        """Return the vertices of the path, an array (m, 2); none unless solved."""
        if self.solved and self.result is not None:
            return self.result.path
        return np.empty((0, 2))

    @property
    def frame(self) -> str:
        """Return the map's frame, empty without a map."""
        return '' if self.snapshot is None else self.snapshot.frame

    @property
    def goal_orientation(self) -> Quaternion:
        """Return the orientation asked for at the goal, with norm 1."""
        return normalised(self.request.goal.orientation) or LEVEL

    @property
    def offset(self) -> float:
        """Return how far the path ends from the goal asked for [m]; NaN without a path."""
        if not self.solved:
            return math.nan
        return float(math.dist(self.path[-1], self.request.goal.point))


def answer(
    request: Request, settings: Settings, newest_map: NewestMap, cancel: threading.Event
) -> Report:
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

    """
    began = time.monotonic()
    snapshot, result, clearance = None, None, math.nan
    try:
        check_request(request)
        snapshot = newest_map()
        deadline = began + settings.time_limit
        snapshot, result, why = _plan_for_newest_map(
            request, settings, snapshot, newest_map, deadline, cancel
        )
        outcome = Outcome[result.status.name]
        if outcome is Outcome.SOLVED:
            clearance = float(snapshot.space.path_clearance(result.path))
    except Refusal as refusal:
        outcome, why = refusal.outcome, refusal.why
    elapsed = time.monotonic() - began
    return Report(outcome, why, request, elapsed, snapshot, result, clearance)


def check_request(request: Request) -> None:
    """Raise Refusal (BAD_REQUEST) when `request` makes no sense on any map."""
    for name, pose in (('start', request.start), ('goal', request.goal)):
        for part, numbers in (('position', pose.position), ('orientation', pose.orientation)):
            if not all(math.isfinite(number) for number in numbers):
                raise Refusal(
                    Outcome.BAD_REQUEST,
                    f'the {part} of the {name} must be finite, got {list(numbers)}',
                )
    if normalised(request.goal.orientation) is None:
        raise Refusal(
            Outcome.BAD_REQUEST,
            'the orientation of the goal must be a quaternion with a norm above 0, got '
            f'{list(request.goal.orientation)}',
        )
    if not 0.0 <= request.tolerance < math.inf:
        raise Refusal(
            Outcome.BAD_REQUEST,
            f'the tolerance must be finite and not negative, got {request.tolerance} m',
        )


def _check_frames(request: Request, map_frame: str) -> None:
    """Raise Refusal (BAD_FRAME) unless start and goal are in the map's frame."""
    for name, frame in (('start', request.start.frame), ('goal', request.goal.frame)):
        if frame not in ('', map_frame):
            raise Refusal(
                Outcome.BAD_FRAME,
                f"the {name} is in frame '{frame}', the map in '{map_frame}': send it in the "
                "map's frame or leave the frame empty",
            )


def _plan_for_newest_map(
    request: Request,
    settings: Settings,
    snapshot: MapSnapshot,
    newest_map: NewestMap,
    deadline: float,
    cancel: threading.Event,
) -> tuple[MapSnapshot, PlanResult, str]:
    """Plan on `snapshot`, and again for as long as a newer map blocks the path just found."""
    first = snapshot
    while True:
        result, why = _plan(request, settings, snapshot, deadline, cancel)
        if result.status is PlannerStatus.TIMEOUT and snapshot is not first:
            raise _map_changed(settings)
        if result.status is not PlannerStatus.SOLVED:
            return snapshot, result, why
        newer = newest_map()
        if newer.number == snapshot.number or _still_free(result.path, snapshot, newer):
            return newer, result, why
        if time.monotonic() >= deadline:
            raise _map_changed(settings)
        snapshot = newer


def _map_changed(settings: Settings) -> Refusal:
    """Return the refusal for a path that a newer map has blocked."""
    return Refusal(
        Outcome.MAP_CHANGED,
        'a newer map blocks the path that was found, and the time limit of '
        f'{settings.time_limit:g} s left no time to find another',
    )


def _still_free(path: NDArray[np.float64], found_on: MapSnapshot, newer: MapSnapshot) -> bool:
    """Return whether a path found on one map is a path on a newer one."""
    return newer.frame == found_on.frame and newer.space.first_blocked_segment(path) is None


def _plan(
    request: Request,
    settings: Settings,
    snapshot: MapSnapshot,
    deadline: float,
    cancel: threading.Event,
) -> tuple[PlanResult, str]:
    """
    Plan on one map, and say how it went.

    A goal that is free and reachable is never moved; one that is not gives way to the nearest
    point that the robot can reach within the tolerance, and the words say so.
    """
    _check_frames(request, snapshot.frame)
    start, goal = request.start.point, request.goal.point
    arguments = settings.plan_arguments | {'algorithm': request.algorithm, 'cancel': cancel}

    def search(end: tuple[float, float] | NDArray[np.float64]) -> PlanResult:
        left = max(deadline - time.monotonic(), SHORTEST_TIME)
        try:
            return plan(snapshot.space, start, end, time_limit=left, **arguments)
        except HnrError as error:
            raise Refusal(Outcome.BAD_REQUEST, str(error)) from error

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
    arguments['goal_radius'] = 0.0
    result = search(nearest)
    offset = math.dist(nearest, goal)
    return result, f'{result.message}; the goal was moved by {offset:.4g} m because {why}'
