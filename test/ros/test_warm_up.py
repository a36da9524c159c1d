"""A request never waits for a compiler: once the node has prepared, all is compiled."""

import subprocess
import sys

SCRIPT = """
import sys
import threading

from hnr_planner.core import ALGORITHMS, warm_up
from hnr_planner.maps import OccupancyMap
from hnr_planner.server.map.map_store import MapStore
from hnr_planner.server.planning.respond import respond
from hnr_planner.server.requests.plan_request import PlanRequest, Pose
from hnr_planner.server.parameters.settings import Settings
from numba.core.dispatcher import Dispatcher
import numpy as np


def compiled():
    return {
        (kernel.py_func.__module__, name, signature)
        for module in list(sys.modules.values())
        if module.__name__.startswith('hnr_planner.core')
        for name, kernel in vars(module).items()
        if isinstance(kernel, Dispatcher)
        for signature in kernel.overloads
    }


warm_up()
before = compiled()
rooms = np.zeros((60, 60), dtype=np.int8)
rooms[:, 20], rooms[:50, 40], rooms[30:34, 20], rooms[0, 0] = 100, 100, 0, -1
start, near, far = (Pose((x, 0.5, 0.0)) for x in (0.5, 1.02, 2.8))
for changes in (
    {},
    {'robot_radius': 0.06, 'unknown': 'free'},
    {'goal_radius': 0.2},
    {'escape_radius': 0.5},
):
    settings = Settings(optimize_for=0.05, time_limit=0.5, **changes)
    maps = MapStore(settings)
    maps.receive(lambda: OccupancyMap(rooms, 0.05, (0.0, 0.0, 0.1), 'map'))
    for algorithm in ALGORITHMS:
        for begin, goal in ((start, start), (start, near), (start, far), (near, far)):
            for tolerance in (0.0, 0.3):
                request = PlanRequest(begin, goal, tolerance, algorithm)
                respond(request, settings, maps.newest, threading.Event())
late = {f'{module}.{name}' for module, name, _ in compiled() - before}
sys.exit(f'compiled during requests: {sorted(late)}' if late else 0)
"""


def test_no_request_compiles_anything() -> None:
    done = subprocess.run(
        [sys.executable, '-c', SCRIPT], capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stderr
