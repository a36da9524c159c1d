"""Print progress: one line that is overwritten on a terminal, single lines in a log."""

from __future__ import annotations

import sys
import time

#: Least time between two lines of progress in a log [s].
PATIENCE = 10.0
_said_last = [0.0]


def show(news: str) -> None:
    """Print the current step."""
    if sys.stderr.isatty():
        print(f'\r\033[K{news}', end='', file=sys.stderr, flush=True)
    elif time.monotonic() - _said_last[0] > PATIENCE:
        _said_last[0] = time.monotonic()
        print(news, file=sys.stderr, flush=True)


def say(text: str) -> None:
    """Print a line that stays."""
    clear = '\r\033[K' if sys.stderr.isatty() else ''
    print(clear, end='', file=sys.stderr, flush=True)
    print(text, flush=True)
