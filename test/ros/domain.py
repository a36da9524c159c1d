"""A ROS domain that no other test process on this machine uses at the same time."""

from collections.abc import Iterator
from contextlib import contextmanager
import fcntl
import os
from pathlib import Path
import tempfile


@contextmanager
def own_domain() -> Iterator[int]:
    """Reserve a ROS domain for this test process: a lock on a file keeps others out of it."""
    folder = Path(tempfile.gettempdir()) / 'hnr_planner_domains'
    folder.mkdir(exist_ok=True)
    # Domains up to 101 keep their ports below those that Linux gives out by itself.
    first = os.getpid() % 100
    for offset in range(100):
        domain = 1 + (first + offset) % 100
        lock = (folder / str(domain)).open('w')
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            lock.close()
            continue
        with lock:
            yield domain
        return
    raise RuntimeError('every ROS domain from 1 to 100 is in use by a test')
