"""
Compilation in the background: machine code for later calls, while the present call is interpreted.

A kernel that has no machine code asks for it here (``request``). A child process of low priority
(``compiler``) compiles into the cache on disk, one kernel after the other: what a call has asked
for first, then what a use of the package needs in general (``prepare``). A thread of this process
starts the child, reads its notices, and loads the machine code that it made, so that no call
waits.

The child ends by itself a few seconds after its work, and at once when this process ends, however
that happens. Whatever goes wrong with the child is logged in one line, and calls go on
interpreted.
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

#: Return codes of a child that was ended by a signal to all processes of its group. That signal
#: ends this process as well, so that no warning is due.
ENDED_BY_ORDER = (-signal.SIGINT, -signal.SIGTERM)


class Status(NamedTuple):
    """
    State of compilation in the background, for this process.

    Kernels are counted once for each signature (the types of their arguments).
    """

    #: ``'compiled'`` if all machine code that was asked for is loaded; ``'interpreted'`` while
    #: some is pending, if some has failed, and in the mode ``interpreted``.
    tier: str
    #: Number of kernels whose machine code was asked for and is loaded.
    compiled: int
    #: Number of kernels that are asked for and neither loaded nor failed.
    pending: int
    #: Number of kernels that could not be compiled or loaded, and stay interpreted.
    failed: int
    #: Time [s] that children have worked, without their wait for more work.
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
    """
    Message from the child: one need is done or has failed, or what a workload needs.

    For a need it comes after its compilation; for a workload, before any of its needs is compiled.
    """

    #: The need; for a workload, the list of all its needs, empty if they could not be found.
    about: Need | list[Need]
    #: Empty, or why the need has no machine code, or why the workload's needs are not known.
    failure: str = ''


class _Background:
    """The child process that compiles for this process, and what is still asked of it."""

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
        """
        Send a message to the child if one is running, else start the thread that runs one.

        A new child gets everything in ``asked``, ``workloads`` and ``general``: the caller puts
        the message there first.
        """
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
        """
        Run one child after another until nothing is left to ask for, or until a child fails.

        A further child runs only if the last one ended in order, after some notice, while a new
        request was on its way. Else what is left is given up, with a warning, unless this process
        is ending or the child was ended by a signal in ``ENDED_BY_ORDER``.
        """
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
        """Compile no more in this process: count all that is left as failed, and log why."""
        self.has_given_up = True
        self.failed += len(self.asked) + len(self.general)
        self.asked.clear()
        self.general.clear()
        self.workloads.clear()
        _log.warning('%s: what has no machine code yet runs interpreted', reason)

    def run_child(self) -> int:
        """
        Run one child: ask it for all that is left, and load what it makes.

        Return the child's return code, as of ``Popen``: 0 if it ended in order, minus the number
        of the signal if a signal ended it. Return -1 if it could not be started.
        """
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
        """
        Process a notice of the child.

        If it lists the needs of a workload, add them to ``general``. If it is about one need, load
        its machine code, and count the need as compiled or failed.
        """
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
        """Load the machine code of ``need`` from the cache; return whether it is loaded."""
        try:
            kernel, signature = self.asked.get(need) or need.resolve()
        except Exception:  # its module cannot be imported here
            return False
        return bool(kernel.load(signature))


def _environment() -> dict[str, str]:
    """Return the environment variables with which a child has these modules and this cache."""
    path = os.pathsep.join(os.path.abspath(folder) for folder in sys.path)
    home = cache_home(cache_folder())
    return {**os.environ, 'PYTHONPATH': path, 'NUMBA_CACHE_DIR': str(home)}


def _write(process: Any, messages: Any) -> None:
    """
    Write messages to the child's standard input as they come, until a message is None.

    It runs in a thread of its own, since the child may be slow to read.
    """
    try:
        while (message := messages.get()) is not None:
            pickle.dump(message, process.stdin)
            process.stdin.flush()
        process.stdin.close()
    except (OSError, ValueError):  # it has ended
        pass


_background = _Background()


def request(kernel: Any, signature: Any) -> None:
    """
    Ask the child for machine code of ``kernel`` for ``signature``, which a call has missed.

    Do nothing if it is asked for already, if compilation was given up, or if another process would
    not find the kernel or its types.
    """
    need = None if _background.has_given_up else need_of(kernel, signature)
    with _background.lock:
        if need is None or need in _background.asked:
            return
        _background.asked[need] = kernel, signature
        _background.ask(need)


def prepare(workload: Workload) -> None:
    """
    Load the machine code that a workload needs; have the child compile what the cache lacks.

    Both happen in the background, and only in the mode ``auto``; in other modes, and once
    compilation was given up, do nothing.
    """
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
    """Load the machine code of ``need`` if the cache has it; return whether it is loaded."""
    kernel, signature = need.resolve()
    return bool(kernel.load(signature))


def status() -> Status:
    """Return the present state of compilation in the background."""
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
    """Reset the state in a forked process: the threads and the child belong to its parent."""
    global _background
    _background = _Background()


def _end() -> None:
    """Kill the child when this process ends, and wait until the child has ended."""
    _background.is_ending = True
    process = _background.process
    if process is not None:
        process.kill()
        process.wait()


os.register_at_fork(after_in_child=_forget)
atexit.register(_end)
