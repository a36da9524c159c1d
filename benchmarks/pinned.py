"""Run everything on one core, so that no competitor has more of the machine than others."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
import os


@contextmanager
def on_one_core() -> Iterator[None]:
    """Restrict this process and its children to one core inside the block."""
    cores = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {max(cores)})
    yield
    os.sched_setaffinity(0, cores)
