"""The limits of one request, from its arrival to its response: time limit and cancellation."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
import threading
from typing import TypeVar

from hnr_planner.core.errors import Interrupted
from hnr_planner.core.kernels.clock import working_time
from hnr_planner.core.kernels.interruption import interruptible
from hnr_planner.server.requests.outcomes import Outcome, Refusal

Value = TypeVar('Value')

#: Time [s] that a search gets even when the deadline has passed: enough to prove a goal
#: unreachable.
SHORTEST_TIME = 1e-3


@dataclass(frozen=True)
class RequestLimits:
    """
    The time limit and the cancellation that end a request.

    Parameters
    ----------
    time_limit : float
        Longest time [s] that the request may take; named in messages.
    deadline : float
        Value of the clock ``working_time`` [s] at which the time limit has passed.
    cancel : threading.Event
        Ends the request when it is set.

    """

    time_limit: float
    deadline: float
    cancel: threading.Event

    @classmethod
    def from_now(cls, time_limit: float, cancel: threading.Event) -> 'RequestLimits':
        """Return the limits of a request that begins now and may take ``time_limit`` [s]."""
        return cls(time_limit, working_time() + time_limit, cancel)

    @property
    def time_left(self) -> float:
        """Time [s] that a search gets: up to the deadline, but at least ``SHORTEST_TIME``."""
        return max(self.deadline - working_time(), SHORTEST_TIME)

    @property
    def time_is_up(self) -> bool:
        """Whether ``working_time()`` has reached the deadline."""
        return working_time() >= self.deadline

    def must_end(self) -> bool:
        """Return whether the request has to end: it was cancelled, or its time is up."""
        return self.cancel.is_set() or self.time_is_up

    def check(self) -> None:
        """Raise Refusal, after a search: CANCELLED if ``cancel`` is set, TIMEOUT if time is up."""
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
        """
        Interrupt interpreted kernels in a ``with`` block when the request has to end.

        An interruption raises Refusal (CANCELLED, TIMEOUT). Compiled kernels are not interrupted.
        """
        try:
            with interruptible(self.must_end):
                yield
        except Interrupted:
            self.check()
            raise

    def within(self, work: Callable[[], Value], otherwise: Value, least: float = 0.0) -> Value:
        """
        Return what ``work`` returns, or ``otherwise`` where a limit interrupts its kernels.

        Only interpreted kernels can be interrupted: by a cancellation, or when time is up.

        Parameters
        ----------
        work : callable
            Work without arguments.
        otherwise : Value
            What to return when ``work`` was interrupted.
        least : float
            Time [s] that ``work`` gets before either limit can interrupt it.

        """
        first = working_time() + least
        try:
            with interruptible(lambda: working_time() >= first and self.must_end()):
                return work()
        except Interrupted:
            return otherwise
