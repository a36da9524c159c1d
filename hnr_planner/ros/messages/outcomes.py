"""Outcomes of requests and the health of the node as ``diagnostic_msgs/DiagnosticArray``."""

from collections.abc import Mapping

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from hnr_planner.server.requests.outcomes import Outcome
from hnr_planner.server.responses.response import Response
from std_msgs.msg import Header


def outcome_message(response: Response, name: str, stamp: Time) -> DiagnosticArray:
    """
    Return the message with the outcome of one request, and its values.

    ``name`` is the full name of the node, and the service, action or topic of the request. The
    level is OK for a success and WARN for a failure.
    """
    level = DiagnosticStatus.OK if response.outcome.is_success else DiagnosticStatus.WARN
    return _array(level, name, response.outcome.name, response.values, response.frame, stamp)


def health_message(
    healthy: bool, name: str, message: str, values: Mapping[str, str], stamp: Time
) -> DiagnosticArray:
    """Return the message with the health of a node: level OK if ``healthy``, else WARN."""
    level = DiagnosticStatus.OK if healthy else DiagnosticStatus.WARN
    return _array(level, name, message, values, '', stamp)


def read_outcome(message: DiagnosticArray) -> tuple[Outcome, dict[str, str]]:
    """Return the outcome and the values, text by name, of a message of ``outcome_message``."""
    status = message.status[0]
    return Outcome[status.message], {item.key: item.value for item in status.values}


def _array(
    level: bytes,
    name: str,
    message: str,
    values: Mapping[str, str],
    frame: str,
    stamp: Time,
) -> DiagnosticArray:
    """Return a message with a single status, whose text is ``message``."""
    status = DiagnosticStatus(
        level=level,
        name=name,
        message=message,
        hardware_id='',
        values=[KeyValue(key=key, value=value) for key, value in values.items()],
    )
    return DiagnosticArray(header=Header(stamp=stamp, frame_id=frame), status=[status])
