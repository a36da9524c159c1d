"""The process of the page that shows this node, where the parameter ``watch_port`` asks for it."""

import os
import subprocess
import sys
import threading
from typing import IO

from rclpy.node import Node

#: Time [s] for the process to end in order.
PATIENCE = 2.0


class WatchProcess:
    """
    Runs the command ``watch`` for a node, from construction to ``close``.

    What it prints is logged: the address of the page, or why there is none. It ends with this
    process, however that ends.

    Parameters
    ----------
    node : Node
        The planning node, whose topic of maps may be remapped.
    port : int
        Port of this machine that it serves.

    """

    def __init__(self, node: Node, port: int) -> None:
        self._logger = node.get_logger()
        self._is_closed = False
        arguments = {
            '--node': node.get_fully_qualified_name(),
            '--map': node.resolve_topic_name('map'),
            '--port': str(port),
            '--end-with': str(os.getpid()),
        }
        path = os.pathsep.join(os.path.abspath(folder) for folder in sys.path)
        self._process = subprocess.Popen(
            [sys.executable, '-P', '-m', 'hnr_planner', 'watch', *sum(arguments.items(), ())],
            env={**os.environ, 'PYTHONPATH': path},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        assert self._process.stdout is not None
        self._thread = threading.Thread(
            target=self._log, args=(self._process.stdout,), name='watch', daemon=True
        )
        self._thread.start()

    def close(self) -> None:
        """End the process."""
        self._is_closed = True
        self._process.terminate()
        try:
            self._process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            self._process.kill()
        self._thread.join(PATIENCE)

    def _log(self, lines: IO[str]) -> None:
        for line in lines:
            if line.startswith('http'):
                self._logger.info(f'watch_port: {line.strip()}')
            elif not self._is_closed:
                self._logger.warning(f'watch_port: {line.strip()}')
        code = self._process.wait()
        if not self._is_closed:
            self._logger.warning(f'watch_port: the page is not served any more ({code})')
