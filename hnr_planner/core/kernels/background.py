"""
Child process that compiles for this process: it is started, asked, heard and given up here.

A thread runs the child, reads its notices (``Notice``) and loads the machine code that it made. A
second thread writes what is asked of it. ``compiler`` is the module that the child runs.
"""

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
from hnr_planner.core.kernels.needs import Need, Workload

_log = logging.getLogger('hnr_planner')

#: Return codes of a child that was ended by a signal to all processes of its group. That signal
#: ends this process as well, so that no warning is due.
ENDED_BY_ORDER = (-signal.SIGINT, -signal.SIGTERM)


class Notice(NamedTuple):
    """
    Message from the child: one need is done or has failed, or what a workload needs.

    For a need it comes after its compilation; for a workload, before any of its needs is compiled.
    """

    #: The need; for a workload, the list of all its needs, empty if they could not be found.
    about: Need | list[Need]
    #: Empty, or why the need has no machine code, or why the workload's needs are not known.
    failure: str = ''


class Background:
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
