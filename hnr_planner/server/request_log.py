"""The line on the log about each request: its level, and how long it may be."""

import threading
from typing import NamedTuple

from hnr_planner.server.responses import Response

#: A success that took more than this share of the time limit is slow, and logged at INFO.
SLOW = 0.5

#: Characters of a line, at most: consoles and log collectors cut longer ones anywhere.
LONGEST_LINE = 500


class LogEntry(NamedTuple):
    """A line for the log; ``level`` is the name of a method of rclpy's loggers."""

    level: str
    text: str


class RequestLog:
    """Makes the line of each request; a fresh start makes the next success an INFO again."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._first = True

    def start(self) -> None:
        """Log the next success at INFO, whatever it takes."""
        with self._lock:
            self._first = True

    def entry(
        self, caller: str, response: Response, time_limit: float, remark: str = ''
    ) -> LogEntry:
        """
        Return the line about a request.

        A failure is a warning. A success is DEBUG unless it is the first since ``start``, slow, or
        comes with a remark.

        Parameters
        ----------
        caller : str
            Service, action or topic that the request came by.
        response : Response
            How it ended.
        time_limit : float
            What it was allowed to take [s].
        remark : str
            What else is to be said about the request.

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
    """Return ``text`` with at most ``LONGEST_LINE`` characters."""
    return text if len(text) <= LONGEST_LINE else f'{text[: LONGEST_LINE - 2]} …'
