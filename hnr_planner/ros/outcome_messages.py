"""`diagnostic_msgs/DiagnosticArray`: the outcome of a request, and the health of the node."""

from collections.abc import Mapping
import math

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from hnr_planner.ros.outcomes import Outcome
from hnr_planner.ros.requests import Report
from hnr_planner.ros.sampling import SampleReport
from std_msgs.msg import Header


def outcome_values(report: Report | SampleReport) -> dict[str, str]:
    """Return everything worth knowing about an answer; seconds and metres, NaN where unknown."""
    return _of_a_path(report) if isinstance(report, Report) else _of_draws(report)


def _of_a_path(report: Report) -> dict[str, str]:
    """Return the values of a request for a path."""
    values = {
        'why': report.why,
        'algorithm': report.request.algorithm,
        'elapsed': f'{report.elapsed:.6f}',
        'clearance': f'{report.clearance:.6g}',
        'offset': f'{report.offset:.6g}',
        'escape': f'{report.escape if report.solved else math.nan:.6g}',
    }
    if report.blocked is not None:
        values |= {f'blocked_{part}': f'{n:.6g}' for part, n in report.blocked._asdict().items()}
    result = report.result
    if result is not None:
        first_elapsed, first_length = result.first_solution or (math.nan, math.nan)
        values |= {
            'algorithm': result.planner,
            'seed': str(result.seed),
            'iterations': str(result.iterations),
            'samples': str(len(result.samples)),
            'planning_time': f'{result.elapsed:.6f}',
            'first_solution_time': f'{first_elapsed:.6f}',
            'first_solution_length': f'{first_length:.6g}',
            'length': f'{result.length if report.solved else math.nan:.6g}',
            'cut_by_time': str(bool(result.cut_by_time)).lower(),
        }
    return values


def _of_draws(report: SampleReport) -> dict[str, str]:
    """Return the values of a request for draws."""
    settings, draws = report.settings, report.draws
    values = {
        'why': report.why,
        'algorithm': settings.sample_walk,
        'elapsed': f'{report.elapsed:.6f}',
    }
    if draws is not None:
        n_steps = (len(report.points) - report.n_parts) * settings.sample_thin
        values |= {
            'seed': str(draws.seed),
            'iterations': str(n_steps),
            'samples': str(len(report.points)),
            'parts': str(report.n_parts),
        }
    return values


def outcome_message(report: Report | SampleReport, name: str, stamp: Time) -> DiagnosticArray:
    """Return the outcome of one request; `name` says which node and service answered it."""
    level = DiagnosticStatus.OK if report.outcome.is_success else DiagnosticStatus.WARN
    return _array(level, name, report.outcome.name, outcome_values(report), report.frame, stamp)


def health_message(
    healthy: bool, name: str, message: str, values: Mapping[str, str], stamp: Time
) -> DiagnosticArray:
    """Return the health of the node in the form that diagnostic viewers show."""
    level = DiagnosticStatus.OK if healthy else DiagnosticStatus.WARN
    return _array(level, name, message, values, '', stamp)


def read_outcome(message: DiagnosticArray) -> tuple[Outcome, dict[str, str]]:
    """Return the name and the values of an outcome that was received."""
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
    """Return an array of one status."""
    status = DiagnosticStatus(
        level=level,
        name=name,
        message=message,
        hardware_id='',
        values=[KeyValue(key=key, value=value) for key, value in values.items()],
    )
    return DiagnosticArray(header=Header(stamp=stamp, frame_id=frame), status=[status])
