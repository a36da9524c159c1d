"""The limits of one request, from its arrival to its response: time limit and cancellation."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
import threading
from typing import TypeVar

from hnr_planner.core.errors import Interrupted
from hnr_planner.core.kernels.clock import working_time
from hnr_planner.core.kernels.interruption import interruptible
from hnr_planner.server.outcomes import Outcome, Refusal

Value = TypeVar('Value')

#: Time [s] that a search gets at least, so that it can still prove a goal unreachable.
SHORTEST_TIME = 1e-3


@dataclass(frozen=True)
class RequestLimits:
    """
    When a request has to end.

    Parameters
    ----------
    time_limit : float
        What it may take [s].
    deadline : float
        When that is over, by the clock ``working_time``.
    cancel : threading.Event
        Ends it when it is set.

    """

    time_limit: float
    deadline: float
    cancel: threading.Event

    @classmethod
    def from_now(cls, time_limit: float, cancel: threading.Event) -> 'RequestLimits':
        """Return the limits of a request that begins now."""
        return cls(time_limit, working_time() + time_limit, cancel)

    @property
    def time_left(self) -> float:
        """Return the time that a search gets [s]."""
        return max(self.deadline - working_time(), SHORTEST_TIME)

    @property
    def time_is_up(self) -> bool:
        """Return whether the time limit has passed."""
        return working_time() >= self.deadline

    def hold(self) -> bool:
        """Return whether the request has to end."""
        return self.cancel.is_set() or self.time_is_up

    def check(self) -> None:
        """Raise Refusal (CANCELLED, TIMEOUT) when the request has to end."""
        if self.cancel.is_set():
            raise Refusal(Outcome.CANCELLED, 'the request was cancelled after the search')
        if self.time_is_up:
            raise Refusal(
                Outcome.TIMEOUT,
                f'the time limit of {self.time_limit:g} s passed after the search, before its '
                'trajectory was a path',
            )

    @contextmanager
    def enforced(self) -> Iterator[None]:
        """Raise Refusal (CANCELLED, TIMEOUT) when interpreted kernels in the block take long."""
        try:
            with interruptible(self.hold):
                yield
        except Interrupted:
            self.check()
            raise

    def within(self, work: Callable[[], Value], otherwise: Value, least: float = 0.0) -> Value:
        """
        Return what ``work`` returns, or ``otherwise`` where a limit interrupts its kernels.

        Parameters
        ----------
        work : callable
            What to do.
        otherwise : Value
            Its result when it was interrupted.
        least : float
            Time [s] that it gets in any case.

        """
        first = working_time() + least
        try:
            with interruptible(lambda: working_time() >= first and self.hold()):
                return work()
        except Interrupted:
            return otherwise
