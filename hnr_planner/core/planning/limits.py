"""Limits on the work for a request: the clock, a count of transitions, a cancellation."""

from collections.abc import Callable
from dataclasses import dataclass, field
import math
import time
from typing import TypeVar

from hnr_planner.core.cancellation import Event
from hnr_planner.core.errors import Interrupted
from hnr_planner.core.kernels.clock import working_time
from hnr_planner.core.kernels.interruption import interruptible
from hnr_planner.core.planning.planner import Search
from hnr_planner.core.planning.result import PlannerStatus

Value = TypeVar('Value')

#: Number of transitions in the first batch of a search, and bounds on the duration of a batch [s]:
#: the next batch is twice as large after a shorter one, and half as large after a longer one.
FIRST_BATCH = 64
BATCH_TIME = (0.25e-3, 0.5e-3)


@dataclass
class Budget:
    """
    Limits on the work for one request, and whether the clock or a cancellation cut it short.

    Attributes
    ----------
    deadline : float
        End of the time allowed, on the clock of ``working_time`` [s].
    max_iterations : float
        Transitions allowed for one search; may be inf.
    cancel : Event or None
        Event that ends all work within the budget once the event is set.
    cut : bool
        Whether the clock or a cancellation has ended some of the work; never reset.

    """

    deadline: float
    max_iterations: float = math.inf
    cancel: Event | None = None
    cut: bool = field(init=False, default=False)

    def stop(self) -> PlannerStatus | None:
        """
        Return why work has to stop now, CANCELLED or TIMEOUT; None while it may go on.

        The call sets ``cut`` where work has to stop.
        """
        stopped = None
        if self.cancel is not None and self.cancel.is_set():
            stopped = PlannerStatus.CANCELLED
        elif working_time() >= self.deadline:
            stopped = PlannerStatus.TIMEOUT
        self.cut = self.cut or stopped is not None
        return stopped

    def within(self, work: Callable[[], Value], otherwise: Value) -> Value:
        """
        Return the result of ``work()``, or ``otherwise`` where a limit interrupts its kernels.

        The limits are the deadline and the cancellation of this budget. An interruption that
        another condition caused is raised again.
        """
        try:
            with interruptible(lambda: self.stop() is not None):
                return work()
        except Interrupted:
            if self.stop() is None:
                raise  # a condition set by the caller ended it, not this budget
            return otherwise


def run(search: Search, budget: Budget) -> PlannerStatus:
    """
    Advance a search until it is solved or a limit is met; return the status that ended it.

    The limits are checked between batches of transitions. The size of a batch follows the clock,
    so that a check happens about every half a millisecond; it has no effect on the path found.
    """
    status = budget.within(lambda: _advance(search, budget), None)
    return status or budget.stop() or PlannerStatus.TIMEOUT


def _advance(search: Search, budget: Budget) -> PlannerStatus:
    batch = FIRST_BATCH
    while not search.solved:
        stopped = budget.stop()
        if stopped is not None:
            return stopped
        left = budget.max_iterations - search.iterations
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
