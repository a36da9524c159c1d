"""One core for everything that runs, so that nobody has more of the machine than others."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
import os


@contextmanager
def on_one_core() -> Iterator[None]:
    """Let everybody, programs that are started here too, run on one core."""
    cores = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {max(cores)})
    yield
    os.sched_setaffinity(0, cores)
