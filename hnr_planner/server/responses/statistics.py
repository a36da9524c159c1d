"""Statistics of requests: how many ended with each outcome, and how long searches took."""

from collections import Counter, deque
from dataclasses import dataclass
import threading

from hnr_planner.server.requests.outcomes import Outcome
from hnr_planner.server.responses.response import Response
import numpy as np

#: Number of the latest requests with a search whose times are kept.
REMEMBERED_TIMES = 1000


@dataclass(frozen=True)
class Summary:
    """
    Statistics of requests at one moment.

    Parameters
    ----------
    outcomes : dict
        Number of all requests that ended with each outcome; outcomes without any are left out.
    median, p95 : float
        Median and 95th percentile of the time [s] from request to response, over the last
        ``REMEMBERED_TIMES`` requests that searched; NaN before the first one.

    """

    outcomes: dict[Outcome, int]
    median: float
    p95: float

    @property
    def requests(self) -> int:
        """Number of all requests, whatever their outcome."""
        return sum(self.outcomes.values())


class Statistics:
    """Counts all responses by outcome, and keeps the times of the latest that searched."""

    def __init__(self) -> None:
        self._outcomes: Counter[Outcome] = Counter()
        self._times: deque[float] = deque(maxlen=REMEMBERED_TIMES)
        self._lock = threading.Lock()

    def count(self, response: Response) -> None:
        """Count ``response`` by its outcome; keep its time if a path was searched for."""
        with self._lock:
            self._outcomes[response.outcome] += 1
            if response.searched:
                self._times.append(response.elapsed)

    def summary(self) -> Summary:
        """Return the statistics so far; their times are NaN before the first search."""
        with self._lock:
            outcomes, times = dict(self._outcomes), list(self._times)
        median, p95 = np.percentile(times, [50, 95]) if times else (np.nan, np.nan)
        return Summary(outcomes, float(median), float(p95))
