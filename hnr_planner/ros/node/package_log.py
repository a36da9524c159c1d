"""The log of the package itself, which knows nothing of ROS, passed on to the log of a node."""

import logging

from hnr_planner.server.request_log import shortened
from rclpy.impl.rcutils_logger import RcutilsLogger

#: Name of the logger that the package logs to.
PACKAGE = 'hnr_planner'


class _Forwarding(logging.Handler):
    """A handler that hands each line to a logger of ROS."""

    def __init__(self, logger: RcutilsLogger) -> None:
        super().__init__()
        self._logger = logger

    def emit(self, record: logging.LogRecord) -> None:
        """Log a line at the level that it has."""
        text = shortened(record.getMessage())
        # A line of source for each level: rclpy refuses to log at two levels from one.
        if record.levelno >= logging.ERROR:
            self._logger.error(text)
        elif record.levelno >= logging.WARNING:
            self._logger.warning(text)
        elif record.levelno >= logging.INFO:
            self._logger.info(text)
        else:
            self._logger.debug(text)


def forward_package_log(logger: RcutilsLogger) -> None:
    """Pass all that the package logs on to ``logger``, whose level decides, and nowhere else."""
    log = logging.getLogger(PACKAGE)
    log.setLevel(logging.DEBUG)
    log.propagate = False
    log.handlers = [_Forwarding(logger)]
