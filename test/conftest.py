"""
What holds for every test, and what is done once before the first one.

The kernels of requests on grids are compiled before the first test that needs them. Tests wait for
the machine code of all others, too. Those marked ``interpreted`` do not: what has no machine code
by then runs interpreted, which gives the same to the last bit, and which costs less than compiling
it for a few calls. With ``HNR_COMPILE_ALL`` set the mark means nothing.
"""

import fcntl
from functools import cache
import gc
import os
import subprocess
import sys
from test.sweeps import IN_FULL
from typing import Any

from hnr_planner.core import warm_up
from hnr_planner.core.kernels import modes
from hnr_planner.core.kernels.cache_folder import cache_folder
import pytest

# Processes that tests start wait for machine code, unless a test says otherwise.
MODE = os.environ.setdefault(modes.VARIABLE, 'compiled')
MARKS_COUNT = MODE == 'compiled' and not IN_FULL
# Workers collect, and some begin, while all that most tests need is being compiled elsewhere.
modes.set_mode('interpreted')
# Set before the first message class is imported.
# Without these checks a field of the wrong type goes out as garbage, silently.
os.environ['ROS_PYTHON_CHECK_FIELDS'] = '1'
# Of several workers each has one core: threads that wait for a busy one burn what they wait for.
os.environ.setdefault('OPENBLAS_NUM_THREADS', '1')
# No test talks to another machine.
os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'

#: Folders and files that take longest, so that no worker has one of them left at the end; before
#: these, what runs while machine code for the others is being made, and then what needs much
#: memory for a moment, while the workers have loaded little machine code yet.
FIRST = (
    'test/laws/test_space_laws.py',
    'test/laws/test_primitive_laws.py',
    'test/laws/',
    'test/core/planning/test_spaces.py',
    'test/core/spaces/test_far_spaces.py',
    'test/core/spaces/test_beyond.py',
    'test/core/spaces/test_piece_tree.py',
    'test/core/spaces/test_sheared.py',
    'test/core/kernels/test_tiers.py',
    'test/cli/test_drawing.py',
    'test/maps/test_large_images.py',
    'test/ros/one_node/',
    'test/experiments/test_experiments.py',
    'test/core/sampling/test_walk_laws.py',
    'test/cli/test_pages.py',
    'test/cli/test_demo.py',
    'test/core/planning/',
    'test/core/kernels/',
    'test/core/sampling/',
    'test/core/theory/',
    'test/core/trajectories/',
    'test/test_package.py',
    'test/ros/',
)
#: Folders whose tests all run in one worker, since they share kernels, results of computations,
#: a library or a node that nobody else needs.
TOGETHER = (
    'test/laws/',
    'test/core/theory/',
    'test/core/sampling/diagnostics/',
    'test/ros/one_node/',
)
#: Files whose tests compile into caches of their own.
APART = ('test/core/kernels/test_tiers.py',)
#: New objects after which Python looks for garbage: the compiler makes many, and few are garbage.
GARBAGE_EVERY = 50_000
WARM_UP = f"""
import gc
from hnr_planner.core import warm_up
gc.set_threshold({GARBAGE_EVERY})
warm_up()
"""


def pytest_sessionstart(session: pytest.Session) -> None:
    """Start to compile before the workers do: each would do it by itself, and nodes be late."""
    config = session.config
    if config.pluginmanager.hasplugin('dsession') and not config.option.collectonly:
        # The process holds the lock until it ends, however that happens.
        lock = _lock(fcntl.LOCK_EX)
        warming = subprocess.Popen([sys.executable, '-c', WARM_UP], pass_fds=[lock])
        os.close(lock)
        config.add_cleanup(warming.wait)
        config.add_cleanup(warming.kill)  # cleanups run in the reverse order


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put first what takes longest; else the order stays."""

    def turn(item: pytest.Item) -> int:
        return next(
            (k for k, path in enumerate(FIRST) if item.nodeid.startswith(path)), len(FIRST)
        )

    items.sort(key=turn)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Return the scheduler that gives whole files to workers, and whole folders in TOGETHER."""
    from xdist.scheduler import LoadFileScheduling

    class Scheduler(LoadFileScheduling):
        def _split_scope(self, nodeid: str) -> str:
            folder = next((path for path in TOGETHER if nodeid.startswith(path)), None)
            return folder or super()._split_scope(nodeid)

    return Scheduler(config, log) if config.option.dist == 'loadfile' else None


def pytest_collection_finish() -> None:
    """Take what has been imported and collected for no garbage, and look less often for some."""
    gc.freeze()
    gc.set_threshold(GARBAGE_EVERY)


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Wait for what most tests need; set what a kernel without machine code does when called."""
    is_interpreted = MARKS_COUNT and item.get_closest_marker('interpreted') is not None
    if not (is_interpreted or item.nodeid.startswith(APART)):
        _load_machine_code()
    modes.set_mode('interpreted' if is_interpreted else MODE)


@cache
def _load_machine_code() -> None:
    """Wait, once, until all is compiled that most tests need, and load it."""
    os.close(_lock(fcntl.LOCK_SH))
    warm_up()


def _lock(kind: int) -> int:
    """Return the open file of a lock that all processes of the tests share, once it is had."""
    file = os.open(cache_folder() / 'warm_up.lock', os.O_CREAT | os.O_RDWR, 0o644)
    fcntl.flock(file, kind)
    return file
