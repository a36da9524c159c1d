"""
The folder that keeps machine code on disk: one folder for each state of the core's sources.

Numba's cache looks at the file of the kernel alone: a change in another file of the core would not
be noticed, and the kernel would run outdated machine code. So the cache lies in a folder named by
the contents of all of the core's sources, and every edit starts a new one.
"""

import atexit
from collections.abc import Iterator
from contextlib import contextmanager
import fcntl
from functools import cache
import hashlib
import logging
import os
from pathlib import Path
import shutil
import tempfile

#: The folder whose sources a cache belongs to.
CORE = Path(__file__).resolve().parents[1]

_log = logging.getLogger('hnr_planner')


def source_digest(folder: Path) -> str:
    """Return 16 hex digits: a digest of paths and contents of Python files below ``folder``."""
    digest = hashlib.sha256()
    for path in sorted(folder.rglob('*.py')):
        digest.update(path.relative_to(folder).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


@cache
def cache_folder() -> Path:
    """
    Return the folder of the machine code of the present sources, and make it if it is missing.

    It lies in ``NUMBA_CACHE_DIR`` if that is set, else in ``XDG_CACHE_HOME``, else in
    ``~/.cache``. If it cannot be written, a temporary folder takes its place, with a warning in
    the log: this process then compiles again what others have compiled, and the folder is removed
    when the process ends.
    """
    home = os.environ.get('NUMBA_CACHE_DIR') or os.environ.get('XDG_CACHE_HOME') or '~/.cache'
    folder = Path(home).expanduser() / 'hnr_planner' / source_digest(CORE)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return folder
    except OSError as error:
        temporary = Path(tempfile.mkdtemp(prefix='hnr_planner_'))
        atexit.register(shutil.rmtree, temporary, ignore_errors=True)
        _log.warning(
            'compiled kernels cannot be kept in %s (%s); using %s instead, so every start '
            'compiles again: set NUMBA_CACHE_DIR to a folder that can be written',
            folder,
            error,
            temporary,
        )
        folder = temporary / 'hnr_planner' / folder.name
        folder.mkdir(parents=True)
        return folder


def cache_home(folder: Path) -> Path:
    """Return the ``NUMBA_CACHE_DIR`` with which a child process has ``folder`` as its cache."""
    return folder.parents[1]


@contextmanager
def compiler_lock() -> Iterator[None]:
    """
    Hold, within a block, the lock of all processes that compile into this cache folder.

    Wait while another process holds the lock; the system frees the lock when its owner ends. If
    the lock's file cannot be opened, or the file system has no locks, run the block without it.
    """
    try:
        file = os.open(cache_folder() / 'compiler.lock', os.O_CREAT | os.O_RDWR, 0o644)
    except OSError:
        yield
        return
    try:
        try:
            fcntl.flock(file, fcntl.LOCK_EX)
        except OSError:  # a file system without locks
            pass
        yield
    finally:
        os.close(file)
