"""The base of the responses to requests: how a request ended, and how long it took."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field, replace
from typing import Self, TYPE_CHECKING

from hnr_planner.server.requests.outcomes import Outcome
from hnr_planner.server.requests.times import Times

if TYPE_CHECKING:
    from hnr_planner.server.map.map_store import MapSnapshot


@dataclass(frozen=True)
class Response(ABC):
    """
    How a request ended: the base of the responses for paths and for draws.

    Parameters
    ----------
    outcome : Outcome
        The name under which the request ended.
    why : str
        The outcome in words, with the values that explain it.
    elapsed : float
        Time from the arrival of the request to this response [s], by ``time.monotonic``.
    times : Times
        Times of the phases of the request.
    tier : str
        'compiled' when machine code did all of the work, 'interpreted' when some of it ran in
        Python because its machine code was not available.
    snapshot : MapSnapshot, optional
        The map that the response holds for; None when the request ended before it had a map.

    """

    outcome: Outcome
    why: str
    elapsed: float = field(default=0.0, kw_only=True)
    times: Times = field(default_factory=Times, kw_only=True)
    tier: str = field(default='compiled', kw_only=True)
    snapshot: MapSnapshot | None = field(default=None, kw_only=True)

    @property
    def frame(self) -> str:
        """Name of the frame of the map in ``snapshot``; empty without a map."""
        return '' if self.snapshot is None else self.snapshot.frame

    @property
    def searched(self) -> bool:
        """Whether a path was searched for, found or not; False for draws."""
        return False

    @property
    @abstractmethod
    def algorithm(self) -> str:
        """Name of the planner of a path, or of the random walk of draws."""

    def sent_after(self, seconds: float) -> Self:
        """Return the response with the time [s] until it was sent added."""
        times = replace(self.times, message_time=self.times.message_time + seconds)
        return replace(self, elapsed=self.elapsed + seconds, times=times)

    @property
    def values(self) -> dict[str, str]:
        """Published values of the request as text, by name; in seconds and metres, NaN unknown."""
        return {
            'why': self.why,
            'algorithm': self.algorithm,
            'elapsed': f'{self.elapsed:.6f}',
            'tier': self.tier,
        }
