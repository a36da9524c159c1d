"""The limits of a request end interpreted work that would go on for ever."""

import threading
import time

from hnr_planner.core.kernels.kernel import interpreted, kernel
from hnr_planner.server.requests.limits import RequestLimits, SHORTEST_TIME
from hnr_planner.server.requests.outcomes import Outcome, Refusal
import pytest


@kernel
def endless():
    """Count for ever."""
    n = 0
    while True:
        n += 1


def count() -> str:
    """Count for ever, interpreted."""
    interpreted(endless)()
    return 'done'


def cancelled() -> RequestLimits:
    """Return the limits of a request without a time limit that is cancelled already."""
    cancel = threading.Event()
    cancel.set()
    return RequestLimits.from_now(3600.0, cancel)


@pytest.mark.parametrize(
    ('limits', 'outcome'),
    [
        (RequestLimits.from_now(0.0, threading.Event()), Outcome.TIMEOUT),
        (cancelled(), Outcome.CANCELLED),
    ],
)
def test_a_limit_ends_interpreted_work(limits: RequestLimits, outcome: Outcome) -> None:
    assert limits.within(count, 'cut') == 'cut'
    with pytest.raises(Refusal) as refusal, limits.enforced():
        count()
    assert refusal.value.outcome is outcome


def test_work_gets_a_least_time_when_all_is_over() -> None:
    began = time.perf_counter()
    assert cancelled().within(count, 'cut', least=0.05) == 'cut'
    assert time.perf_counter() - began >= 0.05


def test_work_that_ends_is_left_alone() -> None:
    limits = RequestLimits.from_now(3600.0, threading.Event())
    assert limits.within(lambda: 'done', 'cut') == 'done'
    with limits.enforced():
        limits.check()
    assert 0.0 < limits.time_left <= 3600.0 and not limits.must_end()
    assert cancelled().must_end() and not cancelled().time_is_up


def test_a_search_gets_a_moment_even_when_the_time_is_up() -> None:
    limits = RequestLimits.from_now(0.0, threading.Event())
    assert limits.time_is_up and limits.time_left == SHORTEST_TIME
