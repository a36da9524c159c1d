"""What the node knows about its own work: outcomes counted, and how long planning takes."""

from collections import Counter, deque
from dataclasses import dataclass
import threading

from hnr_planner.server.outcomes import Outcome
from hnr_planner.server.responses import Response
import numpy as np

REMEMBERED_TIMES = 1000


@dataclass(frozen=True)
class Summary:
    """Requests answered, by outcome, and the median and 95th percentile of their time [s]."""

    outcomes: dict[Outcome, int]
    median: float
    p95: float

    @property
    def requests(self) -> int:
        """Return the number of requests answered."""
        return sum(self.outcomes.values())


class Statistics:
    """Counts reports; times are those of the last requests that searched."""

    def __init__(self) -> None:
        self._outcomes: Counter[Outcome] = Counter()
        self._times: deque[float] = deque(maxlen=REMEMBERED_TIMES)
        self._lock = threading.Lock()

    def count(self, report: Response) -> None:
        """Add one report."""
        with self._lock:
            self._outcomes[report.outcome] += 1
            if report.searched:
                self._times.append(report.elapsed)

    def summary(self) -> Summary:
        """Return the figures so far; times are NaN before the first search."""
        with self._lock:
            outcomes, times = dict(self._outcomes), list(self._times)
        median, p95 = np.percentile(times, [50, 95]) if times else (np.nan, np.nan)
        return Summary(outcomes, float(median), float(p95))
