"""The planning server: admits each request, does its work and counts its response."""

from collections.abc import Callable
from contextlib import suppress
import threading
import traceback
from typing import TypeVar

from hnr_planner.core.planning.planner import Planner
from hnr_planner.server.map.map_store import MapSnapshot
from hnr_planner.server.map.roadmaps import Roadmaps
from hnr_planner.server.map.waiting import NewestMap
from hnr_planner.server.parameters.settings import Settings
from hnr_planner.server.planning.respond import respond, ToFrame
from hnr_planner.server.requests.outcomes import Outcome, Refusal
from hnr_planner.server.requests.plan_request import PlanRequest
from hnr_planner.server.requests.searches import RunningSearches
from hnr_planner.server.responses.plan_response import PlanResponse
from hnr_planner.server.responses.response import Response
from hnr_planner.server.responses.sample_response import SampleResponse
from hnr_planner.server.responses.statistics import Statistics
from hnr_planner.server.routes.last_routes import LastRoutes
from hnr_planner.server.sampling import draw

Some = TypeVar('Some', bound=Response)


class PlanningServer:
    """
    Responds to requests for paths and for draws; any number of threads may ask at once.

    Parameters
    ----------
    settings : callable
        Returns the parameters in force.
    newest_map : callable
        Returns the map in use, or raises Refusal.
    to_frame : callable
        Transforms a pose into the frame whose name it is given, or raises Refusal (BAD_FRAME).
    report_defect : callable
        Called with the traceback, as text, of any exception other than Refusal.

    """

    def __init__(
        self,
        settings: Callable[[], Settings],
        newest_map: NewestMap,
        to_frame: ToFrame,
        report_defect: Callable[[str], None],
    ) -> None:
        self._settings = settings
        self._newest_map = newest_map
        self._to_frame = to_frame
        self._report_defect = report_defect
        self.searches = RunningSearches()
        self.statistics = Statistics()
        self.roadmaps = Roadmaps(report_defect)
        self.last_routes = LastRoutes()

    def plan(
        self,
        request: PlanRequest,
        cancel: threading.Event | None = None,
        arrived: float | None = None,
    ) -> PlanResponse:
        """
        Return the response to ``request``; its search ends when ``cancel`` is set.

        ``arrived`` is when the request arrived, by ``time.monotonic`` [s]; now when left out.
        """
        settings, event = self._settings(), cancel or threading.Event()
        response = self._counted(
            event,
            lambda: respond(
                request,
                settings,
                self._newest_map,
                event,
                self._to_frame,
                arrived,
                self._planner_for,
                self.last_routes.of,
            ),
            lambda refusal: PlanResponse(refusal.outcome, refusal.why, request),
        )
        if response.solved and settings.keep_route > 0.0 and not response.request.via:
            self.last_routes.remember(response.request, response.path)
        return response

    def follow_map(self) -> None:
        """Keep a roadmap of the newest map if ``roadmap`` is set and no footprint; else none."""
        settings = self._settings()
        if not settings.roadmap or settings.vertices:
            self.roadmaps.forget()
            return
        with suppress(Refusal):
            self.roadmaps.follow(self._newest_map())

    def forget_map(self) -> None:
        """Forget the roadmap and the last routes."""
        self.roadmaps.forget()
        self.last_routes.forget()

    def _planner_for(self, algorithm: str, snapshot: MapSnapshot) -> str | Planner:
        """Return the roadmap of a map for the algorithm auto, if it is ready; else the name."""
        return (algorithm == 'auto' and self.roadmaps.of(snapshot)) or algorithm

    def sample(self) -> SampleResponse:
        """Draw points of the free space by the parameters in force, and return the response."""
        settings, event = self._settings(), threading.Event()
        return self._counted(
            event,
            lambda: draw(settings, self._newest_map, event),
            lambda refusal: SampleResponse(refusal.outcome, refusal.why, settings),
        )

    def _counted(
        self,
        cancel: threading.Event,
        work: Callable[[], Some],
        refused: Callable[[Refusal], Some],
    ) -> Some:
        """
        Return what ``work`` returns, and count it; a failure is returned, never raised.

        ``refused`` makes the response of a Refusal, or of INTERNAL_ERROR where ``work`` raises
        anything else. ``cancel`` is registered among the running searches meanwhile.
        """
        try:
            with self.searches.one(cancel):
                response = work()
        except Refusal as refusal:
            response = refused(refusal)
        except Exception as error:  # without a response the caller would wait for ever
            self._report_defect(traceback.format_exc())
            why = f'a defect of the planner, please report it: {error!r}'
            response = refused(Refusal(Outcome.INTERNAL_ERROR, why))
        self.statistics.count(response)
        return response
