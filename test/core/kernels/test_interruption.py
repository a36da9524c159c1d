"""Conditions that end interpreted kernels: theirs is the thread, and blocks nest."""

import threading

from hnr_planner.core.errors import Interrupted
from hnr_planner.core.kernels import interruption
from hnr_planner.core.kernels.interruption import check, interruptible
import pytest


@pytest.fixture(autouse=True)
def look_every_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let every ``check`` look at the condition, whatever the clock says."""
    monkeypatch.setattr(interruption, 'CHECK_INTERVAL', 0.0)


def test_nothing_is_interrupted_outside_of_a_block():
    check()
    with interruptible(lambda: True):
        pass
    check()


def test_the_condition_ends_the_work():
    stop = threading.Event()
    with interruptible(stop.is_set):
        check()
        stop.set()
        with pytest.raises(Interrupted):
            check()
    check()


@pytest.mark.parametrize('which', [0, 1], ids=['the outer condition', 'the inner condition'])
def test_a_block_in_a_block_asks_both_conditions(which: int):
    held = [False, False]
    with interruptible(lambda: held[0]):
        with interruptible(lambda: held[1]):
            check()
            held[which] = True
            with pytest.raises(Interrupted):
                check()
        held[1] = False
        held[0] = False
        check()


def test_the_condition_of_one_thread_is_not_that_of_another():
    with interruptible(lambda: True):
        other = threading.Thread(target=check)
        failed: list[object] = []
        threading.excepthook, before = failed.append, threading.excepthook
        try:
            other.start()
            other.join()
        finally:
            threading.excepthook = before
        assert not failed
        with pytest.raises(Interrupted):
            check()


def test_a_condition_is_looked_at_once_a_millisecond(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(interruption, 'CHECK_INTERVAL', 1e-3)
    now = [5.0]
    monkeypatch.setattr(interruption.time, 'perf_counter', lambda: now[0])
    looks: list[float] = []
    with interruptible(lambda: bool(looks.append(now[0]))):
        for _ in range(10):
            check()
            now[0] += 0.00051
    assert len(looks) == 5
