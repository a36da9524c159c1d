"""The executable ``planner_node``: serves at once, and compiles kernels in the background."""

from collections.abc import Sequence
import os
from pathlib import Path
import sys
import time
from typing import NoReturn

from hnr_planner.core.warming import compile_in_background
from hnr_planner.ros.node.help import help_text
from hnr_planner.ros.node.package_log import forward_package_log
from hnr_planner.ros.node.planner import PlannerNode, SERVICES, THREADS
from hnr_planner.ros.node.process import run
from hnr_planner.server.responses.request_log import shortened
from rclpy.impl.rcutils_logger import RcutilsLogger

#: How long [s] a thread of Python runs while others wait. Searches that run interpreted take all
#: the time there is, and a service is served by several threads after each other: by Python's own
#: 5 ms, four searches would hold up each of them by 20 ms.
SWITCH_INTERVAL = 5e-4

#: Name of the node.
NAME = 'hnr_planner'


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """
    Run the planning node until SIGINT or SIGTERM, and end the process with its exit code.

    Where ``-h`` or ``--help`` is among ``arguments`` (by default those of the command line), print
    the help text and exit.
    """
    if {'-h', '--help'} & set(sys.argv[1:] if arguments is None else arguments):
        print(help_text(SERVICES))
        sys.exit(0)
    sys.setswitchinterval(SWITCH_INTERVAL)
    code = run(
        NAME,
        _make_node,
        threads=THREADS,
        prepare=_prepare,
        before_shutdown=PlannerNode.end,
    )
    sys.exit(code)


def _make_node() -> PlannerNode:
    node = PlannerNode()
    if node.settings.autostart:
        node.trigger_configure()
        node.trigger_activate()
    services = ', '.join(node.resolve_service_name(f'~/{name}') for name in SERVICES)
    ready = f'ready after {_process_age():.1f} s, {node.state}'
    node.get_logger().info(shortened(f'{ready}, {node.settings.robot}: {services}'))
    return node


def _process_age() -> float:
    """Return the time since this process was started [s]."""
    # The 22nd field, in ticks since the machine was booted; the second may hold blanks.
    fields = Path('/proc/self/stat').read_text().rpartition(')')[2].split()
    started = int(fields[19]) / os.sysconf('SC_CLK_TCK')
    return time.clock_gettime(time.CLOCK_BOOTTIME) - started


def _prepare(logger: RcutilsLogger) -> None:
    """Forward the package's log to ``logger``, and begin to load or compile the kernels."""
    logger.info('preparing')
    forward_package_log(logger)
    compile_in_background()


if __name__ == '__main__':
    main()
