"""Messages of results that a limit cut: they name the tier where that is why it was slow."""

import os
from pathlib import Path
import re
import subprocess
import sys

from hnr_planner.core.kernels.modes import VARIABLE
import pytest

#: Searches through a serpentine that they do not get through, and two requests that are not cut.
SCRIPT = """
import threading

from hnr_planner.core import GridSpace, plan, plan_trajectory
from hnr_planner.core.systems import DoubleIntegrator
import numpy as np

blocked = np.zeros((201, 201), dtype=bool)
blocked[1::2] = True
blocked[1::4, -1] = blocked[3::4, 0] = False
space, start, goal = GridSpace.from_blocked(blocked), (0.5, 0.5), (0.5, 200.5)
cancel = threading.Event()
threading.Timer(0.05, cancel.set).start()
system, at_rest = DoubleIntegrator(), (*start, 0.0, 0.0)
for result in (
    plan(space, start, goal, algorithm='rrt', cancel=cancel, time_limit=3600.0),
    plan(space, start, goal, algorithm='rrt', time_limit=0.05),
    plan_trajectory(space, system, at_rest, goal, goal_radius=0.4, time_limit=0.05),
    plan(space, start, (200.5, 0.5)),
    plan(space, start, goal, algorithm='rrt', max_iterations=10, time_limit=3600.0),
):
    print(result.status.name, result.message)
"""
STATUSES = ['CANCELLED', 'TIMEOUT', 'TIMEOUT', 'SOLVED', 'ITERATION_LIMIT']


@pytest.mark.parametrize(
    ('mode', 'why'),
    [
        ('compiled', None),
        ('interpreted', 'this process compiles nothing'),
        ('auto', r'compilation is under way, \d+ of \d+ kernels'),
    ],
)
def test_message_of_cut_work_names_the_tier(tmp_path: Path, mode: str, why: str | None) -> None:
    environment = {**os.environ, VARIABLE: mode}
    if mode == 'auto':
        environment['NUMBA_CACHE_DIR'] = str(tmp_path)
    done = subprocess.run(
        [sys.executable, '-c', SCRIPT],
        capture_output=True,
        text=True,
        timeout=600,
        check=True,
        env=environment,
    )
    lines = done.stdout.splitlines()
    assert [line.partition(' ')[0] for line in lines] == STATUSES
    for line in lines[:3]:
        if why is None:
            assert 'interpreted' not in line
        else:
            assert re.search(f'; it ran interpreted: {why}$', line), line
    assert not any('interpreted' in line for line in lines[3:])
