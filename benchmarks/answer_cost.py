"""
Measure what an answer costs the planning node besides its search, in time of the processor.

Each request has a start that sees its goal, so that nothing is searched.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from statistics import median
import sys
import threading
import time

from hnr_planner.ros.messages.paths import serialised_path
from hnr_planner.ros.messages.plan_responses import PlanResponses
from hnr_planner.ros.node.planner_node import SWITCH_INTERVAL
import numpy as np
from rclpy.serialization import serialize_message
from std_msgs.msg import Header

#: Time [s] for a node to publish everything about a request.
PAUSE = 0.03
#: Answers made while another thread waits for the interpreter.
N_MADE = 200


def cpu_time(pid: int) -> float:
    """Return the CPU time [s] that a process has used, by the clock that Linux has for it."""
    return time.clock_gettime((~pid << 3) | 2)


def cost_of(ask: Callable[[], object], pid: int) -> float:
    """Return the CPU time [s] that a process uses while and after it is asked."""
    began = cpu_time(pid)
    ask()
    time.sleep(PAUSE)
    return cpu_time(pid) - began


def longest_hold(n_poses: int) -> float:
    """
    Return how long [s] a thread waits for the interpreter while an answer is made and converted.

    It is the median over ``N_MADE`` answers of the longest wait during each.
    """
    rows = np.random.default_rng(0).normal(size=(n_poses, 7))
    header, responses, waits = Header(frame_id='map'), PlanResponses(), []
    before = sys.getswitchinterval()
    sys.setswitchinterval(SWITCH_INTERVAL)
    try:
        for _ in range(N_MADE):
            with _waiting() as turns:
                path = serialised_path(rows, header)
                serialize_message(responses.make(rows, header, path))
            waits.append(max(turns))
    finally:
        sys.setswitchinterval(before)
    return median(waits)


@contextmanager
def _waiting() -> Iterator[list[float]]:
    """Collect the times [s] from one turn of another thread to the next while a block runs."""
    turns, ended, began = [0.0], threading.Event(), time.perf_counter()

    def take_turns() -> None:
        last = began
        while not ended.is_set():
            now = time.perf_counter()
            turns.append(now - last)
            last = now

    thread = threading.Thread(target=take_turns)
    thread.start()
    try:
        yield turns
    finally:
        ended.set()
        thread.join()
