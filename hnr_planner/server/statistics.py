"""Statistics of requests: how many ended how, and how long planning takes."""

from collections import Counter, deque
from dataclasses import dataclass
import threading

from hnr_planner.server.outcomes import Outcome
from hnr_planner.server.responses import Response
import numpy as np

#: Times of so many of the last requests are kept.
REMEMBERED_TIMES = 1000


@dataclass(frozen=True)
class Summary:
    """Requests by outcome, and the median and 95th percentile of their time [s]."""

    outcomes: dict[Outcome, int]
    median: float
    p95: float

    @property
    def requests(self) -> int:
        """Return the number of requests."""
        return sum(self.outcomes.values())


class Statistics:
    """Counts responses; times are those of the last requests that searched."""

    def __init__(self) -> None:
        self._outcomes: Counter[Outcome] = Counter()
        self._times: deque[float] = deque(maxlen=REMEMBERED_TIMES)
        self._lock = threading.Lock()

    def count(self, response: Response) -> None:
        """Add one response."""
        with self._lock:
            self._outcomes[response.outcome] += 1
            if response.searched:
                self._times.append(response.elapsed)

    def summary(self) -> Summary:
        """Return the numbers so far; times are NaN before the first search."""
        with self._lock:
            outcomes, times = dict(self._outcomes), list(self._times)
        median, p95 = np.percentile(times, [50, 95]) if times else (np.nan, np.nan)
        return Summary(outcomes, float(median), float(p95))
