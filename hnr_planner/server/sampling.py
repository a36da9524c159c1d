"""Requests for uniform draws (random points) of all free space of the map in use."""

from dataclasses import dataclass, replace
import threading
import time

from hnr_planner.core import Cancelled, FreeSpaceDraws, sample_free_space, SpaceError, StuckError
from hnr_planner.core.errors import Interrupted
from hnr_planner.core.kernels.clock import working_time
from hnr_planner.core.kernels.interruption import interruptible
from hnr_planner.core.kernels.kernel import interpreted_calls
from hnr_planner.core.planning.tiers import remark_since, tier_since
from hnr_planner.server.map.map_store import MapSnapshot
from hnr_planner.server.map.waiting import NewestMap, wait_for_map
from hnr_planner.server.parameters.arguments import sample_arguments
from hnr_planner.server.parameters.settings import Settings
from hnr_planner.server.requests.outcomes import Outcome, Refusal
from hnr_planner.server.responses.sample_response import SampleResponse


def draw(settings: Settings, newest_map: NewestMap, cancel: threading.Event) -> SampleResponse:
    """
    Draw all free space of the newest map uniformly, and return the draws or why there are none.

    The time limit of ``settings`` holds for all of it, by the clock ``working_time``. A refusal
    is not raised: it becomes the outcome of the response.

    Parameters
    ----------
    settings : Settings
        The parameters in force.
    newest_map : callable
        Returns the map in use, or raises Refusal.
    cancel : threading.Event
        Ends the work when it is set.

    """
    began, deadline = time.monotonic(), working_time() + settings.time_limit
    before, snapshot = interpreted_calls(), None
    try:
        snapshot = wait_for_map(newest_map, settings.patience, cancel)
        if snapshot.poses is not None:
            why = 'positions of a circle are drawn: footprint must be [], got '
            raise Refusal(Outcome.BAD_REQUEST, f'{why}{settings.footprint!r}')
        draws = _draw(settings, snapshot, _Ending(cancel, deadline))
        why = f'{_description(settings)} by {settings.sample_walk}, seed {draws.seed}'
        response = SampleResponse(Outcome.SAMPLED, why, settings, draws, snapshot=snapshot)
    except Refusal as refusal:
        is_cut = refusal.outcome in (Outcome.TIMEOUT, Outcome.CANCELLED)
        why = refusal.why + (remark_since(before) if is_cut else '')
        response = SampleResponse(refusal.outcome, why, settings, snapshot=snapshot)
    return replace(response, elapsed=time.monotonic() - began, tier=tier_since(before))


@dataclass(frozen=True)
class _Ending:
    """Event-like object: set once ``cancel`` is, or ``working_time()`` reaches ``deadline``."""

    cancel: threading.Event
    deadline: float

    def is_set(self) -> bool:
        return self.cancel.is_set() or working_time() >= self.deadline


def _draw(settings: Settings, snapshot: MapSnapshot, ending: _Ending) -> FreeSpaceDraws:
    """Return draws of ``snapshot``, or raise Refusal (BAD_REQUEST, CANCELLED, TIMEOUT)."""
    try:
        with interruptible(ending.is_set):
            return sample_free_space(snapshot.space, cancel=ending, **sample_arguments(settings))
    except SpaceError as error:
        raise Refusal(Outcome.BAD_REQUEST, f'nothing can be drawn of this map: {error}') from error
    except StuckError as error:
        raise Refusal(Outcome.BAD_REQUEST, str(error)) from error
    except (Cancelled, Interrupted) as error:
        if ending.cancel.is_set():
            raise Refusal(Outcome.CANCELLED, 'the sampling was cancelled') from error
        raise Refusal(
            Outcome.TIMEOUT,
            f'the time limit of {settings.time_limit:g} s passed before there were '
            f'{_description(settings)}',
        ) from error


def _description(settings: Settings) -> str:
    """Return in words how many draws ``settings`` ask for, and how many steps apart if not 1."""
    thin = settings.sample_thin
    return f'{settings.sample_count} draws' + (f', {thin} steps apart' if thin > 1 else '')
