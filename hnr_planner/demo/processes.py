"""
Run the demo's processes, print their output line by line, and leave none behind.

Each process runs in a session of its own, so that Ctrl-C in a terminal reaches the demo alone. The
demo then ends the processes: by SIGTERM, and by SIGKILL where one still runs after ``END_WITHIN``.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
import os
from pathlib import Path
import random
import signal
import socket
import subprocess
import sys
import threading
import time
from types import FrameType

import hnr_planner
from hnr_planner.core import HnrError

#: Time for a process to end after SIGTERM [s].
END_WITHIN = 5.0
#: Signals that interrupt the demo.
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class ProcessError(HnrError):
    """Error that a process died, did not finish in time, or could not be given a ROS domain."""


class Screen:
    """Printer of whole lines from several threads, with the time since its creation."""

    def __init__(self) -> None:
        self._began = time.monotonic()
        self._lock = threading.Lock()
        self._last = self._began

    @property
    def silent_for(self) -> float:
        """Time since the last line was printed [s]."""
        return time.monotonic() - self._last

    def say(self, who: str, line: str) -> None:
        """Print a line with the time and the name of the process that it comes from."""
        with self._lock:
            self._last = time.monotonic()
            print(f'{self._last - self._began:6.1f} s  {who:<8} {line}', flush=True)


class Interruptions:
    """
    Handler that turns each signal of ``SIGNALS`` into KeyboardInterrupt.

    While ``held`` is in effect the exception waits until the end of its block.
    """

    def __init__(self) -> None:
        self._held = False
        self._pending = False

    @contextmanager
    def caught(self) -> Iterator[None]:
        """Handle ``SIGNALS`` inside the block, and restore their former handlers at its end."""
        before = {number: signal.signal(number, self._handle) for number in SIGNALS}
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)

    @contextmanager
    def held(self) -> Iterator[None]:
        """
        Let the block end before KeyboardInterrupt is raised.

        It is raised at the end of the block where a signal came inside it.
        """
        self._held = True
        try:
            yield
        finally:
            self._held = False
            if self._pending:
                self._pending = False
                raise KeyboardInterrupt

    def _handle(self, _number: int, _frame: FrameType | None) -> None:
        if self._held:
            self._pending = True
        else:
            raise KeyboardInterrupt


class Processes:
    """
    Python modules that run in processes of their own, all in one ROS domain.

    Parameters
    ----------
    screen : Screen
        Prints the output of the processes, each line with the name of its process.
    interruptions : Interruptions
        Held while a process is started or ended, so that no process is left behind.
    domain : int
        ROS_DOMAIN_ID of all of them.
    logs : Path
        Folder for the log files of ROS.

    """

    def __init__(
        self, screen: Screen, interruptions: Interruptions, domain: int, logs: Path
    ) -> None:
        self._screen = screen
        self._interruptions = interruptions
        self._environment = _environment(domain, logs)
        self._running: dict[str, subprocess.Popen[str]] = {}
        self._readers: list[threading.Thread] = []

    def start(self, name: str, module: str, arguments: Sequence[str]) -> None:
        """Start a Python module with arguments as the process called ``name``."""
        with self._interruptions.held():
            process = subprocess.Popen(
                [sys.executable, '-m', module, *arguments],
                env=self._environment,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                errors='replace',
                start_new_session=True,
            )
            self._running[name] = process
            reader = threading.Thread(target=self._show, args=(name, process), daemon=True)
            reader.start()
            self._readers.append(reader)

    def wait_for(self, name: str, within: float, waiting: str) -> None:
        """
        Wait until a process has ended with code 0, for at most ``within`` seconds.

        ``waiting`` is printed whenever nothing has been printed for five seconds.

        Raises
        ------
        ProcessError
            When the process ends with another code or not in time, or another process ends.

        """
        deadline = time.monotonic() + within
        while (code := self._running[name].poll()) is None:
            self.check_alive(waiting_for=name)
            if time.monotonic() > deadline:
                raise ProcessError(f'the {name} was not done after {within:.0f} s')
            if self._screen.silent_for > 5.0:
                self._screen.say('demo', waiting)
            time.sleep(0.05)
        del self._running[name]
        if code != 0:
            raise ProcessError(f'the {name} ended with exit code {code}; see its lines above')

    def check_alive(self, *, waiting_for: str = '') -> None:
        """Raise ProcessError where a process other than ``waiting_for`` has ended."""
        for name, process in self._running.items():
            code = process.poll()
            if code is not None and name != waiting_for:
                raise ProcessError(f'the {name} died with exit code {code}; see its lines above')

    def stop(self) -> list[str]:
        """
        End all processes that still run; return descriptions of what went wrong.

        A process that has to be killed is described, and one that ends with an exit code other
        than 0 without being ended by SIGTERM.
        """
        with self._interruptions.held():
            complaints = []
            for process in self._running.values():
                _send(process, signal.SIGTERM)
            deadline = time.monotonic() + END_WITHIN
            for name, process in self._running.items():
                try:
                    code = process.wait(max(deadline - time.monotonic(), 0.0))
                except subprocess.TimeoutExpired:
                    complaints.append(f'the {name} did not end within {END_WITHIN:.0f} s: killed')
                else:
                    # What was interrupted before it was ready ends by the signal itself.
                    if code not in (0, -signal.SIGTERM):
                        complaints.append(f'the {name} ended with exit code {code}')
                _send(process, signal.SIGKILL)  # the whole session, should it have children
                process.wait()
            for reader in self._readers:
                reader.join(timeout=1.0)
            self._running.clear()
            return complaints

    def _show(self, name: str, process: subprocess.Popen[str]) -> None:
        assert process.stdout is not None
        with process.stdout:
            for line in process.stdout:
                self._screen.say(name, line.rstrip())


def free_domain() -> int:
    """
    Return a random ROS domain from 1 to 101 whose discovery port is free on this machine.

    ProcessError is raised where none is.
    """
    domains = list(range(1, 102))  # those whose ports are safe on every system
    random.shuffle(domains)
    for domain in domains:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.bind(('', 7410 + 250 * domain))
            except OSError:
                continue
            return domain
    raise ProcessError('every ROS domain from 1 to 101 is in use on this machine')


def _environment(domain: int, logs: Path) -> dict[str, str]:
    """
    Return the environment variables of the processes.

    They import this package, discover each other on this machine only, in the ROS domain
    ``domain``, and write plain log files into ``logs``.
    """
    environment = {
        name: value
        for name, value in os.environ.items()
        if name not in ('ROS_LOCALHOST_ONLY', 'ROS_STATIC_PEERS')
    }
    package = str(Path(hnr_planner.__file__).resolve().parents[1])
    paths = [package, *filter(None, [environment.get('PYTHONPATH')])]
    return environment | {
        'PYTHONPATH': os.pathsep.join(paths),
        'PYTHONUNBUFFERED': '1',
        'ROS_DOMAIN_ID': str(domain),
        'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
        'ROS_LOG_DIR': str(logs),
        'RCUTILS_COLORIZED_OUTPUT': '0',
        'RCUTILS_CONSOLE_OUTPUT_FORMAT': '{message}',
    }


def _send(process: subprocess.Popen[str], number: signal.Signals) -> None:
    """Send a signal to all processes in the group of a process; do nothing where it is gone."""
    try:
        os.killpg(process.pid, number)
    except ProcessLookupError:
        pass
