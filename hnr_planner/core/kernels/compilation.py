"""
Compilation in the background: machine code for the calls that come, while this one is interpreted.

A kernel that has no machine code asks for it here (``request``). A child process of low priority
(``compiler``) compiles into the cache on disk, one kernel after the other: what a call has asked
for first, then what a use of the package needs in general (``prepare``). A thread of this process
starts it, reads its notices, and loads what it made, so that no call waits for that.

The child ends by itself a few seconds after its work, and at once when this process ends, however
that happens. Whatever goes wrong with it costs one line in the log, and calls go on interpreted.
"""

import atexit
import logging
import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
import time
from typing import Any, NamedTuple

from hnr_planner.core.kernels.cache_folder import cache_folder, cache_home
from hnr_planner.core.kernels.modes import Mode, mode
from hnr_planner.core.kernels.needs import known_needs, Need, need_of, Workload

_log = logging.getLogger('hnr_planner')

#: Ends of the child by a signal to all processes of a group, which ends this one as well.
ENDED_BY_ORDER = (-signal.SIGINT, -signal.SIGTERM)


class Status(NamedTuple):
    """How far compilation in the background is, in this process."""

    #: ``'compiled'``, or ``'interpreted'`` while something that was asked for is not there, or
    #: where nothing is ever compiled.
    tier: str
    #: Number of kernels, each for one signature, that have arrived.
    compiled: int
    #: Number of those that are asked for.
    pending: int
    #: Number of those that will not come in this process.
    failed: int
    #: Time [s] that the child has worked, without its wait for more.
    elapsed: float
    #: Whether the child is running.
    running: bool

    def __str__(self) -> str:
        """Return the status in words, for messages."""
        if self.pending:
            total = self.compiled + self.pending
            return f'compilation is under way, {self.compiled} of {total} kernels'
        if self.failed:
            return f'{self.failed} kernels could not be compiled and run interpreted'
        return 'all kernels asked for are compiled'


class Notice(NamedTuple):
    """What the child has to tell of a need; of all that a workload needs, before it compiles."""

    about: Need | list[Need]
    #: Empty, or why there will be no machine code.
    failure: str = ''


class _Background:
    """The child process of this process, and what it was asked for."""

    def __init__(self) -> None:
        self.lock = threading.RLock()
        #: Needs that a call waits for, with their kernel and signature.
        self.asked: dict[Need, tuple[Any, Any]] = {}
        #: Further needs of workloads.
        self.general: dict[Need, None] = {}
        self.workloads: list[Workload] = []
        self.compiled = 0
        self.failed = 0
        #: Time [s] that children have worked, and when the present one was started.
        self.worked = 0.0
        self.started = 0.0
        #: When the present child was started, or its last notice came: it ends some time later.
        self.heard = 0.0
        self.process: subprocess.Popen[bytes] | None = None
        self.messages: queue.SimpleQueue[Need | Workload | None] = queue.SimpleQueue()
        #: Number of notices of the present child.
        self.notices = 0
        self.is_running = False
        self.has_given_up = False
        self.is_ending = False

    def ask(self, message: Need | Workload) -> None:
        """Hand a message to the child; start one if none is running."""
        with self.lock:
            if self.is_running:
                self.messages.put(message)
                return
            self.is_running = True
            self.started = self.heard = time.monotonic()
            thread = threading.Thread(target=self.run, name='kernel compilation', daemon=True)
            thread.start()

    # -- in the thread: it outlives the child, which the system ends with the thread that made it

    def run(self) -> None:
        """Run children until nothing is left to ask for."""
        while True:
            self.notices = 0
            code = self.run_child()
            with self.lock:
                self.process = None
                is_left = bool(self.asked or self.general or self.workloads)
                if is_left and code == 0 and self.notices:  # it was about to end for want of work
                    continue
                self.worked += self.heard - self.started
                self.is_running = False
                if self.is_ending or code in ENDED_BY_ORDER:
                    return
                if is_left:
                    self.give_up(f'the process that compiles kernels ended ({code})')
                elif self.compiled:
                    _log.info(
                        'compilation is done: %d kernels in %.0f s', self.compiled, self.worked
                    )
                return

    def give_up(self, reason: str) -> None:
        """Compile no more in this process."""
        self.has_given_up = True
        self.failed += len(self.asked) + len(self.general)
        self.asked.clear()
        self.general.clear()
        self.workloads.clear()
        _log.warning('%s: what has no machine code yet runs interpreted', reason)

    def run_child(self) -> int:
        """Run one child: ask it for all that is left, load what it makes; return how it ended."""
        try:
            process = subprocess.Popen(
                [
                    sys.executable,
                    '-P',
                    '-m',
                    'hnr_planner.core.kernels.compiler',
                    str(os.getpid()),
                ],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                env=_environment(),
            )
        except OSError as error:
            _log.debug('no process to compile in: %s', error)
            return -1
        with self.lock:
            self.process = process
            self.messages = queue.SimpleQueue()
            left: list[Need | Workload] = [*self.asked, *self.workloads, *self.general]
            for message in left:
                self.messages.put(message)
        _log.info('compilation of kernels runs in the background, in process %d', process.pid)
        writer = threading.Thread(target=_write, args=(process, self.messages), daemon=True)
        writer.start()
        assert process.stdout is not None
        try:
            while True:
                self.take(pickle.load(process.stdout))
        except (EOFError, pickle.UnpicklingError, OSError):
            pass
        code = process.wait()
        self.messages.put(None)
        writer.join()
        process.stdout.close()
        return code

    def take(self, notice: Notice) -> None:
        """Take note of what the child says; load what it has made."""
        self.notices += 1
        self.heard = time.monotonic()
        if isinstance(notice.about, list):
            with self.lock:
                self.general |= dict.fromkeys(notice.about)
                self.workloads = self.workloads[1:]
            if notice.failure:
                _log.warning('not known what is to be compiled: %s', notice.failure)
            return
        is_loaded = not notice.failure and self.load(notice.about)
        with self.lock:
            was_asked = self.asked.pop(notice.about, None) is not None
            was_general = notice.about in self.general
            self.general.pop(notice.about, None)
            if was_asked or was_general:
                self.compiled += is_loaded
                self.failed += not is_loaded
        if not is_loaded:
            reason = notice.failure or 'it is not in the cache: were the sources changed?'
            _log.warning('%s stays interpreted: %s', notice.about.name, reason)

    def load(self, need: Need) -> bool:
        """Load machine code that the child has made; return whether it is there."""
        try:
            kernel, signature = self.asked.get(need) or need.resolve()
        except Exception:  # its module cannot be imported here
            return False
        return bool(kernel.load(signature))


