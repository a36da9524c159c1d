"""Forwarding of the package's Python log (module ``logging``) to the log of a ROS node."""

import logging

from hnr_planner.server.responses.request_log import shortened
from rclpy.impl.rcutils_logger import RcutilsLogger

#: Name of the Python logger that the whole package logs to.
PACKAGE = 'hnr_planner'


class _Forwarding(logging.Handler):
    """A handler of Python logs that passes each record on to a ROS logger."""

    def __init__(self, logger: RcutilsLogger) -> None:
        super().__init__()
        self._logger = logger

    def emit(self, record: logging.LogRecord) -> None:
        """Log the message of ``record`` to the ROS logger, at the level of the record."""
        text = shortened(record.getMessage())
        # One call for each level: rclpy refuses to log at two levels from one line of source.
        if record.levelno >= logging.ERROR:
            self._logger.error(text)
        elif record.levelno >= logging.WARNING:
            self._logger.warning(text)
        elif record.levelno >= logging.INFO:
            self._logger.info(text)
        else:
            self._logger.debug(text)


def forward_package_log(logger: RcutilsLogger) -> None:
    """
    Pass all that the package logs on to ``logger``, and to no other handler.

    The level of ``logger`` alone decides what is shown.
    """
    log = logging.getLogger(PACKAGE)
    log.setLevel(logging.DEBUG)
    log.propagate = False
    log.handlers = [_Forwarding(logger)]
