"""What holds for every test, and what is done once before the first one."""

import os

from hnr_planner.core import warm_up
from hnr_planner.core.kernels import modes
import pytest

# Tests run machine code and wait for it to be compiled, in processes that they start as well.
modes.set_mode(os.environ.setdefault(modes.VARIABLE, 'compiled'))
# Set before the first message class is imported.
# Without these checks a field of the wrong type goes out as garbage, silently.
os.environ['ROS_PYTHON_CHECK_FIELDS'] = '1'
# No test talks to another machine.
os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'


def pytest_sessionstart(session: pytest.Session) -> None:
    """Compile before the workers begin: each would do it by itself, and nodes would be late."""
    is_worker = hasattr(session.config, 'workerinput')
    if not is_worker and not session.config.option.collectonly:
        warm_up()
