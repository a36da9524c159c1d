"""The one line on the log about each request: its text, its level and its greatest length."""

import threading
from typing import NamedTuple

from hnr_planner.server.responses.response import Response

#: A success that took more than this fraction of the time limit is slow, and logged at INFO.
SLOW = 0.5

#: Most characters of a line: consoles and log collectors may cut longer ones at any place.
LONGEST_LINE = 500


class LogEntry(NamedTuple):
    """A line for the log; ``level`` is 'debug', 'info' or 'warning'."""

    level: str
    text: str


class RequestLog:
    """Makes the log line of each request; the first success after ``start`` is at level INFO."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._first = True

    def start(self) -> None:
        """Give the next success the level INFO, however short its time is."""
        with self._lock:
            self._first = True

    def entry(
        self, caller: str, response: Response, time_limit: float, remark: str = ''
    ) -> LogEntry:
        """
        Return the line about a request.

        A failure is a warning. A success has the level DEBUG, but INFO when it is the first since
        ``start``, took more than ``SLOW`` times the time limit, or has a remark.

        Parameters
        ----------
        caller : str
            Service, action or topic that the request came by.
        response : Response
            How the request ended.
        time_limit : float
            Longest time [s] that the request was allowed to take.
        remark : str
            A further note on the request, put before the reason; empty for none.

        """
        ended = f'{response.outcome.name} after {response.elapsed:.3f} s'
        text = f'{caller}: {ended}: {"; ".join(filter(None, [remark, response.why]))}'
        if not response.outcome.is_success:
            return LogEntry('warning', shortened(text))
        with self._lock:
            first, self._first = self._first, False
        noted = first or remark or response.elapsed > SLOW * time_limit
        return LogEntry('info' if noted else 'debug', shortened(text))


def shortened(text: str) -> str:
    """Return ``text``, cut to ``LONGEST_LINE`` characters and ended by '…' if it is longer."""
    return text if len(text) <= LONGEST_LINE else f'{text[: LONGEST_LINE - 2]} …'
