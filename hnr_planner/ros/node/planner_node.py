"""The executable ``planner_node``: prepare, then serve."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
import os
from pathlib import Path
import sys
import threading
import time
from typing import NoReturn

from hnr_planner.core import warm_up
from hnr_planner.ros.node.help import help_text
from hnr_planner.ros.node.planner import PlannerNode, SERVICES, THREADS
from hnr_planner.ros.node.process import run
from hnr_planner.server.request_log import shortened
from rclpy.impl.rcutils_logger import RcutilsLogger

#: Name of the node.
NAME = 'hnr_planner'

#: Seconds between the lines about a preparation that goes on.
PROGRESS_EVERY = 3.0


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run the planning node until a signal comes, and exit; with ``--help`` print how to."""
    if {'-h', '--help'} & set(sys.argv[1:] if arguments is None else arguments):
        print(help_text(SERVICES))
        sys.exit(0)
    code = run(
        NAME,
        _make_node,
        threads=THREADS,
        prepare=_prepare,
        before_shutdown=PlannerNode.end_searches,
    )
    sys.exit(code)


def _make_node() -> PlannerNode:
    node = PlannerNode()
    if node.settings.autostart:
        node.trigger_configure()
        node.trigger_activate()
    services = ', '.join(node.resolve_service_name(f'~/{name}') for name in SERVICES)
    ready = f'ready after {_process_age():.1f} s, {node.state}'
    radius = f'robot radius {node.settings.robot_radius:g} m'
    node.get_logger().info(shortened(f'{ready}, {radius}: {services}'))
    return node


def _process_age() -> float:
    """Return the time since this process was started [s]."""
    # The 22nd field, in ticks since the machine was booted; the second may hold blanks.
    fields = Path('/proc/self/stat').read_text().rpartition(')')[2].split()
    started = int(fields[19]) / os.sysconf('SC_CLK_TCK')
    return time.clock_gettime(time.CLOCK_BOOTTIME) - started


def _prepare(logger: RcutilsLogger) -> None:
    """Compile everything that a request needs, or load it from the cache."""
    logger.info('preparing: loading or compiling the planners (a minute or two the first time)')
    with _progress(logger):
        warm_up()


@contextmanager
def _progress(logger: RcutilsLogger) -> Iterator[None]:
    """Log every few seconds that the ``with`` block is still at work."""
    done = threading.Event()
    began = time.monotonic()

    def log() -> None:
        while not done.wait(PROGRESS_EVERY):
            logger.info(f'still preparing ({time.monotonic() - began:.0f} s)')

    thread = threading.Thread(target=log, daemon=True)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()


if __name__ == '__main__':
    main()
