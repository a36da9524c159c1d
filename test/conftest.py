"""
What holds for every test, and what is done once before the first one.

The kernels of requests on grids are compiled before the first test. Tests wait for the machine
code of all others, too. Those marked ``interpreted`` do not: what has no machine code by then runs
interpreted, which gives the same to the last bit, and which costs less than compiling it for a few
calls. With ``HNR_COMPILE_ALL`` set the mark means nothing.
"""

import fcntl
import os
import subprocess
import sys

from hnr_planner.core import warm_up
from hnr_planner.core.kernels import modes
from hnr_planner.core.kernels.cache_folder import cache_folder
import pytest

# Processes that tests start wait for machine code, unless a test says otherwise.
MODE = os.environ.setdefault(modes.VARIABLE, 'compiled')
MARKS_COUNT = MODE == 'compiled' and not os.environ.get('HNR_COMPILE_ALL')
# Workers collect while all that most tests need is being compiled elsewhere.
modes.set_mode('interpreted')
# Set before the first message class is imported.
# Without these checks a field of the wrong type goes out as garbage, silently.
os.environ['ROS_PYTHON_CHECK_FIELDS'] = '1'
# No test talks to another machine.
os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'

WARM_UP = 'from hnr_planner.core import warm_up; warm_up()'


def pytest_sessionstart(session: pytest.Session) -> None:
    """Start to compile before the workers do: each would do it by itself, and nodes be late."""
    if session.config.pluginmanager.hasplugin('dsession'):
        # The process holds the lock until it ends, however that happens.
        lock = _lock(fcntl.LOCK_EX)
        subprocess.Popen([sys.executable, '-c', WARM_UP], pass_fds=[lock])
        os.close(lock)


def pytest_collection_finish(session: pytest.Session) -> None:
    """Wait until all is compiled that most tests need, and load it."""
    is_controller = session.config.pluginmanager.hasplugin('dsession')
    if not is_controller and not session.config.option.collectonly:
        os.close(_lock(fcntl.LOCK_SH))
        warm_up()


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Set what happens when a test calls a kernel that has no machine code."""
    is_marked = item.get_closest_marker('interpreted') is not None
    modes.set_mode('interpreted' if is_marked and MARKS_COUNT else MODE)


def _lock(kind: int) -> int:
    """Return the open file of a lock that all processes of the tests share, once it is had."""
    file = os.open(cache_folder() / 'warm_up.lock', os.O_CREAT | os.O_RDWR, 0o644)
    fcntl.flock(file, kind)
    return file
