"""The executable `planner_node`: compile, then serve."""

from collections.abc import Iterator
from contextlib import contextmanager
import sys
import threading
import time
from typing import NoReturn

from hnr_planner.core import warm_up
from hnr_planner.ros.node.planner import PlannerNode, SERVICES, THREADS
from hnr_planner.ros.node.process import run
from rclpy.impl.rcutils_logger import RcutilsLogger

NAME = 'hnr_planner'
PROGRESS_EVERY = 3.0
"""Seconds between the lines that say that the preparation goes on."""


def main() -> NoReturn:
    """Run the planning node until a signal comes, and exit."""
    began = time.monotonic()

    def make_node() -> PlannerNode:
        node = PlannerNode()
        if node.settings.autostart:
            node.trigger_configure()
            node.trigger_activate()
        services = ', '.join(node.resolve_service_name(f'~/{name}') for name in SERVICES)
        node.get_logger().info(
            f'ready after {time.monotonic() - began:.1f} s, {node.state}: {services}'
        )
        return node

    code = run(
        NAME,
        make_node,
        threads=THREADS,
        prepare=_prepare,
        before_shutdown=PlannerNode.end_searches,
    )
    sys.exit(code)


def _prepare(logger: RcutilsLogger) -> None:
    """Compile everything that a request needs, or load it from the cache."""
    logger.info('preparing: loading or compiling the planners (a minute or two the first time)')
    with _progress(logger):
        warm_up()


@contextmanager
def _progress(logger: RcutilsLogger) -> Iterator[None]:
    """Log every few seconds that the `with` block is still at work."""
    done = threading.Event()
    began = time.monotonic()

    def tell() -> None:
        while not done.wait(PROGRESS_EVERY):
            logger.info(f'still compiling ({time.monotonic() - began:.0f} s)')

    thread = threading.Thread(target=tell, daemon=True)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()


if __name__ == '__main__':
    main()
