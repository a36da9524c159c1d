"""The clock of time limits stands still while a thread compiles or loads."""

import time

from hnr_planner.core.kernels.clock import not_working, working_time
import pytest


@pytest.fixture
def perf_counter(monkeypatch: pytest.MonkeyPatch):
    """Return a clock that a test moves on by hand: ``perf_counter.now += 1``."""

    class Clock:
        now = 100.0

        def __call__(self) -> float:
            return self.now

    clock = Clock()
    monkeypatch.setattr(time, 'perf_counter', clock)
    return clock


def test_time_in_a_block_does_not_count(perf_counter):
    begin = working_time()
    perf_counter.now += 1.0
    with not_working():
        perf_counter.now += 10.0
        assert working_time() - begin == 1.0
    perf_counter.now += 2.0
    assert working_time() - begin == 3.0


def test_a_block_in_a_block_is_taken_off_once(perf_counter):
    begin = working_time()
    with not_working():
        perf_counter.now += 10.0
        with pytest.raises(RuntimeError), not_working():
            perf_counter.now += 5.0
            raise RuntimeError
        assert working_time() == begin
    perf_counter.now += 1.0
    assert working_time() - begin == 1.0
