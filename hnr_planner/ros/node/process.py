"""
The process of a node: prepare, make the node, spin it, and end cleanly on a signal.

Executors do not notice a signal before their next wake-up, and rclpy's own signal handlers shut
the context down while callbacks run. Here a signal only wakes the main thread: callers that wait
get their responses, what waits to be published is published, and then the node is destroyed.
SIGINT and SIGTERM, once or repeated, end the process with exit code 0 unless something failed.
"""

from collections.abc import Callable
from contextlib import suppress
import gc
import os
import signal
import sys
import threading
import traceback
from types import FrameType
from typing import TypeVar

from hnr_planner.core.errors import HnrError
from hnr_planner.ros.node.executor import Executor
from hnr_planner.ros.node.memory import give_back_large_blocks
import rclpy
from rclpy.exceptions import ParameterException
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.impl.rcutils_logger import RcutilsLogger
from rclpy.logging import get_logger
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

NodeType = TypeVar('NodeType', bound=Node)


def run(
    name: str,
    make_node: Callable[[], NodeType],
    *,
    threads: int,
    prepare: Callable[[RcutilsLogger], None] | None = None,
    before_shutdown: Callable[[NodeType], None] | None = None,
) -> int:
    """
    Run a node until SIGINT or SIGTERM and return the process' exit code.

    Parameters
    ----------
    name : str
        Name of the logger for the time before there is a node.
    make_node : callable
        Returns the node. An HnrError or an error of rclpy that it raises, such as a parameter of
        the wrong type, is logged on one line, and the exit code is 1.
    threads : int
        Number of threads that run callbacks.
    prepare : callable, optional
        Called with the logger before ROS is started; a signal ends the process at once meanwhile.
    before_shutdown : callable, optional
        Called with the node after a signal or a failed callback, while callbacks still run: it
        makes those end that have begun, which are then waited for.

    """
    give_back_large_blocks()
    stop = _StopSignal()
    logger = get_logger(name)
    if prepare is not None:
        prepare(logger)
    stop.wait_for_owner()
    try:
        rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
        node = make_node()
    # Most of rclpy's own errors are RuntimeErrors.
    except (HnrError, ParameterException, RuntimeError) as error:
        logger.fatal(_in_words(error))
        rclpy.try_shutdown()
        return 1
    try:
        return _spin(node, threads, stop, before_shutdown)
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
        # All that is left ends with the process: to collect it first would take ten times longer.
        gc.freeze()


def _in_words(error: Exception) -> str:
    """Return why a node could not be made, in one line."""
    words = ' '.join(str(error).split())
    if isinstance(error, rclpy_implementation.UnknownROSArgsError):
        return f'unknown arguments after --ros-args: {words}'
    return words


def _spin(
    node: NodeType,
    threads: int,
    stop: '_StopSignal',
    before_shutdown: Callable[[NodeType], None] | None,
) -> int:
    """
    Spin the node in another thread until a signal comes or a callback raises.

    Return the exit code: 1 when a callback raised, else 0.
    """
    executor = Executor(threads)
    executor.add_node(node)
    failures: list[Exception] = []
    ending = threading.Event()
    wake_up = node.create_guard_condition(lambda: None)

    def spin() -> None:
        try:
            while not ending.is_set():
                # What is destroyed while the executor looks at it is gone at its next look.
                with suppress(rclpy_implementation.InvalidHandle):
                    executor.spin_once()
        except Exception as error:
            failures.append(error)
            stop.request()

    spinning = threading.Thread(target=spin, name='spin', daemon=True)
    spinning.start()
    stop.wait()
    if before_shutdown is not None:
        before_shutdown(node)
    ending.set()
    wake_up.trigger()
    spinning.join()
    executor.finish()
    for failure in failures:
        traceback.print_exception(failure)
    return 1 if failures else 0


class _StopSignal:
    """
    The handling of SIGINT and SIGTERM.

    They end the process at once until ``wait_for_owner`` is called; from then on they only wake
    the thread in ``wait``.
    """

    def __init__(self) -> None:
        self._reader, self._writer = os.pipe()
        os.set_blocking(self._writer, False)
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, _leave_at_once)

    def wait_for_owner(self) -> None:
        """Remember signals for ``wait`` from now on, in the place of ending the process."""
        # Python runs a handler only when the main thread is back from C; the pipe is written to
        # by the C handler itself, in whatever thread the signal comes.
        signal.set_wakeup_fd(self._writer, warn_on_full_buffer=False)
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, _remembered_by_pipe)

    def request(self) -> None:
        """Make ``wait`` return as if a signal had come."""
        os.write(self._writer, b'\0')

    def wait(self) -> None:
        """Wait for a signal or a ``request``; return at once if there was one already."""
        os.read(self._reader, 1)


def _leave_at_once(_number: int, _frame: FrameType | None) -> None:
    """End the process with exit code 0: no node has been made that would need a shutdown."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0)


def _remembered_by_pipe(_number: int, _frame: FrameType | None) -> None:
    """Do nothing: the C handler has written the signal to the wake-up pipe already."""