def _environment() -> dict[str, str]:
    """Return the environment in which a child finds the same modules and the same cache."""
    path = os.pathsep.join(os.path.abspath(folder) for folder in sys.path)
    home = cache_home(cache_folder())
    return {**os.environ, 'PYTHONPATH': path, 'NUMBA_CACHE_DIR': str(home)}


def _write(process: Any, messages: Any) -> None:
    """Write messages to a child as they come, in a thread: the child may be slow to read."""
    try:
        while (message := messages.get()) is not None:
            pickle.dump(message, process.stdin)
            process.stdin.flush()
        process.stdin.close()
    except (OSError, ValueError):  # it has ended
        pass


_background = _Background()


def request(kernel: Any, signature: Any) -> None:
    """Ask for machine code that a call has missed."""
    need = None if _background.has_given_up else need_of(kernel, signature)
    with _background.lock:
        if need is None or need in _background.asked:
            return
        _background.asked[need] = kernel, signature
        _background.ask(need)


def prepare(workload: Workload) -> None:
    """Load what a workload needs, in the background; compile what is not in the cache."""
    if mode() is Mode.AUTO and not _background.has_given_up:
        threading.Thread(target=_prepare, args=(workload,), daemon=True).start()


def _prepare(workload: Workload) -> None:
    needs = known_needs(workload)
    if needs is not None and all(_is_loaded(need) for need in needs):
        return
    with _background.lock:
        _background.workloads.append(workload)
        _background.ask(workload)


def _is_loaded(need: Need) -> bool:
    """Load machine code if it is in the cache; return whether it is."""
    kernel, signature = need.resolve()
    return bool(kernel.load(signature))


def status() -> Status:
    """Return how far compilation in the background is."""
    with _background.lock:
        pending = len(_background.asked) + len(_background.general)
        is_waiting = pending > 0 or bool(_background.workloads)
        is_compiled = not (is_waiting or _background.failed or mode() is Mode.INTERPRETED)
        running_for = 0.0
        if _background.is_running:
            until = time.monotonic() if is_waiting else _background.heard
            running_for = until - _background.started
        return Status(
            tier='compiled' if is_compiled else 'interpreted',
            compiled=_background.compiled,
            pending=pending,
            failed=_background.failed,
            elapsed=_background.worked + running_for,
            running=_background.process is not None,
        )


def _forget() -> None:
    """Begin anew in a forked process: threads and child belong to its parent."""
    global _background
    _background = _Background()


def _end() -> None:
    """End the child with this process, and wait for it."""
    _background.is_ending = True
    process = _background.process
    if process is not None:
        process.kill()
        process.wait()


os.register_at_fork(after_in_child=_forget)
atexit.register(_end)
