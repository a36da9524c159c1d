"""Services of a real node while it searches interpreted: how long others wait for a response."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
import os
from pathlib import Path
import tempfile
from test.ros.domain import own_domain
from test.ros.harness import Client, grid_message, maze, node_process, pose, result_of
import threading
import time
from typing import Any

from hnr_planner.core.kernels.modes import VARIABLE
from rcl_interfaces.srv import GetParameters

#: The service that is called.
PARAMETERS = '/hnr_planner/get_parameters'
#: Searches that run meanwhile.
SEARCHES = (1, 4)
#: Time limit [s] of the searches: longer than all calls take.
LONG = 600.0
#: Ends of a maze that no search gets through, and a place in it.
START, GOAL = pose(0.025, 0.025), pose(20.025, 20.025)


def latencies(n_calls: int) -> dict[str, list[float]]:
    """Return how long calls took [s], by what was called and how many searches ran meanwhile."""
    found = {}
    with _node() as client:
        parameter = GetParameters.Request(names=['time_limit'])
        calls: dict[str, Callable[[], Any]] = {
            'parameters': lambda: client.send(GetParameters, PARAMETERS, parameter),
            'a path that needs no search': lambda: client.send_plan(START, START),
        }
        for n_searches in SEARCHES:
            futures = [client.send_plan(START, GOAL, 'plan_rrt') for _ in range(n_searches)]
            client.wait_for_running(n_searches)
            for name, call in calls.items():
                _timed(call)
                words = f'{name}, {n_searches} search{"es" if n_searches > 1 else ""}'
                found[words] = [_timed(call) for _ in range(n_calls)]
            assert not any(future.done() for future in futures)
            client.cancel()
            for future in futures:
                result_of(future)
    return found


@contextmanager
def _node() -> Iterator[Client]:
    """Run a node that never compiles, with a maze as its map."""
    with tempfile.TemporaryDirectory() as folder, own_domain() as domain:
        os.environ |= {
            VARIABLE: 'interpreted',
            'ROS_DOMAIN_ID': str(domain),
            'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
        }
        log = Path(folder) / 'log'
        with node_process('planner_node', log, time_limit=LONG, optimize_for=0.0) as planner:
            client = Client()
            try:
                client.publish_map(grid_message(maze()))
                planner.wait_for('map received')
                yield client
            finally:
                client.close()


def _timed(send: Callable[[], Any]) -> float:
    """Send a request and return how long its response took [s]."""
    done = threading.Event()
    began = time.perf_counter()
    send().add_done_callback(lambda _: done.set())
    assert done.wait(LONG), 'no response'
    return time.perf_counter() - began
