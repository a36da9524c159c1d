"""
How the node ends in each of its states: by signals, and under a bond with a lifecycle manager.

Each test runs a node of its own; in test_shutdown.py are those that plan.
"""

from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
import signal
from test.ros.harness import Client, MANY, node_process, NodeProcess
from test.ros.transitions import (
    ACTIVATE,
    ACTIVE,
    change,
    CLEANUP,
    CONFIGURE,
    DEACTIVATE,
    FINALIZED,
    INACTIVE,
    state,
    UNCONFIGURED,
    WAY_TO,
)
from test.sweeps import sweep

import pytest
from rclpy.duration import Duration

NEEDS_BOND = pytest.mark.skipif(
    find_spec('bondpy') is None, reason='bondpy comes with a ROS from apt only'
)


@pytest.fixture
def planner(tmp_path: Path) -> Iterator[NodeProcess]:
    """Run a planning node that waits for transitions from outside."""
    with node_process('planner_node', tmp_path / 'log', autostart=False) as process:
        yield process


@pytest.fixture
def client(planner: NodeProcess) -> Iterator[Client]:
    """Return a client of that node."""
    client = Client()
    yield client
    client.close()


@NEEDS_BOND
def test_bond_lives_while_the_node_is_active(client: Client, planner: NodeProcess) -> None:
    from bond.msg import Status
    from bondpy.bondpy import Bond

    heard = client.listen(Status, '/bond', MANY)
    change(client, CONFIGURE)
    for end in ((DEACTIVATE,), ()):
        manager = Client()
        bond = Bond(manager.node, '/bond', 'hnr_planner')
        bond.heartbeat_timeout = 120.0
        bond.start()
        assert change(client, ACTIVATE) == [True]
        assert bond.wait_until_formed(Duration(seconds=20))
        assert any(message.active and message.instance_id != bond.instance_id for message in heard)
        if end:
            assert change(client, *end) == [True]
        else:
            assert planner.end(signal.SIGTERM) == 0
        assert bond.wait_until_broken(Duration(seconds=20)), 'told, not missed'
        manager.close()
    assert 'Traceback' not in planner.log, planner.log


@NEEDS_BOND
def test_manager_resets_the_node_that_ends_under_its_bond(
    client: Client, planner: NodeProcess
) -> None:
    """The calls of Nav2's lifecycle manager, in its order; each of them waits for a response."""
    from bondpy.bondpy import Bond

    assert change(client, CONFIGURE) == [True] and state(client) == INACTIVE
    assert change(client, ACTIVATE) == [True] and state(client) == ACTIVE
    manager = Client()
    bond = Bond(manager.node, '/bond', 'hnr_planner')
    bond.heartbeat_timeout = 120.0
    bond.start()
    assert bond.wait_until_formed(Duration(seconds=20))
    planner.popen.send_signal(signal.SIGTERM)
    assert bond.wait_until_broken(Duration(seconds=20))
    assert change(client, DEACTIVATE) == [True] and state(client) == INACTIVE
    assert change(client, CLEANUP) == [True]
    assert planner.popen.wait(20.0) == 0
    assert 'Traceback' not in planner.log, planner.log
    manager.close()


# Each state and each signal: one handler takes both, and test_shutdown.py has both while active.
@pytest.mark.parametrize(
    ('where', 'number'),
    [
        sweep(UNCONFIGURED, signal.SIGINT),
        (INACTIVE, signal.SIGTERM),
        (FINALIZED, signal.SIGINT),
    ],
)
def test_signal_in_a_state_that_does_not_plan_is_a_clean_end(
    client: Client, planner: NodeProcess, where: str, number: signal.Signals
) -> None:
    change(client, *WAY_TO[where])
    assert state(client) == where
    assert planner.end(number) == 0, planner.log
    for word in ('Traceback', 'ERROR', 'xception', 'ignored'):
        assert word not in planner.log, planner.log
