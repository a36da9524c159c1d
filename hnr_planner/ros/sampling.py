"""
What draws the free space of the map, without ROS: `draw(settings, newest_map, cancel)`.

As with paths, whatever happens the caller gets a report: the name of the outcome, and why.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
import threading
import time

from hnr_planner.core import Cancelled, FreeSpaceDraws, sample_free_space, SpaceError, StuckError
from hnr_planner.ros.map_store import MapSnapshot
from hnr_planner.ros.outcomes import Outcome, Refusal
from hnr_planner.ros.settings import Settings
import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class SampleReport:
    """
    The answer to a request for draws.

    Parameters
    ----------
    outcome : Outcome
        The name of what happened.
    why : str
        The same in words, with the values.
    settings : Settings
        The parameters that said what to draw.
    elapsed : float
        Time from the request to this report [s].
    snapshot : MapSnapshot, optional
        The map that was drawn from; None when there was none.
    draws : FreeSpaceDraws, optional
        One chain of them; None after a failure.

    """

    outcome: Outcome
    why: str
    settings: Settings
    elapsed: float = 0.0
    snapshot: MapSnapshot | None = None
    draws: FreeSpaceDraws | None = None

    @property
    def frame(self) -> str:
        """Return the map's frame, empty without a map."""
        return '' if self.snapshot is None else self.snapshot.frame

    @property
    def points(self) -> NDArray[np.float64]:
        """Return the draws (n, 2); none after a failure."""
        return np.empty((0, 2)) if self.draws is None else self.draws.points[0]

    @property
    def n_parts(self) -> int:
        """Return how many connected parts of the free space the draws lie in."""
        return 0 if self.draws is None else len(np.unique(self.draws.parts))

    @property
    def parents(self) -> NDArray[np.intp]:
        """Return the index (n,) of the draw that each is one step away from; -1 for none."""
        if self.draws is None or self.settings.sample_thin > 1:
            return np.full(len(self.points), -1)
        return self.draws.previous[0]


def draw(
    settings: Settings, newest_map: Callable[[], MapSnapshot], cancel: threading.Event
) -> SampleReport:
    """
    Return uniform draws of all free space of the newest map, or why there are none.

    Parameters
    ----------
    settings : Settings
        The parameters in force.
    newest_map : callable
        Returns the map in use, or raises Refusal.
    cancel : threading.Event
        Ends the work when it is set.

    """
    began = time.monotonic()
    snapshot = None
    try:
        snapshot = newest_map()
        draws = _draw(settings, snapshot, _Ending(cancel, began + settings.time_limit))
        why = f'{_asked_for(settings)} by {settings.sample_walk}, seed {draws.seed}'
        report = SampleReport(Outcome.SAMPLED, why, settings, 0.0, snapshot, draws)
    except Refusal as refusal:
        report = SampleReport(refusal.outcome, refusal.why, settings, 0.0, snapshot)
    return replace(report, elapsed=time.monotonic() - began)


@dataclass(frozen=True)
class _Ending:
    """Set when the request is cancelled, or its time is up."""

    cancel: threading.Event
    deadline: float

    def is_set(self) -> bool:
        return self.cancel.is_set() or time.monotonic() >= self.deadline


def _draw(settings: Settings, snapshot: MapSnapshot, ending: _Ending) -> FreeSpaceDraws:
    """Return the draws, or raise Refusal (BAD_REQUEST, CANCELLED, TIMEOUT)."""
    try:
        return sample_free_space(snapshot.space, cancel=ending, **settings.sample_arguments)
    except SpaceError as error:
        raise Refusal(Outcome.BAD_REQUEST, f'nothing can be drawn of this map: {error}') from error
    except StuckError as error:
        raise Refusal(Outcome.BAD_REQUEST, str(error)) from error
    except Cancelled as error:
        if ending.cancel.is_set():
            raise Refusal(Outcome.CANCELLED, 'the sampling was cancelled') from error
        raise Refusal(
            Outcome.TIMEOUT,
            f'the time limit of {settings.time_limit:g} s passed before there were '
            f'{_asked_for(settings)}',
        ) from error


def _asked_for(settings: Settings) -> str:
    """Return what the settings ask for, in words."""
    thin = settings.sample_thin
    return f'{settings.sample_count} draws' + (f', {thin} steps apart' if thin > 1 else '')
