"""What ends a search that does not end by itself: the clock, a count, or a person."""

from dataclasses import dataclass, field
import math
import time

from hnr_planner.core.cancellation import Event
from hnr_planner.core.planning.planner import Search
from hnr_planner.core.planning.result import PlannerStatus

#: Transitions in the first batch; later ones last about as long as the bounds below [s].
FIRST_BATCH = 64
BATCH_TIME = (0.25e-3, 0.5e-3)


@dataclass
class Budget:
    """
    Limits on the work for one request, and whether one of them cut it short.

    Attributes
    ----------
    deadline : float
        End of the time allowed, on the clock of ``time.perf_counter`` [s].
    max_iterations : float
        Transitions allowed for one search; may be inf.
    cancel : Event or None
        Ends everything once it is set.
    cut : bool
        Whether the clock or a cancellation has ended something.

    """

    deadline: float
    max_iterations: float = math.inf
    cancel: Event | None = None
    cut: bool = field(init=False, default=False)

    def stop(self) -> PlannerStatus | None:
        """Say why work has to stop now; None while it may go on."""
        stopped = None
        if self.cancel is not None and self.cancel.is_set():
            stopped = PlannerStatus.CANCELLED
        elif time.perf_counter() >= self.deadline:
            stopped = PlannerStatus.TIMEOUT
        self.cut = self.cut or stopped is not None
        return stopped

    def run(self, search: Search) -> PlannerStatus:
        """
        Advance a search until it is solved or a limit is met, and say which.

        Between batches the limits are looked at. The size of the batches follows the clock so that
        this happens about every half a millisecond; it has no effect on what is found.
        """
        batch = FIRST_BATCH
        while not search.solved:
            stopped = self.stop()
            if stopped is not None:
                return stopped
            left = self.max_iterations - search.iterations
            if left <= 0:
                return PlannerStatus.ITERATION_LIMIT
            began = time.perf_counter()
            search.advance(int(min(batch, left)))
            batch = _next_batch(batch, time.perf_counter() - began)
        return PlannerStatus.SOLVED


def _next_batch(batch: int, seconds: float) -> int:
    shortest, longest = BATCH_TIME
    if seconds < shortest:
        return 2 * batch
    return max(1, batch // 2) if seconds > longest else batch
