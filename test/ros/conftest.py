"""What every test of the nodes shares: a ROS domain of its own, one node and one client."""

from collections.abc import Iterator
from contextlib import ExitStack
import os
import signal
from test.ros.domain import own_domain
from test.ros.harness import Client, node_process, NodeProcess
from types import FrameType

import pytest

_DOMAIN = ExitStack()
# Read when a first node is made, in this process and in each of its children.
os.environ['ROS_DOMAIN_ID'] = str(_DOMAIN.enter_context(own_domain()))
os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'


def _end_in_order(number: int, _frame: FrameType | None) -> None:
    """End the session with all fixtures taken down, so that no node is left behind."""
    pytest.exit(f'ended by signal {number}', returncode=128 + number)


signal.signal(signal.SIGTERM, _end_in_order)


@pytest.fixture(scope='session', autouse=True)
def ros_logs(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Keep the log files of the nodes out of the home folder."""
    os.environ['ROS_LOG_DIR'] = str(tmp_path_factory.mktemp('ros_log'))


@pytest.fixture(scope='module')
def planner(tmp_path_factory: pytest.TempPathFactory) -> Iterator[NodeProcess]:
    """Run one planning node for all tests of a module."""
    log = tmp_path_factory.mktemp('planner') / 'log'
    with node_process('planner_node', log) as process:
        yield process


@pytest.fixture(scope='module')
def client(planner: NodeProcess) -> Iterator[Client]:
    """Return a client of the module's planning node."""
    client = Client()
    yield client
    client.close()
