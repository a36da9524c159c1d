"""Responses of a process in which nothing is compiled: they end in time, and state the tier."""

import os
import subprocess
import sys

from hnr_planner.core.kernels.modes import VARIABLE

#: Requests that take far longer than they may, and one that is done at once.
SCRIPT = """
from dataclasses import replace
import threading

from hnr_planner.maps import OccupancyMap
from hnr_planner.server.map.map_store import MapStore
from hnr_planner.server.requests.plan_request import PlanRequest, Pose
from hnr_planner.server.planning.respond import respond
from hnr_planner.server.sampling import draw
from hnr_planner.server.parameters.settings import Settings
import numpy as np

data = np.zeros((401, 401), dtype=np.int8)
data[1::2] = 100
data[1::4, -1] = data[3::4, 0] = 0
settings = Settings(time_limit=0.05, goal_radius=0.2, sample_count=100_000)
maps = MapStore(settings)
maps.receive(lambda: OccupancyMap(data, 0.5))
start, end = Pose((0.25, 0.25, 0.0)), Pose((0.25, 200.25, 0.0))
cut, cancelled = threading.Event(), threading.Event()
cancelled.set()


def ask(goal, algorithm, tolerance=0.0, limits=settings):
    return respond(PlanRequest(start, goal, tolerance, algorithm), limits, maps.newest, cut)


for response in (
    ask(end, 'rrt'),
    ask(end, 'kinodynamic_hit_and_run'),
    ask(Pose((5000.0, 5000.0, 0.0)), 'kinodynamic_rrt', 1e5),
    draw(settings, maps.newest, cut),
    draw(settings, maps.newest, cancelled),
    ask(start, 'rrt', limits=replace(settings, time_limit=3600.0)),
):
    print(response.outcome.name, response.values['tier'], response.why)
"""
OUTCOMES = ['TIMEOUT', 'TIMEOUT', 'TIMEOUT', 'TIMEOUT', 'CANCELLED', 'SOLVED']


def test_responses_end_in_time_and_state_the_tier() -> None:
    done = subprocess.run(
        [sys.executable, '-c', SCRIPT],
        capture_output=True,
        text=True,
        timeout=600,
        check=True,
        env={**os.environ, VARIABLE: 'interpreted'},
    )
    lines = done.stdout.splitlines()
    assert [line.partition(' ')[0] for line in lines] == OUTCOMES, done.stdout
    for line in lines[:4]:
        assert line.endswith('; it ran interpreted: this process compiles nothing'), line
    assert all(line.split()[1] == 'interpreted' for line in (*lines[:4], lines[5]))
