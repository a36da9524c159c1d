"""A monitor that checks the last path that was found on every map that comes after it."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
import threading

from hnr_planner.server.map.map_store import MapSnapshot
from hnr_planner.server.map.waiting import NewestMap
from hnr_planner.server.requests.outcomes import Outcome, Refusal
from hnr_planner.server.responses.plan_response import PlanResponse
from hnr_planner.server.validity.recheck import first_blocked


class PathMonitor:
    """
    Checks the last path on every newer map and reports each change of its validity.

    Parameters
    ----------
    newest_map : callable
        Returns the map in use, or raises Refusal.
    report : callable
        Called with (valid, why, changed) for each response and at each change of validity:
        whether there is a path and it is free; why that changed, empty where no map changed it;
        and, where a newer map blocks the path, the path's response with the outcome MAP_CHANGED
        and the place where it is blocked, else None.

    """

    def __init__(
        self, newest_map: NewestMap, report: Callable[[bool, str, PlanResponse | None], None]
    ) -> None:
        self._newest_map = newest_map
        self._report = report
        self._one_at_a_time = threading.Lock()
        self._response: PlanResponse | None = None
        self._frame, self._number = '', 0
        self._valid = False

    def follow(self, response: PlanResponse) -> None:
        """
        Check the path of ``response``, in the place of the path before, from now on.

        A response without a path ends the checks and is reported as not valid.
        """
        with self._one_at_a_time:
            # Kept without its map, which may be large and is soon out of date.
            self._response = replace(response, snapshot=None) if response.solved else None
            if response.snapshot is not None:
                self._frame, self._number = response.frame, response.snapshot.number
            self._set(response.solved)
        if response.solved:
            self.check()  # a map may have come since the path was found

    def forget(self) -> None:
        """End the checks of the path, if there is one, and report that it is not valid."""
        with self._one_at_a_time:
            if self._response is not None:
                self._response = None
                self._set(False)

    def check(self) -> None:
        """Check the path, if there is one, on the newest map, and report a change of validity."""
        with self._one_at_a_time:
            if self._response is not None:
                with suppress(Refusal):
                    self._check_on(self._newest_map(), self._response)

    def _check_on(self, newest: MapSnapshot, response: PlanResponse) -> None:
        if newest.number == self._number and self._valid:
            return
        blocked = first_blocked(response, self._frame, newest)
        if self._valid == (blocked is None):
            return
        if blocked is None:
            self._set(True, 'a newer map leaves the last path free again')
            return
        why = f'a newer map blocks the last path at {blocked}'
        changed = replace(
            response, outcome=Outcome.MAP_CHANGED, why=why, snapshot=newest, blocked=blocked
        )
        self._set(False, why, changed)

    def _set(self, valid: bool, why: str = '', changed: PlanResponse | None = None) -> None:
        self._valid = valid
        self._report(valid, why, changed)
