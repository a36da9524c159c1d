"""The line on the log about each request."""

from dataclasses import replace
from test.server.test_requests import ask, rooms, store

from hnr_planner.server.requests.outcomes import Outcome
from hnr_planner.server.responses.request_log import LONGEST_LINE, RequestLog, SLOW
import pytest

SOLVED = replace(ask(store(rooms())), elapsed=0.1)
FAILED = ask(store(rooms()), (2.0, 0.2))


def test_only_the_first_success_is_an_info() -> None:
    log = RequestLog()
    levels = [log.entry('plan', SOLVED, 1.0).level for _ in range(3)]
    assert levels == ['info', 'debug', 'debug']
    log.start()
    assert log.entry('plan', SOLVED, 1.0).level == 'info'


def test_slow_success_is_an_info() -> None:
    log = RequestLog()
    log.entry('plan', SOLVED, 1.0)
    slow = replace(SOLVED, elapsed=SLOW * 1.01)
    assert log.entry('plan', slow, 1.0).level == 'info'
    assert log.entry('plan', slow, 10.0).level == 'debug'


def test_failure_is_a_warning_and_leaves_the_first_success_an_info() -> None:
    log = RequestLog()
    assert log.entry('plan', FAILED, 1.0).level == 'warning'
    assert log.entry('plan', FAILED, 1.0).level == 'warning'
    assert log.entry('plan', SOLVED, 1.0).level == 'info'


def test_line_names_caller_outcome_time_and_reason() -> None:
    entry = RequestLog().entry('compute_path_to_pose', FAILED, 1.0)
    start = f'compute_path_to_pose: {Outcome.INVALID_START.name} after '
    assert entry.text.startswith(start)
    assert FAILED.why in entry.text and ' s: ' in entry.text


def test_remark_is_always_an_info() -> None:
    log = RequestLog()
    log.entry('plan', SOLVED, 1.0)
    entry = log.entry('plan', SOLVED, 1.0, 'as if left out')
    assert entry.level == 'info' and 'as if left out' in entry.text


@pytest.mark.parametrize('length', [10, 499, 500, 5000])
def test_no_line_is_longer_than_it_may_be(length: int) -> None:
    text = RequestLog().entry('plan', replace(SOLVED, why='x' * length), 1.0).text
    assert len(text) <= LONGEST_LINE
    assert ('…' in text) == (length > 400)
